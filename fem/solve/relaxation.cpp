#include "fem/solve/relaxation.h"

#include <algorithm>
#include <cmath>

#include "fem/solve/linear_solver.h"

namespace flexmorph::fem {
namespace {

/// Takes one step: finds the equilibrium with the force κ M (q - q₀), q₀ the positions of x, by
/// Newton's method. Returns false where it does not converge.
bool step_with_hold(Workspace& model, double hold, double size, const VectorXd& scales, State& x) {
  constexpr int kMaxIterations = 25;
  constexpr double kConverged = 1e-12, kAccepted = 1e-7;  // corrections in sizes of the model
  const int n = model.n_dofs(), m = model.n_constraints();
  const VectorXd center = x.q;
  Constraints c;
  SparseMatrix kkt;
  DirectSolver solver;
  VectorXd residual, right(n + m), step;
  double correction = 0;
  for (int iteration = 0; iteration < kMaxIterations; ++iteration) {
    x.a = hold * (x.q - center);
    model.constraints(x, c);
    model.force(x, residual);
    model.add_constraint_force(c, x.lambda, residual);
    model.kkt(x, c, {1, 0, hold}, 1, kkt);
    if (iteration == 0) solver.analyze(kkt);
    try {
      solver.factorize(kkt);
    } catch (const Error& error) {
      if (error.kind() != Error::Kind::numerical) throw;
      return false;
    }
    right << -residual, -c.value;
    solver.solve(kkt, right, step);
    x.q += step.head(n);
    x.lambda += step.tail(m);
    correction = step.head(n).cwiseProduct(scales).lpNorm<Eigen::Infinity>();
    if (!std::isfinite(correction)) return false;
    if (correction < kConverged * size) return true;
  }
  return correction < kAccepted * size;
}

}  // namespace

bool relax_to_equilibrium(Workspace& model, State& x) {
  constexpr double kFirst = 1e4, kSmallest = 1e-2, kLargest = 1e9;  // κ [1/s²]
  constexpr double kMaxMove = 0.2, kStill = 1e-7;  // of a step, in sizes of the model
  constexpr int kMaxSteps = 300;
  model.prepare(x);  // so that the scales are defined
  const double size = std::max(1e-300, x.q.lpNorm<Eigen::Infinity>());
  const VectorXd scales = model.scales();
  x.v.setZero();
  double hold = kFirst;
  for (int step = 0; step < kMaxSteps && hold < kLargest; ++step) {
    State next = x;
    const bool converged = step_with_hold(model, hold, size, scales, next);
    const double moved = scales.cwiseProduct(next.q - x.q).lpNorm<Eigen::Infinity>();
    if (!converged || !(moved < kMaxMove * size)) {
      hold *= 4;
      continue;
    }
    x = next;
    x.a.setZero();
    model.follow_turns(x);
    if (hold <= kSmallest && moved < kStill * size) return true;
    hold = std::max(kSmallest, 0.5 * hold);
  }
  return false;
}

}  // namespace flexmorph::fem
