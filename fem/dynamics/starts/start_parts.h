#pragma once

#include <vector>

#include "fem/dynamics/starts/start.h"
#include "fem/solve/statics.h"

/// The equilibria that a prestretched start is made of: for start_state(), and for who derives it.
namespace flexmorph::fem::start {

/// The whole model as rigid, extending bodies; its lines are where they are at t.
State rigid_state(const Model& model, std::span<const Growth> growths, const Placement& placement,
                  double t);

/// Do all bodies ride in hubs that are driven? Then the start is stretched in their frames.
bool rides_in_hubs(std::span<const Growth> growths, const Placement& placement);

/// Static equilibria in turning hubs with the lines frozen where they are at some times. The
/// model's meshes are as they were, lines at t, when this is gone.
class InHubs {
 public:
  InHubs(Workspace& model, std::span<const Growth> growths, double t);
  ~InHubs();
  InHubs(const InHubs&) = delete;
  InHubs& operator=(const InHubs&) = delete;

  /// q̈ = -ω² (q - center): the equilibrium, on the frozen mesh that the model is left with.
  State at(double lines);
  const VectorXd& spin() const { return spin_; }  ///< ω² of every unknown (n_dofs) [1/s²]
  /// Adds what a change of q makes of the rate of a body that turns with its hub; transposed: what
  /// derivatives by that rate make of those by q.
  void add_turn(const VectorXd& change, VectorXd& rate, bool transposed) const;

 private:
  Workspace& model_;
  std::span<const Growth> growths_;
  double t_;
  std::vector<std::unique_ptr<LineGrid>> moving_;
  VectorXd spin_, center_;
};

/// Static equilibrium under the inertia forces of the rigid motion at t, where the model's lines
/// are left. A strained body turns as a rigid one, so that its material does not damp that.
State carried_equilibrium(Workspace& model, std::span<const Growth> growths,
                          const Placement& placement, double t);
/// Angular velocities by which a body that is strained turns, as `rigid` does, for its velocities
/// to follow: every body's [rad/s].
std::vector<double> spins(const Model& model, const State& rigid);
/// Adds spin × change to the velocities of every body (transposed: minus it).
void add_turns(const Model& model, const std::vector<double>& spins, const VectorXd& change,
               double sign, VectorXd& rate);

/// The equilibrium of a steady start at a time, at which the model's lines are left.
struct SteadyEquilibrium {
  State rigid, strained;
  std::vector<Turning> turning;  ///< of every body
  std::vector<double> angle;     ///< that every body is turned by [rad]
};
/// Finds the equilibrium of a steady start at t. @throws Error (numerical) as
/// solve_steady_equilibrium()
SteadyEquilibrium steady_equilibrium(Workspace& model, std::span<const Growth> growths,
                                     const Placement& placement, double t);
/// Static equilibrium at rest from a rigid state.
/// @return is it exact? Else kLastHold holds what forces hardly bring back.
bool rest_in_equilibrium(Workspace& model, State& x);
/// Turns the vectors of every body by an angle.
void turn_by(const Model& model, const std::vector<double>& angles, VectorXd& vectors);

/// Weights of the equilibria at t, t + δ and t + 2 δ in the rate of a start, by
/// 1 / (2 δ).
inline constexpr double kForward[] = {-3, 4, -1};

}  // namespace flexmorph::fem::start
