#include "fem/dynamics/integrators/dense_output.h"

#include <cmath>

#include "fem/solve/scaled_constraints.h"
#include "geometry/text.h"

namespace flexmorph::fem {

/// Quintic Hermite interpolation in s = (t - t₀)/h of the values, the rates h v and the second
/// derivatives h² a of both ends.
void DenseOutput::interpolate(double t, State& out) const {
  const State &a = *start_, &b = *end_;
  const double h = b.t - a.t, s = (t - a.t) / h, r = 1 - s;
  // Three functions and their rates for each end. Those of the second end are mirrored, so that the
  // odd ones change their sign.
  struct Functions {
    double value[3], rate[3];
  };
  const auto of_start = [](double x) {
    const double x2 = x * x, y2 = (1 - x) * (1 - x), y3 = y2 * (1 - x);
    return Functions{{y3 * (1 + 3 * x + 6 * x2), y3 * x * (1 + 3 * x), 0.5 * y3 * x2},
                     {-30 * x2 * y2, y2 * (1 + 2 * x - 15 * x2), 0.5 * y2 * x * (2 - 5 * x)}};
  };
  const Functions f = of_start(s), g = of_start(r);
  out.t = t;
  out.turned = a.turned;
  out.q = f.value[0] * a.q + h * f.value[1] * a.v + h * h * f.value[2] * a.a + g.value[0] * b.q -
          h * g.value[1] * b.v + h * h * g.value[2] * b.a;
  out.v = (f.rate[0] / h) * a.q + f.rate[1] * a.v + h * f.rate[2] * a.a - (g.rate[0] / h) * b.q +
          g.rate[1] * b.v - h * g.rate[2] * b.a;
  out.a = r * a.a + s * b.a;
  out.lambda = r * a.lambda + s * b.lambda;
}

/// Factors [M Φ_qᵀ; Φ_q 0] at x, with unknowns scaled to displacements.
void DenseOutput::factorize(const State& x) {
  const int n = model_.n_dofs();
  model_.kkt(x, constraints_, {0, 0, 1}, 1, kkt_);
  for (int column = 0; column < kkt_.cols(); ++column)
    for (SparseMatrix::InnerIterator entry(kkt_, column); entry; ++entry) {
      if (column < n) entry.valueRef() /= scales_[column];
      if (entry.row() < n) entry.valueRef() /= scales_[entry.row()];
    }
  if (version_ != model_.pattern_version()) {
    solver_.analyze(kkt_);
    version_ = model_.pattern_version();
  }
  solver_.factorize(kkt_);
}

void DenseOutput::solve(const VectorXd& constraint) {
  const int n = model_.n_dofs();
  right_.resize(kkt_.rows());
  right_.head(n) = force_.cwiseQuotient(scales_);
  right_.tail(model_.n_constraints()) = constraint;
  solver_.solve(kkt_, right_, solution_);
  solution_.head(n) = solution_.head(n).cwiseQuotient(scales_).eval();
}

/// Chord iteration with one factorization, because the error of the quintic is small.
void DenseOutput::project_position(State& x) {
  const double size = model_size(scales_, x.q);
  constexpr int kMaxIterations = 12;
  constexpr double kOnto = 1e-13, kRoundOff = 1e-10;
  force_.setZero(model_.n_dofs());
  double last = 0;
  for (int pass = 1;; ++pass) {
    model_.constraints(x, constraints_);
    if (pass == 1) factorize(x);
    miss_ = -constraints_.value;
    solve(miss_);
    const auto move = solution_.head(model_.n_dofs());
    x.q += move;
    const double moved = move.cwiseProduct(scales_).lpNorm<Eigen::Infinity>() / size;
    if (moved <= kOnto || (pass > 2 && moved < kRoundOff && moved > 0.5 * last)) return;
    last = moved;
    if (pass < kMaxIterations && std::isfinite(moved)) continue;
    throw Error::numerical(
        formatted("dense output: the constraints at t = %.6g s are not met: the last correction is "
                  "%.1e of the size of the model",
                  x.t, moved));
  }
}

void DenseOutput::archive(Archive& memory) {
  memory(scales_, kkt_);
  if (memory.up_to_date(version_, model_.pattern_version())) solver_.archive(memory, kkt_);
}

void DenseOutput::at(double t, State& out) {
  const int n = model_.n_dofs();
  if (version_ != model_.pattern_version()) scales_ = model_.scales();
  interpolate(t, out);
  if (model_.n_constraints() > 0) project_position(out);

  model_.constraints(out, constraints_);
  factorize(out);
  miss_ = -constraints_.rate;
  for (const auto& entry : constraints_.jacobian)
    miss_[entry.row()] -= entry.value() * out.v[entry.col()];
  force_.setZero(n);
  solve(miss_);
  out.v += solution_.head(n);

  out.a.setZero(n);
  model_.constraints(out, constraints_);
  model_.force(out, force_);
  force_ *= -1;
  solve(constraints_.acceleration);
  out.a = solution_.head(n);
  out.lambda = solution_.tail(model_.n_constraints());
}

}  // namespace flexmorph::fem
