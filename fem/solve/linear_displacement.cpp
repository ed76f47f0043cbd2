#include "fem/solve/linear_solver.h"
#include "fem/solve/statics.h"

namespace flexmorph::fem {

VectorXd linear_displacement(Workspace& model, const State& x) {
  const int n = model.n_dofs(), m = model.n_constraints();
  State at = x;
  at.lambda = VectorXd::Zero(m);
  Constraints c;
  SparseMatrix kkt;
  VectorXd residual, right(n + m), step;
  model.constraints(at, c);
  model.force(at, residual);
  model.kkt(at, c, {1, 0, 0}, 1, kkt);
  right << -residual, -c.value;
  DirectSolver solver;
  solver.analyze(kkt);
  solver.factorize(kkt);
  solver.solve(kkt, right, step);
  return step.head(n);
}

}  // namespace flexmorph::fem
