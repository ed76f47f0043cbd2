#include "fem/solve/statics.h"

#include "fem/solve/linear_solver.h"

namespace flexmorph::fem {

namespace {

/// Newton's method for q and λ.
/// @param accelerate  sets x.a from x.q before a residual
/// @param soften      adds to the tangent what that depends on q by
/// @param size        of the model [m]
template <class Accelerate, class Soften>
void find_equilibrium(Model& model, State& x, double size, const Accelerate& accelerate,
                      const Soften& soften, const char* failure) {
  model.prepare(x);
  const int n = model.n_dofs(), m = model.n_constraints();
  const VectorXd scales = model.scales();
  Constraints c;
  SparseMatrix kkt;
  UnsymmetricSolver solver;
  VectorXd residual, right(n + m), step;
  for (int iteration = 0; iteration < 40; ++iteration) {
    accelerate(x);
    if (model.has_free_lines()) model.prepare(x);
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
    const double correction = step.head(n).cwiseProduct(scales).lpNorm<Eigen::Infinity>();
    if (!std::isfinite(correction)) break;
    if (correction < 1e-13 * size) return;
  }
  throw Error::numerical(failure);
}

}  // namespace

void solve_rotating_equilibrium(Model& model, const VectorXd& spin, const VectorXd& center,
                                State& x) {
  SparseMatrix mass;
  const auto accelerate = [&](State& s) { s.a = -spin.cwiseProduct(s.q - center); };
  // The tangent of -M ω² (q - center): columns of the mass matrix times their ω².
  const auto soften = [&](const State& s, const Constraints& c, SparseMatrix& kkt) {
    model.kkt(s, c, {0, 0, 1}, 1, mass);
    for (int column = 0; column < model.n_dofs(); ++column)
      for (int p = kkt.outerIndexPtr()[column]; p < kkt.outerIndexPtr()[column + 1]; ++p)
        if (kkt.innerIndexPtr()[p] < model.n_dofs())
          kkt.valuePtr()[p] -= spin[column] * mass.valuePtr()[p];
  };
  find_equilibrium(model, x, std::max(1e-300, (x.q - center).lpNorm<Eigen::Infinity>()), accelerate,
                   soften, "statics: no equilibrium in the rotating frame after 40 iterations");
}

void solve_carried_equilibrium(Model& model, State& x) {
  find_equilibrium(
      model, x, std::max(1e-300, x.q.lpNorm<Eigen::Infinity>()), [](State&) {},
      [](const State&, const Constraints&, SparseMatrix&) {},
      "statics: no equilibrium under the inertia forces of the start after 40 iterations");
}

}  // namespace flexmorph::fem
