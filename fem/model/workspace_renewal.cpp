// Recomputation of some entries of the iteration matrix, for the border of a factorization whose
// other entries are kept.
#include <algorithm>

#include "fem/model/workspace.h"

namespace flexmorph::fem {
namespace {

constexpr int kMaxLocal = kMaxShapes * kMaxDim;

/// Selects the entries of a matrix whose row and column are both chosen.
struct Chosen {
  const std::vector<char>& unknowns;
  bool operator()(int k) const { return k >= 0 && unknowns[static_cast<size_t>(k)] != 0; }
  bool operator()(int row, int column) const { return (*this)(row) && (*this)(column); }
};

}  // namespace

void Workspace::renew_kkt(const State& x, const Constraints& c, const Weights& w, double scale,
                          const std::vector<char>& unknowns, SparseMatrix& out) {
  prepare(x);
  /// not yet built when a motion is continued
  if (built_version_ != pattern_version()) build_pattern();
  const Chosen chosen{unknowns};
  for (int column = 0; column < out.cols(); ++column) {
    if (!chosen(column)) continue;
    for (SparseMatrix::InnerIterator entry(out, column); entry; ++entry)
      if (chosen(static_cast<int>(entry.row()))) entry.valueRef() = 0;
  }
  double* values = out.valuePtr();
  const auto is_chosen = [&](int k) { return chosen(k); };
  for (const BatchIndices& batch : batches_)
    if (std::any_of(batch.dofs.begin(), batch.dofs.end(), is_chosen))
      renew_batch(batch, x, w, scale, unknowns, values);
  for (const Single& single : singles_)
    if (std::any_of(single.dofs.begin(), single.dofs.end(), is_chosen))
      renew_single(single, x, w, scale, unknowns, values);
  force_element_entries_.clear();
  for (const ModelForceElement& force_element : force_elements_)
    force_element->add_tangent(x, w, force_element_entries_);
  for (size_t k = 0; k < force_element_entries_.size(); ++k)
    if (chosen(force_element_entries_[k].row(), force_element_entries_[k].col()))
      values[force_element_indices_[k]] += scale * force_element_entries_[k].value();
  joint_stiffness(x, stiffness_);
  for (size_t k = 0; k < stiffness_.size(); ++k)
    if (chosen(stiffness_[k].row(), stiffness_[k].col()))
      values[stiffness_indices_[k]] += scale * w.q * stiffness_[k].value();
  for (size_t k = 0; k < c.jacobian.size(); ++k)
    if (chosen(n_dofs() + c.jacobian[k].row(), c.jacobian[k].col())) {
      values[joint_indices_[2 * k]] += c.jacobian[k].value();
      values[joint_indices_[2 * k + 1]] += c.jacobian[k].value();
    }
  for (const int value_index : left_out_indices_) values[value_index] = 1;
}

void Workspace::renew_batch(const BatchIndices& value_indices, const State& x, const Weights& w,
                            double scale, const std::vector<char>& unknowns, double* values) const {
  const Chosen chosen{unknowns};
  const Body& body = bodies_[value_indices.body];
  Pack q[kMaxLocal], v[kMaxLocal], a[kMaxLocal], tangent[kMaxLocal * kMaxLocal];
  for (size_t k = 0; k < value_indices.dofs.size(); ++k) {
    const int dof = value_indices.dofs[k];
    const auto lane = static_cast<int>(k % kLanes);
    q[k / kLanes][lane] = x.q[dof];
    v[k / kLanes][lane] = x.v[dof];
    a[k / kLanes][lane] = x.a[dof];
  }
  const Batch batch{value_indices.first,
                    value_indices.count,
                    body.element->n_shapes(),
                    body.element->dim(),
                    q,
                    v,
                    a};
  const int n = batch.n_local();
  std::fill(tangent, tangent + n * n, Pack{});
  for (const BodyTerm& term : body.terms) term.add_tangents(batch, w, tangent);
  // The order is that of kkt(): one position for every column, vector of rows and SIMD lane.
  const int* value_index = value_indices.entries.data();
  for (int column = 0; column < n; ++column)
    for (int row = 0; row < n; row += batch.dim, value_index += kLanes)
      for (int lane = 0; lane < batch.count; ++lane)
        for (int c = 0; c < batch.dim; ++c)
          if (chosen(value_indices.dofs[static_cast<size_t>((row + c) * kLanes + lane)],
                     value_indices.dofs[static_cast<size_t>(column * kLanes + lane)]))
            values[value_index[lane] + c] += scale * tangent[column * n + row + c][lane];
}

void Workspace::renew_single(const Single& single, const State& x, const Weights& w, double scale,
                             const std::vector<char>& unknowns, double* values) const {
  const Chosen chosen{unknowns};
  Single part = single;
  const size_t n = single.dofs.size();
  for (size_t k = 0; k < part.entries.size(); ++k)
    if (!chosen(single.dofs[k / n], single.dofs[k % n])) part.entries[k] = -1;
  add_single_tangent(part, x, w, scale, values);
}

}  // namespace flexmorph::fem
