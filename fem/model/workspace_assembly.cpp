// Evaluation and assembly of a model, eight elements at a time.
#include <omp.h>

#include <algorithm>
#include <bit>
#include <cstdint>
#include <exception>
#include <iterator>
#include <limits>

#include "fem/model/workspace.h"

namespace flexmorph::fem {
namespace {

constexpr int kMaxLocal = kMaxShapes * kMaxDim;
/// Smallest numbers of batches per thread. With fewer batches an additional thread slows the
/// evaluation down, because on shared processors a suspended thread delays the other threads by
/// milliseconds at the end of every colour.
constexpr int kForcesPerThread = 512, kTangentsPerThread = 128;

}  // namespace

/// Every batch gets the first colour that no earlier batch with a common unknown has.
void Workspace::number_batches() {
  std::vector<std::vector<BatchIndices>> by_colour;
  singles_.clear();
  for (size_t index = 0; index < bodies_.size(); ++index) {
    const Body& b = bodies_[index];
    if (b.element->n_scalars() > 0) {
      number_singles(index);
      continue;
    }
    const int dim = b.element->dim(), n = b.element->n_elements();
    /// one bit per colour, for each vector unknown
    std::vector<std::uint64_t> colours(static_cast<size_t>(b.element->n_vectors()));
    for (int first = 0; first < n; first += kLanes) {
      BatchIndices batch{index, first, std::min(kLanes, n - first), {}, {}};
      std::uint64_t taken = 0;
      for (int e = first; e < first + batch.count; ++e)
        for (const int k : b.element->vectors(e)) taken |= colours[static_cast<size_t>(k)];
      const int colour = std::countr_one(taken);
      if (colour >= 64) throw Error::input("body '" + b.name + "': too many elements share a node");
      for (int e = first; e < first + batch.count; ++e)
        for (const int k : b.element->vectors(e))
          colours[static_cast<size_t>(k)] |= std::uint64_t{1} << colour;
      for (int k = 0; k < b.element->n_shapes(); ++k)
        for (int c = 0; c < dim; ++c)
          for (int lane = 0; lane < kLanes; ++lane) {
            const int e = first + std::min(lane, batch.count - 1);
            batch.dofs.push_back(b.first_dof + dim * b.element->vectors(e)[static_cast<size_t>(k)] +
                                 c);
          }
      if (by_colour.size() <= static_cast<size_t>(colour)) by_colour.resize(colour + 1);
      by_colour[static_cast<size_t>(colour)].push_back(std::move(batch));
    }
  }
  batches_.clear();
  colours_ = {0};
  for (auto& colour : by_colour) {
    std::move(colour.begin(), colour.end(), std::back_inserter(batches_));
    colours_.push_back(static_cast<int>(batches_.size()));
  }
  numbered_version_ = pattern_version();
}

void Workspace::number_singles(size_t body) {
  const Body& b = bodies_[body];
  for (int e = 0; e < b.element->n_elements(); ++e) {
    const auto sides = b.element->free_sides(e);
    Single single{body, e, !sides.empty(), {}, {}};
    for (const int k : b.element->vectors(e))
      for (int c = 0; c < b.element->dim(); ++c)
        single.dofs.push_back(b.first_dof + b.element->dim() * k + c);
    for (const int s : sides) single.dofs.push_back(s < 0 ? -1 : b.first_scalar() + s);
    singles_.push_back(std::move(single));
  }
}

template <class F>
void Workspace::for_batches(const State& x, int per_thread, const F& f) const {
  const int threads =
      std::clamp(static_cast<int>(batches_.size()) / per_thread, 1, omp_get_max_threads());
  std::exception_ptr failure;
  int failed = std::numeric_limits<int>::max();
#pragma omp parallel num_threads(threads) if (threads > 1)
  for (size_t colour = 0; colour + 1 < colours_.size(); ++colour) {
#pragma omp for schedule(static)
    for (int index = colours_[colour]; index < colours_[colour + 1]; ++index) try {
        const BatchIndices& value_indices = batches_[static_cast<size_t>(index)];
        const Element& element = *bodies_[value_indices.body].element;
        Pack q[kMaxLocal], v[kMaxLocal], a[kMaxLocal];
        const int* dof = value_indices.dofs.data();
        for (size_t k = 0; k < value_indices.dofs.size() / kLanes; ++k, dof += kLanes)
          for (int lane = 0; lane < kLanes; ++lane) {
            q[k][lane] = x.q.data()[dof[lane]];
            v[k][lane] = x.v.data()[dof[lane]];
            a[k][lane] = x.a.data()[dof[lane]];
          }
        f(Batch{value_indices.first, value_indices.count, element.n_shapes(), element.dim(), q, v,
                a},
          value_indices);
        /// rethrows the failure of the lowest batch number, independent of the number of threads
      } catch (...) {
#pragma omp critical
        if (index < failed) {
          failed = index;
          failure = std::current_exception();
        }
      }
  }
  if (failure) std::rethrow_exception(failure);
}

void Workspace::force(const State& x, VectorXd& out) {
  prepare(x);
  out.setZero(n_dofs());
  for_batches(x, kForcesPerThread, [&](const Batch& batch, const BatchIndices& value_indices) {
    Pack f[kMaxLocal];
    std::fill(f, f + batch.n_local(), Pack{});
    for (const BodyTerm& term : bodies_[value_indices.body].terms) term.add_forces(batch, f);
    const int* dof = value_indices.dofs.data();
    for (int k = 0; k < batch.n_local(); ++k, dof += kLanes)
      for (int lane = 0; lane < batch.count; ++lane) out.data()[dof[lane]] += f[k][lane];
  });
  for (const Single& single : singles_) add_single_force(single, x, out);
  for (const ModelForceElement& force_element : force_elements_) force_element->add_force(x, out);
}

void Workspace::add_single_force(const Single& single, const State& x, VectorXd& out) const {
  const Body& b = bodies_[single.body];
  Local local;
  gather(b, single.e, x, local);
  EulerianForce f = EulerianForce::Zero(static_cast<Eigen::Index>(single.dofs.size()));
  if (single.free) {
    for (const BodyTerm& term : b.terms)
      term.with_eulerian_lines().add_eulerian_force(single.e, local, f);
  } else {
    LocalRows rows = LocalRows::Zero(local.q.rows(), local.q.cols());
    for (const BodyTerm& term : b.terms) term->add_force(single.e, local, rows);
    f = Eigen::Map<const VectorXd>(rows.data(), rows.size());
  }
  for (size_t k = 0; k < single.dofs.size(); ++k)
    if (single.dofs[k] >= 0) out[single.dofs[k]] += f[static_cast<Eigen::Index>(k)];
}

void Workspace::add_single_tangent(const Single& single, const State& x, const Weights& w,
                                   double scale, double* values) const {
  const Body& b = bodies_[single.body];
  Local local;
  gather(b, single.e, x, local);
  const auto n = static_cast<Eigen::Index>(single.dofs.size());
  EulerianTangent tangent = EulerianTangent::Zero(n, n);
  if (single.free) {
    for (const BodyTerm& term : b.terms)
      term.with_eulerian_lines().add_eulerian_tangent(single.e, local, w, tangent);
  } else {
    LocalTangent rows = LocalTangent::Zero(n, n);
    for (const BodyTerm& term : b.terms) term->add_tangent(single.e, local, w, rows);
    tangent = rows;
  }
  const double* entry = tangent.data();
  for (const int value_index : single.entries) {
    if (value_index >= 0) values[value_index] += scale * *entry;
    ++entry;
  }
}

void Workspace::mean_force(const State& mean, const VectorXd& q0, const VectorXd& q1,
                           VectorXd& out) {
  if (has_eulerian_lines())
    throw Error::input("integrator \"energy_momentum\" does not support free material lines");
  prepare(mean);
  out.setZero(n_dofs());
  LocalStep step;
  LocalRows f;
  for (const Body& b : bodies_) {
    const int dim = b.element->dim();
    for (int e = 0; e < b.element->n_elements(); ++e) {
      gather(b, e, mean, q0, q1, step);
      f.setZero(step.start.rows(), dim);
      for (const BodyTerm& term : b.terms) term.with_mean_force().add_mean_force(e, step, f);
      const auto vectors = b.element->vectors(e);
      for (Eigen::Index k = 0; k < f.rows(); ++k)
        out.segment(b.first_dof + dim * vectors[static_cast<size_t>(k)], dim) += f.row(k);
    }
  }
  for (const ModelForceElement& force_element : force_elements_)
    force_element.with_mean_force().add_mean_force(mean, q0, q1, out);
}

void Workspace::joint_stiffness(const State& x, std::vector<Eigen::Triplet<double>>& out) const {
  out.clear();
  int first = 0;
  for (const auto& joint : joints_) {
    joint->add_stiffness(x.t, x.q, x.lambda.segment(first, joint->size()), out);
    first += joint->size();
  }
}

std::vector<Eigen::Triplet<double>> Workspace::element_entries() const {
  std::vector<Eigen::Triplet<double>> entries;
  for (const BatchIndices& batch : batches_)
    for (int lane = 0; lane < batch.count; ++lane)
      for (size_t row = static_cast<size_t>(lane); row < batch.dofs.size(); row += kLanes)
        for (size_t column = static_cast<size_t>(lane); column < batch.dofs.size();
             column += kLanes)
          entries.emplace_back(batch.dofs[row], batch.dofs[column], 1.0);
  for (const Single& single : singles_)
    for (const int row : single.dofs)
      for (const int column : single.dofs)
        if (row >= 0 && column >= 0) entries.emplace_back(row, column, 1.0);
  return entries;
}

void Workspace::build_pattern() {
  const int n = n_dofs() + n_constraints();
  std::vector<Eigen::Triplet<double>> entries = element_entries();
  Constraints c;
  const State at = reference();
  constraints(at, c);
  std::vector<Eigen::Triplet<double>> stiffness;
  joint_stiffness(at, stiffness);
  entries.insert(entries.end(), stiffness.begin(), stiffness.end());
  force_element_entries_.clear();
  for (const ModelForceElement& force_element : force_elements_)
    force_element->add_pattern(force_element_entries_);
  entries.insert(entries.end(), force_element_entries_.begin(), force_element_entries_.end());
  for (const auto& entry : c.jacobian) {
    entries.emplace_back(n_dofs() + entry.row(), entry.col(), 1.0);
    entries.emplace_back(entry.col(), n_dofs() + entry.row(), 1.0);
  }
  for (const int row : left_out_rows_) entries.emplace_back(n_dofs() + row, n_dofs() + row, 1.0);
  pattern_.resize(n, n);
  pattern_.setFromTriplets(entries.begin(), entries.end());
  pattern_.makeCompressed();

  const auto value_index = [&](int row, int column) {
    const int* first = pattern_.innerIndexPtr() + pattern_.outerIndexPtr()[column];
    const int* last = pattern_.innerIndexPtr() + pattern_.outerIndexPtr()[column + 1];
    return static_cast<int>(std::lower_bound(first, last, row) - pattern_.innerIndexPtr());
  };
  for (BatchIndices& batch : batches_) {
    const size_t dim = static_cast<size_t>(bodies_[batch.body].element->dim());
    batch.entries.clear();
    batch.entries.reserve(batch.dofs.size() * batch.dofs.size() / (kLanes * dim));
    for (size_t column = 0; column < batch.dofs.size(); column += kLanes)
      for (size_t row = 0; row < batch.dofs.size(); row += dim * kLanes)
        for (size_t lane = 0; lane < kLanes; ++lane)
          batch.entries.push_back(value_index(batch.dofs[row + lane], batch.dofs[column + lane]));
  }
  for (Single& single : singles_) {
    single.entries.clear();
    for (const int row : single.dofs)
      for (const int column : single.dofs)
        single.entries.push_back(row >= 0 && column >= 0 ? value_index(row, column) : -1);
  }
  const auto value_indices_of = [&](const std::vector<Eigen::Triplet<double>>& of) {
    std::vector<int> out;
    for (const auto& entry : of) out.push_back(value_index(entry.row(), entry.col()));
    return out;
  };
  stiffness_indices_ = value_indices_of(stiffness);
  force_element_indices_ = value_indices_of(force_element_entries_);
  joint_indices_.clear();
  for (const auto& entry : c.jacobian) {
    joint_indices_.push_back(value_index(n_dofs() + entry.row(), entry.col()));
    joint_indices_.push_back(value_index(entry.col(), n_dofs() + entry.row()));
  }
  left_out_indices_.clear();
  for (const int row : left_out_rows_)
    left_out_indices_.push_back(value_index(n_dofs() + row, n_dofs() + row));
  built_version_ = pattern_version();
}

void Workspace::kkt(const State& x, const Constraints& c, const Weights& w, double scale,
                    SparseMatrix& out) {
  prepare(x);
  clear(out);
  double* values = out.valuePtr();
  for_batches(x, kTangentsPerThread, [&](const Batch& batch, const BatchIndices& value_indices) {
    Pack tangent[kMaxLocal * kMaxLocal];
    const int n = batch.n_local();
    std::fill(tangent, tangent + n * n, Pack{});
    for (const BodyTerm& term : bodies_[value_indices.body].terms)
      term.add_tangents(batch, w, tangent);
    const Pack* entry = tangent;  // by columns
    const int* value_index = value_indices.entries.data();
    for (int run = 0; run < n * batch.n_shapes; ++run, entry += batch.dim, value_index += kLanes)
      for (int lane = 0; lane < batch.count; ++lane)
        for (int c = 0; c < batch.dim; ++c) values[value_index[lane] + c] += scale * entry[c][lane];
  });
  for (const Single& single : singles_) add_single_tangent(single, x, w, scale, values);
  force_element_entries_.clear();
  for (const ModelForceElement& force_element : force_elements_)
    force_element->add_tangent(x, w, force_element_entries_);
  add_force_element_entries(scale, values);
  fill_joints(x, scale * w.q, c, c, out);
}

void Workspace::add_transposed_product(const State& x, const Weights& w, const VectorXd& psi,
                                       VectorXd& out) {
  if (has_eulerian_lines())
    throw Error::input(
        "matrix-free products are not available for bodies with unknown material coordinates");
  prepare(x);
  for_batches(x, kTangentsPerThread, [&](const Batch& batch, const BatchIndices& value_indices) {
    Pack tangent[kMaxLocal * kMaxLocal], own[kMaxLocal];
    const int n = batch.n_local();
    std::fill(tangent, tangent + n * n, Pack{});
    for (const BodyTerm& term : bodies_[value_indices.body].terms)
      term.add_tangents(batch, w, tangent);
    const int* dof = value_indices.dofs.data();
    for (int k = 0; k < n; ++k, dof += kLanes)
      for (int lane = 0; lane < kLanes; ++lane) own[k][lane] = psi.data()[dof[lane]];
    const Pack* entry = tangent;  // by columns
    dof = value_indices.dofs.data();
    for (int column = 0; column < n; ++column, entry += n, dof += kLanes) {
      Pack sum{};
      for (int k = 0; k < n; ++k) sum += entry[k] * own[k];
      for (int lane = 0; lane < batch.count; ++lane) out.data()[dof[lane]] += sum[lane];
    }
  });
  force_element_entries_.clear();
  for (const ModelForceElement& force_element : force_elements_)
    force_element->add_tangent(x, w, force_element_entries_);
  for (const auto& entry : force_element_entries_)
    out[entry.col()] += entry.value() * psi[entry.row()];
}

void Workspace::mean_kkt(const State& mean, const VectorXd& q0, const VectorXd& q1,
                         const Constraints& at_mean, const Constraints& at_end, const Weights& w,
                         double scale, SparseMatrix& out) {
  prepare(mean);
  clear(out);
  double* values = out.valuePtr();
  LocalStep step;
  LocalTangent tangent;
  for (const BatchIndices& batch : batches_) {
    const Body& b = bodies_[batch.body];
    const int dim = b.element->dim();
    for (int lane = 0; lane < batch.count; ++lane) {
      gather(b, batch.first + lane, mean, q0, q1, step);
      tangent.setZero(step.start.size(), step.start.size());
      for (const BodyTerm& term : b.terms)
        term.with_mean_force().add_mean_tangent(batch.first + lane, step, w, tangent);
      const int* value_index = batch.entries.data() + lane;
      for (Eigen::Index column = 0; column < tangent.cols(); ++column)
        for (Eigen::Index row = 0; row < tangent.rows(); row += dim, value_index += kLanes)
          for (int c = 0; c < dim; ++c)
            values[*value_index + c] += scale * tangent(row + c, column);
    }
  }
  force_element_entries_.clear();
  for (const ModelForceElement& force_element : force_elements_)
    force_element.with_mean_force().add_mean_tangent(mean, q0, q1, w, force_element_entries_);
  add_force_element_entries(scale, values);
  fill_joints(mean, scale * w.q, at_end, at_mean, out);
}

void Workspace::add_force_element_entries(double scale, double* values) const {
  for (size_t k = 0; k < force_element_entries_.size(); ++k)
    values[force_element_indices_[k]] += scale * force_element_entries_[k].value();
}

void Workspace::clear(SparseMatrix& out) {
  if (built_version_ != pattern_version()) build_pattern();
  if (out.rows() != pattern_.rows() || out.nonZeros() != pattern_.nonZeros()) out = pattern_;
  std::fill(out.valuePtr(), out.valuePtr() + out.nonZeros(), 0.0);
}

void Workspace::fill_joints(const State& x, double stiffness_scale, const Constraints& rows,
                            const Constraints& columns, SparseMatrix& out) {
  double* values = out.valuePtr();
  if (stiffness_scale != 0 && !stiffness_indices_.empty()) {
    joint_stiffness(x, stiffness_);
    for (size_t k = 0; k < stiffness_.size(); ++k)
      values[stiffness_indices_[k]] += stiffness_scale * stiffness_[k].value();
  }
  for (size_t k = 0; k < rows.jacobian.size(); ++k) {
    values[joint_indices_[2 * k]] += rows.jacobian[k].value();
    values[joint_indices_[2 * k + 1]] += columns.jacobian[k].value();
  }
  for (const int value_index : left_out_indices_) values[value_index] = 1;
}

}  // namespace flexmorph::fem
