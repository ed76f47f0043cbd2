#include "fem/dynamics/starts/start_gradient.h"

#include "fem/dynamics/starts/start_parts.h"
#include "fem/solve/statics.h"

namespace flexmorph::fem {
namespace {

/// Adjoint solutions of the equilibria of a start, for derivatives by their positions.
class Equilibria {
 public:
  Equilibria(Workspace& model, const SeeWork& see) : model_(model), see_(see) {}

  /// Solves the adjoint of the equilibrium s and passes it to SeeWork.
  /// @param w     Weights of the tangent.
  /// @param spin  See TransposedSystem::set(); may be empty.
  void derive(const State& s, const Weights& w, const VectorXd& spin, const VectorXd& by_q) {
    TransposedSystem system(model_);
    system.set(s, w, 1, spin);
    system.solve(by_q, VectorXd::Zero(model_.n_constraints()), psi_, chi_);
    see_(s, -psi_);
  }

  /// Solves the adjoint of a steady equilibrium and passes it to SeeWork.
  void derive_carried(const start::SteadyEquilibrium& s, const VectorXd& by_q) {
    TransposedSystem system(model_);
    system.set_carried(s.strained, s.turning);
    system.solve(by_q, VectorXd::Zero(model_.n_constraints()), psi_, chi_);
    see_(s.strained, -psi_);
  }

  /// Solves the adjoint of an equilibrium with material damping by iteration, and passes it to
  /// SeeWork. The velocities then depend on the shape: F(q, v(q)) with the derivative v' = T.
  void derive_turning(const State& s, const std::vector<double>& spins, const VectorXd& by_q) {
    constexpr int kPasses = 100;
    TransposedSystem system(model_);
    system.set(s, {1, 0, 0}, 1);
    const VectorXd none = VectorXd::Zero(model_.n_constraints());
    VectorXd last = VectorXd::Zero(by_q.size());
    for (int pass = 0; pass < kPasses; ++pass) {
      VectorXd seed = by_q;
      if (pass > 0) {
        VectorXd turned = VectorXd::Zero(by_q.size());
        start::add_turns(model_, spins, system.by_velocity(s, last), -1, turned);
        seed -= turned;
      }
      system.solve(seed, none, psi_, chi_);
      if ((psi_ - last).norm() <= 1e-13 * psi_.norm()) break;
      last = psi_;
    }
    see_(s, -psi_);
  }

 private:
  Workspace& model_;
  const SeeWork& see_;
  VectorXd psi_, chi_;
};

void derive_in_hubs(Workspace& model, std::span<const MovingRoot> moving_roots, double t,
                    double delta, const VectorXd& by_q, const VectorXd& by_v,
                    Equilibria& equilibria) {
  start::InHubs stretched(model, moving_roots, t);
  const auto derive = [&](double lines, const VectorXd& seed) {
    State s = stretched.at(lines);
    equilibria.derive(s, {1, 0, 0}, stretched.spin(), seed);
  };
  VectorXd now = by_q;
  stretched.add_turn(by_v, now, true);
  derive(t, now);
  derive(t + delta, by_v / (2 * delta));
  derive(t - delta, -by_v / (2 * delta));
}

void derive_mechanism(Workspace& model, std::span<const MovingRoot> moving_roots,
                      const BodyPoses& body_poses, double t, double delta, const VectorXd& by_q,
                      const VectorXd& by_v, Equilibria& equilibria) {
  for (const int k : {1, 2, 0}) {
    const double at = t + k * delta;
    const State s = start::carried_equilibrium(model, moving_roots, body_poses, at);
    VectorXd seed = start::kForward[k] / (2 * delta) * by_v;
    if (k == 0) seed += by_q;
    if (model.dissipation(s) > 0)
      equilibria.derive_turning(
          s, start::spins(model, start::rigid_state(model, moving_roots, body_poses, at)), seed);
    else
      equilibria.derive(s, {1, 0, 0}, {}, seed);
  }
}

/// Computes the transposed operations of steady_state() of start.cpp.
void derive_steady(Workspace& model, std::span<const MovingRoot> moving_roots,
                   const BodyPoses& body_poses, double t, double delta, const VectorXd& by_q,
                   const VectorXd& by_v, Equilibria& equilibria) {
  std::vector<double> now;
  for (const int k : {0, 1, 2}) {
    const start::SteadyEquilibrium s =
        start::steady_equilibrium(model, moving_roots, body_poses, t + k * delta);
    if (k == 0) now = s.angle;
    std::vector<double> on = s.angle, spins;
    for (size_t b = 0; b < on.size(); ++b) on[b] -= now[b];
    VectorXd seed = start::kForward[k] / (2 * delta) * by_v;
    start::turn_by(model, on, seed);
    if (k == 0) {
      seed += by_q;
      for (const Turning& turning : s.turning) spins.push_back(turning.rate);
      start::add_turns(model, spins, by_v, -1, seed);
    }
    equilibria.derive_carried(s, seed);
  }
  model.move_lines(t);
}

}  // namespace

void derive_start(Workspace& model, std::span<const MovingRoot> moving_roots, double t, Start kind,
                  const BodyPoses& body_poses, double delta, const VectorXd& by_q,
                  const VectorXd& by_v, const SeeWork& see) {
  if (kind == Start::rigid) return;
  Equilibria equilibria(model, see);
  if (kind == Start::settled || kind == Start::at_rest) {
    model.move_lines(t);
    State s = start::rigid_state(model, moving_roots, body_poses, t);
    const VectorXd rigid = s.q;
    if (kind == Start::settled)
      solve_static_equilibrium(model, s);
    else if (start::start_in_equilibrium(model, s))
      return equilibria.derive(s, {1, 0, 0}, {}, by_q);
    s.a = kLastHold * (s.q - rigid);
    equilibria.derive(s, {1, 0, kLastHold}, {}, by_q);
    return;
  }
  if (kind == Start::steady)
    return derive_steady(model, moving_roots, body_poses, t, delta, by_q, by_v, equilibria);
  if (start::rides_in_hubs(moving_roots, body_poses))
    derive_in_hubs(model, moving_roots, t, delta, by_q, by_v, equilibria);
  else
    derive_mechanism(model, moving_roots, body_poses, t, delta, by_q, by_v, equilibria);
}

}  // namespace flexmorph::fem
