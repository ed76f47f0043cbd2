#include "fem/dynamics/transposed_system.h"

#include <cmath>

namespace flexmorph::fem {

void TransposedSystem::set(const State& x, const Weights& w, double scale, const VectorXd& spin) {
  model_.constraints(x, constraints_);
  model_.kkt(x, constraints_, w, scale, matrix_);
  if (spin.size() > 0) {
    model_.kkt(x, constraints_, {0, 0, 1}, scale, part_);
    for (int column = 0; column < model_.n_dofs(); ++column)
      for (int p = matrix_.outerIndexPtr()[column]; p < matrix_.outerIndexPtr()[column + 1]; ++p)
        if (matrix_.innerIndexPtr()[p] < model_.n_dofs())
          matrix_.valuePtr()[p] -= spin[column] * part_.valuePtr()[p];
  }
  if (version_ != model_.pattern_version()) {
    version_ = model_.pattern_version();
    is_factored_ = false;
    scales_ = model_.scales();
    solver_.analyze(matrix_);
  }
  const int n = model_.n_dofs();
  for (int column = 0; column < matrix_.cols(); ++column)
    for (SparseMatrix::InnerIterator entry(matrix_, column); entry; ++entry) {
      if (column < n) entry.valueRef() /= scales_[column];
      if (entry.row() < n) entry.valueRef() /= scales_[entry.row()];
    }
}

void TransposedSystem::factorize() {
  constexpr double kMiss = 0.02;  // as of the steps themselves
  factored_ = matrix_;
  solver_.factorize(factored_, kMiss);
  is_factored_ = true;
  ++factorizations_;
}

void TransposedSystem::solve(const VectorXd& seed, const VectorXd& rows, VectorXd& psi,
                             VectorXd& chi) {
  // A kept factor that contracts less is replaced; a fresh one that no longer contracts is at
  // round-off, or the matrix is singular.
  constexpr double kContraction = 0.3, kEnough = 1e-13, kRoundOff = 1e-7;
  constexpr int kMost = 100;
  const int n = model_.n_dofs(), m = model_.n_constraints();
  right_.resize(n + m);
  right_ << seed.cwiseQuotient(scales_), rows;
  const double size = right_.norm();
  found_.setZero(n + m);
  bool fresh = !is_factored_;
  if (fresh && size > 0) factorize();
  rest_ = right_;
  double left = size;
  for (int k = 0; k < kMost && left > kEnough * size; ++k) {
    solver_.solve_transposed(factored_, rest_, correction_, false);
    ++iterations_;
    found_ += correction_;
    rest_ = right_;
    rest_.noalias() -= matrix_.transpose() * found_;
    const double now = rest_.norm(), contraction = now / left;
    if (!std::isfinite(now))
      throw Error::numerical("adjoint: the equations of a step are singular");
    if (contraction > kContraction) {
      if (fresh && contraction > 0.9) {
        if (now > left) {
          found_ -= correction_;
        } else {
          left = now;
        }
        break;
      }
      if (!fresh) {
        if (now > left) {  // what came of the old factor is worse than nothing
          found_ -= correction_;
          rest_ = right_;
          rest_.noalias() -= matrix_.transpose() * found_;
        }
        factorize();
        fresh = true;
        left = rest_.norm();
        continue;
      }
    }
    left = now;
  }
  if (left > kRoundOff * size)
    throw Error::numerical("adjoint: the equations of a step are singular, or nearly so");
  psi = found_.head(n).cwiseQuotient(scales_);
  chi = found_.tail(m);
}

VectorXd TransposedSystem::part(const State& x, const Weights& w, const VectorXd& psi) {
  model_.kkt(x, constraints_, w, 1, part_);
  const int n = model_.n_dofs();
  return part_.topLeftCorner(n, n).transpose() * psi;
}

VectorXd TransposedSystem::by_velocity(const State& x, const VectorXd& psi) {
  return part(x, {0, 1, 0}, psi);
}

VectorXd TransposedSystem::by_acceleration(const State& x, const VectorXd& psi) {
  return part(x, {0, 0, 1}, psi);
}

VectorXd TransposedSystem::by_position(const State& x, const VectorXd& psi) {
  return part(x, {1, 0, 0}, psi);
}

VectorXd TransposedSystem::by_rows(const VectorXd& chi) const {
  VectorXd out = VectorXd::Zero(model_.n_dofs());
  Workspace::add_constraint_force(constraints_, chi, out);
  return out;
}

}  // namespace flexmorph::fem
