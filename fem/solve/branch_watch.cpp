#include "fem/solve/branch_watch.h"

#include <Eigen/QR>
#include <algorithm>
#include <cmath>

#include "fem/solve/redundancy.h"
#include "geometry/text.h"

namespace flexmorph::fem {
namespace {

constexpr size_t kMaxRows = 400;
constexpr double kDependent = 1e-9;  // independent part of a row of unit size, as in diagnose()
const double kDeteriorated = std::log(3);

/// Returns J without the entries of rows that act on other bodies than rigid ones, and of rows that
/// are left out.
SparseMatrix rows_of_rigid_bodies(const Model& model, const SparseMatrix& j) {
  std::vector<char> wanted(static_cast<size_t>(j.rows()), 1);
  for (const Body& b : model.bodies()) {
    if (b.element->is_rigid()) continue;
    for (int column = b.first_dof; column < b.first_dof + b.n_dofs(); ++column)
      for (SparseMatrix::InnerIterator it(j, column); it; ++it)
        wanted[static_cast<size_t>(it.row())] = 0;
  }
  for (const int row : model.left_out_rows()) wanted[static_cast<size_t>(row)] = 0;
  SparseMatrix out = j;
  out.prune([&](auto row, auto, double) { return wanted[static_cast<size_t>(row)] != 0; });
  return out;
}

/// Returns J with a small number for every entry that is zero, so that the rows of a loop are found
/// in positions where entries vanish, too.
SparseMatrix without_zeros(const SparseMatrix& j) {
  SparseMatrix out = j;
  constexpr double kSmall = 1e-3;  // too small to separate a row from others, see entangled_rows()
  out.coeffs() = (out.coeffs() == 0).select(kSmall, out.coeffs());
  return out;
}

/// Removes the rows without entries from a list of rows.
void erase_empty(const SparseMatrix& j, std::vector<int>& rows) {
  std::vector<char> used(static_cast<size_t>(j.rows()), 0);
  for (int column = 0; column < j.cols(); ++column)
    for (SparseMatrix::InnerIterator it(j, column); it; ++it)
      if (it.value() != 0) used[static_cast<size_t>(it.row())] = 1;
  std::erase_if(rows, [&](int row) { return used[static_cast<size_t>(row)] == 0; });
}

}  // namespace

/// Chooses the rows of the loops and the dependent unknowns at x.
void BranchWatch::choose(const State& x) {
  version_ = model_.pattern_version();
  loop_rows_.clear();
  chosen_.clear();
  const auto is_rigid = [](const Body& b) { return b.element->is_rigid(); };
  if (std::none_of(model_.bodies().begin(), model_.bodies().end(), is_rigid)) return;
  rows_.evaluate(model_, x);
  const SparseMatrix j = rows_of_rigid_bodies(model_, rows_.jacobian());
  std::vector<int> rows = entangled_rows(without_zeros(j));
  erase_empty(j, rows);
  if (rows.empty() || rows.size() > kMaxRows) return;

  index_of_row_.assign(static_cast<size_t>(j.rows()), -1);
  for (size_t k = 0; k < rows.size(); ++k)
    index_of_row_[static_cast<size_t>(rows[k])] = static_cast<int>(k);
  std::vector<int> columns;
  for (int column = 0; column < j.cols(); ++column)
    for (SparseMatrix::InnerIterator it(j, column); it; ++it)
      if (index_of_row_[static_cast<size_t>(it.row())] >= 0) {
        columns.push_back(column);
        break;
      }
  const auto m = static_cast<Eigen::Index>(rows.size()),
             n = static_cast<Eigen::Index>(columns.size());
  if (n < m) return;
  MatrixXd dense = MatrixXd::Zero(m, n);
  for (Eigen::Index k = 0; k < n; ++k)
    for (SparseMatrix::InnerIterator it(j, columns[static_cast<size_t>(k)]); it; ++it)
      if (const int row = index_of_row_[static_cast<size_t>(it.row())]; row >= 0)
        dense(row, k) = it.value();
  const Eigen::ColPivHouseholderQR<MatrixXd> qr(dense);
  const auto diagonal = qr.matrixQR().diagonal().cwiseAbs();
  if (!(diagonal[m - 1] > kDependent * diagonal[0])) return;
  std::vector<int> dependent;
  for (Eigen::Index k = 0; k < m; ++k)
    dependent.push_back(columns[static_cast<size_t>(qr.colsPermutation().indices()[k])]);
  std::sort(dependent.begin(), dependent.end());
  index_of_column_.assign(static_cast<size_t>(j.cols()), -1);
  for (size_t k = 0; k < dependent.size(); ++k)
    index_of_column_[static_cast<size_t>(dependent[k])] = static_cast<int>(k);
  is_square_ = m == n;
  loop_rows_ = std::move(rows);
  matrix_.resize(0, 0);
  chosen_ = determinants();
}

/// Returns the determinants of all blocks at the state of rows_.
std::vector<Determinant> BranchWatch::determinants() {
  const SparseMatrix& j = rows_.jacobian();
  const bool is_new = matrix_.rows() == 0;
  entries_.clear();
  for (int column = 0; column < j.cols(); ++column) {
    const int to = index_of_column_[static_cast<size_t>(column)];
    if (to < 0) continue;
    for (SparseMatrix::InnerIterator it(j, column); it; ++it)
      if (const int row = index_of_row_[static_cast<size_t>(it.row())]; row >= 0)
        entries_.emplace_back(row, to, it.value());
  }
  const auto m = static_cast<Eigen::Index>(loop_rows_.size());
  matrix_.resize(m, m);
  matrix_.setFromTriplets(entries_.begin(), entries_.end());
  if (is_new) blocks_.analyze(matrix_);
  return blocks_.of(matrix_);
}

void BranchWatch::begin(const State& x) {
  start_q_ = x.q;
  start_t_ = x.t;
  if (version_ != model_.pattern_version()) {
    choose(x);
    start_ = chosen_;
    return;
  }
  if (chosen_.empty()) return;
  if (end_.empty() || x.t != end_t_ || x.q != end_q_) {
    rows_.evaluate(model_, x);
    end_ = determinants();
    end_q_ = x.q;
    end_t_ = x.t;
  }
  start_ = end_;
  if (is_square_) return;
  for (size_t b = 0; b < start_.size(); ++b)
    if (start_[b].logarithm < chosen_[b].logarithm - kDeteriorated) {
      choose(x);
      start_ = chosen_;
      return;
    }
}

std::vector<Determinant> BranchWatch::determinants_at(const VectorXd& q, double t) {
  at_.q = q;
  at_.v.setZero(q.size());
  at_.t = t;
  rows_.evaluate(model_, at_);
  return determinants();
}

OtherBranch BranchWatch::compare(const VectorXd& q, double t) {
  OtherBranch out;
  end_.clear();
  if (chosen_.empty()) return out;
  const std::vector<Determinant> middle =
      determinants_at(0.5 * (start_q_ + q), 0.5 * (start_t_ + t));
  end_q_ = q;
  end_t_ = t;
  end_ = determinants_at(q, t);
  const int block = block_near_other_branch(start_, middle, end_);
  if (block < 0) return out;
  VectorXd weights = VectorXd::Zero(model_.n_constraints());
  out.is_determined = is_square_;
  const std::vector<int>& redundant = model_.redundant_rows();
  for (const int k : blocks_.rows_of(block)) {
    const int row = loop_rows_[static_cast<size_t>(k)];
    weights[row] = 1;
    if (std::binary_search(redundant.begin(), redundant.end(), row)) out.is_determined = false;
  }
  out.joints = heaviest_joints(model_, weights, 0.5);
  return out;
}

std::string BranchWatch::refusal(const VectorXd& q, double t, bool is_short) {
  if (const OtherBranch other = compare(q, t); other && (other.is_determined || !is_short))
    return "the loop of " + list_joints(other.joints) +
           " comes to a position where it could change to another branch";
  const LeftOutMiss miss = left_out_miss(model_, q, t);
  return miss.is_large ? "redundant joints do not agree with the others: the error of joint '" +
                             miss.joint + "' is " + formatted("%.3g m", miss.miss)
                       : "";
}

}  // namespace flexmorph::fem
