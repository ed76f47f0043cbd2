#pragma once

#include "fem/dynamics/balance.h"
#include "tests/support/differences.h"
#include "tests/support/models.h"

namespace flexmorph::testing {

/// Rate of change of the energy of a model along a prescribed motion at one time [W]; the motion
/// need not be a solution.
struct EnergyRate {
  double rate = 0;  ///< d(T + U + V)/dt by central differences.
  double work = 0;  ///< Power of the generalized force on the unknowns.
  fem::Powers powers;
};

inline EnergyRate energy_rate(fem::Workspace& model, const SmoothMotion& motion, double time) {
  const auto state = [&](double t) {
    fem::State x = motion.state(t);
    x.lambda = VectorXd::Zero(model.n_constraints());
    model.prepare(x);
    return x;
  };
  EnergyRate out;
  out.rate =
      first_difference([&](double dt) { return model.energies(state(time + dt)).total(); }, 1e-3);
  const fem::State x = state(time);
  VectorXd force;
  model.force(x, force);
  out.powers = fem::powers(model, x);
  out.work = force.dot(x.v);
  return out;
}

/// Returns a motion of all unknowns about the undeformed model.
inline SmoothMotion any_motion(fem::Workspace& model) {
  model.prepare(0.0);
  return {model.reference().q, 0.02 * model.scales().cwiseInverse(), 7};
}

}  // namespace flexmorph::testing
