#include "fem/dynamics/integrators/coordinate_partition.h"

#include <Eigen/QR>
#include <algorithm>
#include <cmath>

#include "fem/solve/diagnosis.h"

namespace flexmorph::fem {
namespace {

constexpr double kDependent = 1e-9;  // independent part of a row of unit size, as in diagnose()

/// Returns the rows of J in `rows` without zero columns, and in `unknowns` the indices of the other
/// columns.
MatrixXd used_columns(const SparseMatrix& j, const std::vector<int>& rows,
                      std::vector<int>& unknowns) {
  unknowns.clear();
  for (int column = 0; column < j.cols(); ++column)
    for (SparseMatrix::InnerIterator it(j, column); it; ++it)
      if (it.value() != 0) {
        unknowns.push_back(column);
        break;
      }
  MatrixXd out(static_cast<Eigen::Index>(rows.size()), static_cast<Eigen::Index>(unknowns.size()));
  for (size_t k = 0; k < unknowns.size(); ++k) {
    const VectorXd column = j.col(unknowns[k]);
    for (size_t i = 0; i < rows.size(); ++i)
      out(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(k)) = column[rows[i]];
  }
  return out;
}

/// Throws the error that the constraints are dependent at x.
[[noreturn]] void refuse(Workspace& model, const State& x) {
  std::string what = describe(diagnose(model, x));
  if (what.empty()) what = describe(ConstraintWatch(model).look(x));
  throw Error::numerical("minimal_coordinates: the constraints are dependent at t = " +
                         std::to_string(x.t) + " s: " + what);
}

}  // namespace

bool CoordinatePartition::choose(Workspace& model, const State& x) {
  rows_.evaluate(model, x);
  kept_rows_.clear();
  for (int row = 0; row < model.n_constraints(); ++row)
    if (!std::binary_search(model.left_out_rows().begin(), model.left_out_rows().end(), row))
      kept_rows_.push_back(row);
  const auto m = static_cast<Eigen::Index>(kept_rows_.size());
  std::vector<int> used, chosen;
  const MatrixXd j = used_columns(rows_.jacobian(), kept_rows_, used);
  if (j.cols() < m) refuse(model, x);
  if (m > 0) {
    const Eigen::ColPivHouseholderQR<MatrixXd> qr(j);
    const auto diagonal = qr.matrixQR().diagonal().cwiseAbs();
    if (!(diagonal[m - 1] > kDependent * diagonal[0])) refuse(model, x);
    for (Eigen::Index k = 0; k < m; ++k)
      chosen.push_back(used[static_cast<size_t>(qr.colsPermutation().indices()[k])]);
  }
  std::sort(chosen.begin(), chosen.end());
  const bool differs = chosen != dependent_ || independent_.size() + dependent_.size() !=
                                                   static_cast<size_t>(model.n_dofs());
  dependent_ = std::move(chosen);
  number(model, rows_.unscaled());
  return differs;
}

void CoordinatePartition::number(const Model& model, const Constraints& c) {
  std::vector<int> column_of(static_cast<size_t>(model.n_dofs()), -1);
  for (size_t k = 0; k < dependent_.size(); ++k)
    column_of[static_cast<size_t>(dependent_[k])] = static_cast<int>(k);
  independent_.clear();
  for (int i = 0; i < model.n_dofs(); ++i)
    if (column_of[static_cast<size_t>(i)] < 0) independent_.push_back(i);

  const auto m = static_cast<Eigen::Index>(dependent_.size());
  std::vector<int> index_of_row(static_cast<size_t>(model.n_constraints()), -1);
  row_scale_.resize(m);
  for (Eigen::Index k = 0; k < m; ++k) {
    const int row = kept_rows_[static_cast<size_t>(k)];
    index_of_row[static_cast<size_t>(row)] = static_cast<int>(k);
    row_scale_[k] = rows_.row_scale()[row];
  }
  column_scale_.resize(m);
  for (Eigen::Index k = 0; k < m; ++k)
    column_scale_[k] = 1 / rows_.scales()[dependent_[static_cast<size_t>(k)]];
  std::vector<Eigen::Triplet<double>> entries;
  for (const auto& entry : c.jacobian) {
    const int row = index_of_row[static_cast<size_t>(entry.row())],
              column = column_of[static_cast<size_t>(entry.col())];
    if (row >= 0 && column >= 0) entries.emplace_back(row, column, 1.0);
  }
  matrix_.resize(m, m);
  matrix_.setFromTriplets(entries.begin(), entries.end());
  matrix_.makeCompressed();
  value_indices_.clear();
  weights_.clear();
  for (const auto& entry : c.jacobian) {
    const int row = index_of_row[static_cast<size_t>(entry.row())],
              column = column_of[static_cast<size_t>(entry.col())];
    value_indices_.push_back(-1);
    weights_.push_back(0);
    if (row < 0 || column < 0) continue;
    const int* first = matrix_.innerIndexPtr() + matrix_.outerIndexPtr()[column];
    const int* last = matrix_.innerIndexPtr() + matrix_.outerIndexPtr()[column + 1];
    value_indices_.back() =
        static_cast<int>(std::lower_bound(first, last, row) - matrix_.innerIndexPtr());
    weights_.back() = row_scale_[row] * column_scale_[column];
  }
  factored_.resize(matrix_.nonZeros());
  lu_.analyze(matrix_);
  is_factored_ = false;
}

void CoordinatePartition::factorize(const Constraints& c) {
  double* values = matrix_.valuePtr();
  Eigen::Map<VectorXd> all(values, matrix_.nonZeros());
  all.setZero();
  for (size_t k = 0; k < value_indices_.size(); ++k)
    if (value_indices_[k] >= 0) values[value_indices_[k]] += weights_[k] * c.jacobian[k].value();
  if (is_factored_ && all == factored_) return;
  is_factored_ = false;
  lu_.factorize(matrix_);
  factored_ = all;
  is_factored_ = true;
}

void CoordinatePartition::archive(Archive& memory) {
  memory(independent_, dependent_, kept_rows_, value_indices_, weights_, row_scale_, column_scale_,
         matrix_, factored_, is_factored_);
  lu_.archive(memory, matrix_);
}

void CoordinatePartition::solve(const VectorXd& right, VectorXd& out) const {
  out.resize(row_scale_.size());
  for (Eigen::Index k = 0; k < out.size(); ++k)
    out[k] = row_scale_[k] * right[kept_rows_[static_cast<size_t>(k)]];
  lu_.solve(out);
  out.array() *= column_scale_.array();
}

double CoordinatePartition::amplification() const {
  if (matrix_.rows() == 0) return 1;
  double norm = 0;
  for (int column = 0; column < matrix_.cols(); ++column) {
    double sum = 0;
    for (SparseMatrix::InnerIterator it(matrix_, column); it; ++it) sum += std::abs(it.value());
    norm = std::max(norm, sum);
  }
  return lu_.condition(matrix_) / norm;
}

}  // namespace flexmorph::fem
