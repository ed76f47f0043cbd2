#include "fem/solve/statics.h"

#include "fem/solve/linear_solver.h"

namespace flexmorph::fem {

void solve_rotating_equilibrium(Model& model, const VectorXd& spin, const VectorXd& center,
                                State& x) {
  model.prepare(x);
  const int n = model.n_dofs(), m = model.n_constraints();
  const VectorXd scales = model.scales();
  Constraints c;
  SparseMatrix kkt, mass;
  UnsymmetricSolver solver;
  VectorXd residual, right(n + m), step;
  const double size = std::max(1e-300, (x.q - center).lpNorm<Eigen::Infinity>());
  for (int iteration = 0; iteration < 40; ++iteration) {
    x.a = -spin.cwiseProduct(x.q - center);
    if (model.has_free_lines()) model.prepare(x);
    model.constraints(x, c);
    model.force(x, residual);
    model.add_constraint_force(c, x.lambda, residual);
    // The tangent of -M ω² (q - center): columns of the mass matrix times their ω².
    model.kkt(x, c, {1, 0, 0}, 1, kkt);
    model.kkt(x, c, {0, 0, 1}, 1, mass);
    for (int column = 0; column < n; ++column)
      for (int p = kkt.outerIndexPtr()[column]; p < kkt.outerIndexPtr()[column + 1]; ++p)
        if (kkt.innerIndexPtr()[p] < n) kkt.valuePtr()[p] -= spin[column] * mass.valuePtr()[p];
    if (iteration == 0) solver.analyze(kkt);
    solver.factorize(kkt);
    right << -residual, -c.value;
    solver.solve(kkt, right, step);
    x.q += step.head(n);
    x.lambda += step.tail(m);
    const double correction = step.head(n).cwiseProduct(scales).lpNorm<Eigen::Infinity>();
    if (!std::isfinite(correction)) break;
    if (correction < 1e-13 * size) return;
  }
  throw Error::numerical("statics: no equilibrium in the rotating frame after 40 iterations");
}

}  // namespace flexmorph::fem
