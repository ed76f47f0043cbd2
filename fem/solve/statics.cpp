#include "fem/solve/statics.h"

#include <algorithm>
#include <cmath>

#include "fem/solve/linear_solver.h"

namespace flexmorph::fem {

namespace {

/// Newton's method for q and λ.
/// @param accelerate  sets x.a from x.q before a residual; false: this iteration is not the last
/// @param soften      adds to the tangent what that depends on q by
/// @param size        of the model [m]
/// @param tolerance   of a correction that does not get smaller any more, in parts of the size
template <class Accelerate, class Soften>
void find_equilibrium(Workspace& model, State& x, double size, const Accelerate& accelerate,
                      const Soften& soften, const char* failure, double tolerance = 0) {
  model.prepare(x);  // for the scales
  const int n = model.n_dofs(), m = model.n_constraints();
  const VectorXd scales = model.scales();
  Constraints c;
  SparseMatrix kkt;
  UnsymmetricSolver solver;
  VectorXd residual, right(n + m), step;
  double correction = 0;
  for (int iteration = 0; iteration < 40; ++iteration) {
    const bool may_end = accelerate(x);
    model.constraints(x, c);
    model.force(x, residual);
    model.add_constraint_force(c, x.lambda, residual);
    model.kkt(x, c, {1, 0, 0}, 1, kkt);
    soften(x, c, kkt);
    if (iteration == 0) solver.analyze(kkt);
    solver.factorize(kkt);
    right << -residual, -c.value;
    solver.solve(kkt, right, step);
    x.q += step.head(n);
    x.lambda += step.tail(m);
    correction = step.head(n).cwiseProduct(scales).lpNorm<Eigen::Infinity>();
    if (!std::isfinite(correction)) break;
    if (may_end && correction < 1e-13 * size) return;
  }
  if (correction < tolerance * size) return;  // NaN is not
  throw Error::numerical(failure);
}

}  // namespace

void solve_rotating_equilibrium(Workspace& model, const VectorXd& spin, const VectorXd& center,
                                State& x) {
  SparseMatrix mass;
  const auto accelerate = [&](State& s) {
    s.a = -spin.cwiseProduct(s.q - center);
    return true;
  };
  // The tangent of -M ω² (q - center): columns of the mass matrix times their ω².
  const auto soften = [&](const State& s, const Constraints& c, SparseMatrix& kkt) {
    model.kkt(s, c, {0, 0, 1}, 1, mass);
    for (int column = 0; column < model.n_dofs(); ++column)
      for (int p = kkt.outerIndexPtr()[column]; p < kkt.outerIndexPtr()[column + 1]; ++p)
        if (kkt.innerIndexPtr()[p] < model.n_dofs())
          kkt.valuePtr()[p] -= spin[column] * mass.valuePtr()[p];
  };
  find_equilibrium(
      model, x, std::max(1e-300, (x.q - center).lpNorm<Eigen::Infinity>()), accelerate, soften,
      "statics: no equilibrium in the rotating frame at the start, t = 0, after 40 "
      "iterations: the bodies are too soft for their loads, or nothing holds a part of them");
}

void solve_carried_equilibrium(Workspace& model, State& x) {
  find_equilibrium(
      model, x, std::max(1e-300, x.q.lpNorm<Eigen::Infinity>()), [](State&) { return true; },
      [](const State&, const Constraints&, SparseMatrix&) {},
      "statics: no equilibrium under the inertia forces of the start, t = 0, after 40 iterations: "
      "the bodies are too soft for them, or nothing holds a part of them");
}

void solve_resting_equilibrium(Workspace& model, State& x) {
  constexpr double kFirst = 1e4;  // κ [1/s²]
  const VectorXd start = x.q;
  double hold = 10 * kFirst;
  x.v.setZero();
  // a = κ (q - q₀): its inertia force is that of the hold.
  const auto accelerate = [&](State& s) {
    hold = std::max(0.1 * hold, kLastHold);
    s.a = hold * (s.q - start);
    return hold == kLastHold;
  };
  const auto soften = [&](const State& s, const Constraints& c, SparseMatrix& kkt) {
    model.kkt(s, c, {1, 0, hold}, 1, kkt);
  };
  // Along a freedom that only the hold keeps, forces are zero up to the round-off of stiff ones.
  find_equilibrium(model, x, std::max(1e-300, x.q.lpNorm<Eigen::Infinity>()), accelerate, soften,
                   "statics: no equilibrium at rest after 40 iterations", 1e-7);
  x.a.setZero();
}

}  // namespace flexmorph::fem
