#include "fem/solve/statics.h"

#include <algorithm>
#include <cmath>

#include "fem/solve/linear_solver.h"

namespace flexmorph::fem {

namespace {

/// Finds q and λ by Newton's method.
/// @param accelerate  sets x.a from x.q before a residual; returns false if the present iteration
///     must not be the last
/// @param soften  adds to the tangent the dependence of these accelerations on q
/// @param size  size of the model [m]
/// @param tolerance  accepted correction that no longer decreases, relative to the size
/// @param more  additional forces (n_dofs), or empty
template <class Accelerate, class Soften>
void find_equilibrium(Workspace& model, State& x, double size, const Accelerate& accelerate,
                      const Soften& soften, const char* failure, double tolerance = 0,
                      const VectorXd& more = {}) {
  model.prepare(x);  // so that the scales are defined
  const int n = model.n_dofs(), m = model.n_constraints();
  const VectorXd scales = model.scales();
  Constraints c;
  SparseMatrix kkt;
  DirectSolver solver;
  VectorXd residual, right(n + m), step;
  double correction = 0;
  for (int iteration = 0; iteration < 40; ++iteration) {
    const bool may_end = accelerate(x);
    model.constraints(x, c);
    model.force(x, residual);
    if (more.size() > 0) residual += more;
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
  if (correction < tolerance * size) return;  // false for NaN
  throw Error::numerical(failure);
}

/// Calls solve(part, x), which applies a fraction of the forces at x. If the full forces fail, they
/// are applied in steps, each a fraction of the remaining forces and each from the previous
/// equilibrium. Therefore forces that do not act yet rotate with the bodies.
/// @param solve  throws Error (numerical) where it finds no equilibrium; x is then undefined
/// @returns true if steps were needed
template <class Solve>
bool bring_on(State& x, const Solve& solve) {
  constexpr double kFirst = 0.1, kSmallest = 1e-4, kGrowth = 1.5;
  State last = x;
  try {
    solve(1.0, x);
    return false;
  } catch (const Error& error) {
    if (error.kind() != Error::Kind::numerical) throw;
  }
  for (double part = kFirst;;) {
    x = last;
    try {
      solve(part, x);
      if (part == 1) return true;
      last = x;
      part = std::min(1.0, kGrowth * part);
    } catch (const Error& error) {
      if (error.kind() != Error::Kind::numerical || part < kSmallest) throw;
      part *= 0.5;
    }
  }
}

/// Adds factor × (column `from` of a) to the column `to` of b, rows below n. Entries of a that b
/// lacks must be 0.
void add_column(const SparseMatrix& a, int from, double factor, int to, int n, SparseMatrix& b) {
  if (factor == 0) return;
  int p = b.outerIndexPtr()[to];
  const int end = b.outerIndexPtr()[to + 1];
  for (SparseMatrix::InnerIterator entry(a, from); entry && entry.row() < n; ++entry) {
    if (entry.value() == 0) continue;
    while (p < end && b.innerIndexPtr()[p] < entry.row()) ++p;
    if (p == end || b.innerIndexPtr()[p] != entry.row())
      throw Error::numerical(
          "statics: a force that acts on one direction only is not supported in a rotating body");
    b.valuePtr()[p] += factor * entry.value();
  }
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
      "statics: no equilibrium in the rotating frame was found at the start, t = 0, after 40 "
      "iterations: the bodies are too soft for their loads, or a part of them is not fixed");
}

void solve_carried_equilibrium(Workspace& model, State& x) {
  find_equilibrium(
      model, x, std::max(1e-300, x.q.lpNorm<Eigen::Infinity>()), [](State&) { return true; },
      [](const State&, const Constraints&, SparseMatrix&) {},
      "statics: no equilibrium with the initial inertia forces was found at the start, t = 0, "
      "after 40 iterations: the bodies are too soft for these forces, or a part of them is not "
      "fixed");
}

void add_turning_tangent(Workspace& model, const State& x, const Constraints& c,
                         std::span<const Turning> turning, SparseMatrix& kkt) {
  SparseMatrix mass, damping;
  model.kkt(x, c, {0, 0, 1}, 1, mass);
  model.kkt(x, c, {0, 1, 0}, 1, damping);
  const int n = model.n_dofs();
  for (size_t b = 0; b < turning.size(); ++b) {
    const Body& body = model.bodies()[b];
    const auto [w, w_t] = turning[b];
    for (int k = 0; k < body.element->n_vectors(); ++k) {
      const int at = body.first_dof + body.element->dim() * k;
      for (const int first : {0, 1}) {  // J (1, 0) = (0, 1), J (0, 1) = (-1, 0)
        const int own = at + first, other = at + 1 - first, sign = first == 0 ? 1 : -1;
        add_column(damping, other, sign * w, own, n, kkt);
        add_column(mass, other, sign * w_t, own, n, kkt);
        add_column(mass, own, -w * w, own, n, kkt);
      }
    }
  }
}

void solve_steady_equilibrium(Workspace& model, std::span<const Turning> turning, State& x) {
  const State rigid = x;
  const auto carry = [&](State& s) {
    s.v = rigid.v;
    s.a = rigid.a;
    for (size_t b = 0; b < turning.size(); ++b) {
      const Body& body = model.bodies()[b];
      const auto [w, w_t] = turning[b];
      for (int k = 0; k < body.element->n_vectors(); ++k) {
        const int at = body.first_dof + body.element->dim() * k;
        const Vec2 u = s.q.segment<2>(at) - rigid.q.segment<2>(at), turned(-u.y(), u.x());
        s.v.segment<2>(at) += w * turned;
        s.a.segment<2>(at) += w_t * turned - w * w * u;
      }
    }
    return true;
  };
  const auto turn = [&](const State& s, const Constraints& c, SparseMatrix& kkt) {
    add_turning_tangent(model, s, c, turning, kkt);
  };
  const double size = std::max(1e-300, x.q.lpNorm<Eigen::Infinity>());
  bring_on(x, [&](double part, State& s) {
    VectorXd unloaded;
    if (part < 1) {
      carry(s);
      model.force(s, unloaded);
      unloaded *= part - 1;
      s.lambda.setZero();
    }
    find_equilibrium(model, s, size, carry, turn,
                     "statics: no equilibrium with the initial inertia forces was found at the "
                     "start, t = 0, after 40 iterations: the bodies are too soft for these forces, "
                     "or a part of them is not fixed",
                     0, unloaded);
  });
  carry(x);
}

void solve_static_equilibrium(Workspace& model, State& x) {
  constexpr double kFirst = 1e4;  // κ [1/s²]
  constexpr double kMaxDisplacement =
      100;  // sizes of the model; a larger displacement has no restoring force
  x.v.setZero();
  const State start = x;
  const double size = std::max(1e-300, x.q.lpNorm<Eigen::Infinity>());
  const auto rest = [&](double part, State& s) {
    const VectorXd center = s.q;
    double hold = 10 * kFirst;
    // The inertia force of a = κ (q - q₀) equals the holding force.
    const auto accelerate = [&](State& at) {
      hold = std::max(0.1 * hold, kLastHold);
      at.a = hold * (at.q - center);
      return hold == kLastHold;
    };
    const auto soften = [&](const State& at, const Constraints& c, SparseMatrix& kkt) {
      model.kkt(at, c, {1, 0, hold}, 1, kkt);
    };
    VectorXd unloaded;
    if (part < 1) {
      s.a.setZero(model.n_dofs());
      model.force(s, unloaded);
      unloaded *= part - 1;
      s.lambda.setZero();
    }
    // Along a degree of freedom that only the holding force restrains, forces are zero up to the
    // round-off of stiff ones.
    find_equilibrium(model, s, size, accelerate, soften,
                     "statics: no equilibrium at rest was found after 40 iterations", 1e-7,
                     unloaded);
    s.a.setZero();
    model.follow_turns(s);
  };
  if (bring_on(x, rest)) rest(1, x);  // without the holding forces of the last step
  if (model.scales().cwiseProduct(x.q - start.q).lpNorm<Eigen::Infinity>() >
      kMaxDisplacement * size)
    throw Error::numerical(
        "statics: there is no equilibrium at rest: a body is moved by its forces and has no "
        "restoring force");
}

}  // namespace flexmorph::fem
