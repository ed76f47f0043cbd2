#include "fem/dynamics/gradients/transposed_system.h"

#include <Eigen/Jacobi>
#include <algorithm>
#include <array>
#include <cmath>

namespace flexmorph::fem {

namespace {

/// Returns true if the ratio of the weights of stiffness and mass is about the same in both.
bool alike(const Weights& a, const Weights& b) {
  constexpr double kMaxChange = 0.3;
  const double x = a.q * b.a, y = b.q * a.a;
  return std::abs(x - y) <= kMaxChange * std::max(std::abs(x), std::abs(y));
}

}  // namespace

void TransposedSystem::set(const State& x, const Weights& w, double scale, const VectorXd& spin) {
  model_.constraints(x, constraints_);
  model_.kkt(x, constraints_, w, scale, matrix_);
  if (spin.size() > 0) {
    model_.kkt(x, constraints_, {0, 0, 1}, scale, mass_);
    for (int column = 0; column < model_.n_dofs(); ++column)
      for (int p = matrix_.outerIndexPtr()[column]; p < matrix_.outerIndexPtr()[column + 1]; ++p)
        if (matrix_.innerIndexPtr()[p] < model_.n_dofs())
          matrix_.valuePtr()[p] -= spin[column] * mass_.valuePtr()[p];
  }
  take(x, w);
}

void TransposedSystem::set_carried(const State& x, std::span<const Turning> turning) {
  const Weights w{1, 0, 0};
  model_.constraints(x, constraints_);
  model_.kkt(x, constraints_, w, 1, matrix_);
  add_turning_tangent(model_, x, constraints_, turning, matrix_);
  take(x, w);
}

/// Scales the matrix, which belongs to x, and adapts the kept factorization to it.
void TransposedSystem::take(const State& x, const Weights& w) {
  q_ = x.q;
  weights_ = w;
  if (version_ != model_.pattern_version()) reserve_memory();
  is_factored_ = is_factored_ && alike(w, factored_weights_);
  const int n = model_.n_dofs();
  for (int column = 0; column < matrix_.cols(); ++column)
    for (SparseMatrix::InnerIterator entry(matrix_, column); entry; ++entry) {
      if (column < n) entry.valueRef() /= scales_[column];
      if (entry.row() < n) entry.valueRef() /= scales_[entry.row()];
    }
  if (is_factored_) renew();
}

/// Allocates the vectors and analyses the matrix of a new mesh.
void TransposedSystem::reserve_memory() {
  version_ = model_.pattern_version();
  is_factored_ = false;
  scales_ = model_.scales();
  solver_.analyze(matrix_);
  basis_.resize(matrix_.rows(), kMaxDirections + 1);
  directions_.resize(matrix_.rows(), kMaxDirections);
}

void TransposedSystem::factorize() {
  constexpr double kFactorError = 0.02;  // same value as in the time steps
  factored_ = matrix_;
  factored_weights_ = weights_;
  solver_.factorize(factored_, kFactorError);
  is_factored_ = true;
  turns_.begin(model_, q_);
  turned_.clear();
  ++factorizations_;
}

/// Rotates the kept factorization with the bodies. If it has a border, the border is factored
/// again, and the solver applies the rotation.
void TransposedSystem::renew() {
  turns_.follow(model_, q_);
  turned_ = turns_.turns(model_);
  const std::vector<char>& border = solver_.border();
  if (border.empty()) return;
  const auto in_border = [&](Eigen::Index k) { return border[static_cast<size_t>(k)] != 0; };
  for (int column = 0; column < factored_.cols(); ++column) {
    if (!in_border(column)) continue;
    for (int p = factored_.outerIndexPtr()[column]; p < factored_.outerIndexPtr()[column + 1]; ++p)
      if (in_border(factored_.innerIndexPtr()[p])) factored_.valuePtr()[p] = matrix_.valuePtr()[p];
  }
  is_factored_ = solver_.renew_border(factored_, std::move(turned_));
  turned_.clear();
}

/// Rotates the vector unknowns of all bodies, forwards or back.
void TransposedSystem::turn(VectorXd& x, bool back) const {
  for (const TurnedVectors& t : turned_) {
    if (t.sine == 0) continue;
    Eigen::Matrix2d by;
    by << t.cosine, -t.sine, t.sine, t.cosine;
    if (back) by.transposeInPlace();
    Eigen::Map<Eigen::Matrix2Xd> vectors(x.data() + t.first, 2, (t.last - t.first) / 2);
    vectors = (by * vectors).eval();
  }
}

/// Computes R J⁻ᵀ Rᵀ times `right` with the kept factorization.
void TransposedSystem::solve_kept(const VectorXd& right, VectorXd& out) {
  turning_ = right;
  turn(turning_, true);
  solver_.solve_transposed(factored_, turning_, out, false);
  turn(out, false);
  ++iterations_;
}

/// Adds to found_ the combination of a number of solutions with the kept factorization that
/// minimizes the residual (one cycle of GMRES).
/// @param left  Norm of the residual rest_.   @param aim  Norm at which the cycle ends.
/// @returns false if the residual decreased too slowly.
bool TransposedSystem::improve(double left, double aim, bool fresh) {
  // A kept factorization is replaced if after kCheckedIterations solutions it has not reduced the
  // residual by the factor kSlow. A new factorization costs as much as a dozen solutions.
  constexpr int kCheckedIterations = 4;
  constexpr double kSlow = 1e-4;
  Eigen::Matrix<double, kMaxDirections + 1, kMaxDirections> h;
  Eigen::Matrix<double, kMaxDirections + 1, 1> g;
  std::array<Eigen::JacobiRotation<double>, kMaxDirections> givens;
  h.setZero();
  g.setZero();
  g[0] = left;
  basis_.col(0) = rest_ / left;
  int k = 0;
  bool slow = false;
  while (k < kMaxDirections && !slow && std::abs(g[k]) > aim) {
    image_ = basis_.col(k);
    solve_kept(image_, solution_);
    directions_.col(k) = solution_;
    image_.noalias() = matrix_.transpose() * solution_;
    for (int i = 0; i <= k; ++i) {
      h(i, k) = basis_.col(i).dot(image_);
      image_ -= h(i, k) * basis_.col(i);
    }
    h(k + 1, k) = image_.norm();
    if (!std::isfinite(h(k + 1, k)))
      throw Error::numerical("adjoint: the equations of a step are singular");
    if (h(k + 1, k) > 0) basis_.col(k + 1) = image_ / h(k + 1, k);
    for (int i = 0; i < k; ++i)
      h.col(k).applyOnTheLeft(i, i + 1, givens[static_cast<size_t>(i)].adjoint());
    Eigen::JacobiRotation<double>& last = givens[static_cast<size_t>(k)];
    last.makeGivens(h(k, k), h(k + 1, k));
    h.col(k).applyOnTheLeft(k, k + 1, last.adjoint());
    g.applyOnTheLeft(k, k + 1, last.adjoint());
    ++k;
    slow = !fresh && k == kCheckedIterations && std::abs(g[k]) > kSlow * left;
  }
  const VectorXd y = h.topLeftCorner(k, k).triangularView<Eigen::Upper>().solve(g.head(k));
  found_.noalias() += directions_.leftCols(k) * y;
  return !slow;
}

void TransposedSystem::solve(const VectorXd& seed, const VectorXd& rows, VectorXd& psi,
                             VectorXd& chi) {
  // If the residual no longer decreases with a new factorization, it is at round-off or the matrix
  // is singular.
  constexpr double kResidualTolerance = 2e-13, kMaxContraction = 0.5, kRoundOff = 1e-7;
  constexpr int kMaxIterations = 8;
  const int n = model_.n_dofs(), m = model_.n_constraints();
  right_.resize(n + m);
  right_ << seed.cwiseQuotient(scales_), rows;
  const double size = right_.norm();
  found_.setZero(n + m);
  bool fresh = !is_factored_;
  if (fresh && size > 0) factorize();
  rest_ = right_;
  double left = size;
  for (int k = 0; k < kMaxIterations && left > kResidualTolerance * size; ++k) {
    last_ = found_;
    const bool fast = improve(left, kResidualTolerance * size, fresh);
    rest_ = right_;
    rest_.noalias() -= matrix_.transpose() * found_;
    const double now = rest_.norm();
    if (!(now < left)) {
      found_ = last_;
      rest_ = right_;
      rest_.noalias() -= matrix_.transpose() * found_;
    }
    const bool stuck = !(now < kMaxContraction * left);
    left = std::min(now, left);
    if (fresh && stuck) break;
    if (!fresh && (!fast || stuck)) {
      factorize();
      fresh = true;
    }
  }
  if (left > kRoundOff * size)
    throw Error::numerical("adjoint: the equations of a step are singular or nearly singular");
  psi = found_.head(n).cwiseQuotient(scales_);
  chi = found_.tail(m);
}

VectorXd TransposedSystem::part(const State& x, const Weights& w, const VectorXd& psi) {
  VectorXd out = VectorXd::Zero(model_.n_dofs());
  model_.add_transposed_product(x, w, psi, out);
  return out;
}

VectorXd TransposedSystem::by_velocity(const State& x, const VectorXd& psi) {
  return part(x, {0, 1, 0}, psi);
}

VectorXd TransposedSystem::by_acceleration(const State& x, const VectorXd& psi) {
  return part(x, {0, 0, 1}, psi);
}

VectorXd TransposedSystem::by_position(const State& x, const VectorXd& psi) {
  return part(x, {1, 0, 0}, psi) + model_.constraint_curvature(x, x.lambda, psi);
}

VectorXd TransposedSystem::by_rows(const VectorXd& chi) const {
  VectorXd out = VectorXd::Zero(model_.n_dofs());
  Workspace::add_constraint_force(constraints_, chi, out);
  return out;
}

}  // namespace flexmorph::fem
