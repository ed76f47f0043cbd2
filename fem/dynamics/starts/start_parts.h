#pragma once

#include <vector>

#include "fem/dynamics/starts/start.h"
#include "fem/solve/statics.h"

/// The equilibria of a start, for start_state() and for its derivative derive_start(). A hub is the
/// rigid frame with prescribed motion that carries a body.
namespace flexmorph::fem::start {

/// Returns the state of the model as rigid, extending bodies at time t [s]. Material lines must be
/// at their positions at t.
State rigid_state(const Model& model, std::span<const MovingRoot> moving_roots,
                  const BodyPoses& body_poses, double t);

/// Returns true if all bodies are carried by hubs with prescribed motion. The prestretched start is
/// then computed in the frames of the hubs.
bool rides_in_hubs(std::span<const MovingRoot> moving_roots, const BodyPoses& body_poses);

/// Static equilibria in rotating hubs, with the material lines frozen at their positions at given
/// times. The destructor restores the meshes of the model and moves the lines to their positions at
/// t.
class InHubs {
 public:
  /// Stores the meshes of the model, whose hubs are at time t [s].
  InHubs(Workspace& model, std::span<const MovingRoot> moving_roots, double t);
  ~InHubs();
  InHubs(const InHubs&) = delete;
  InHubs& operator=(const InHubs&) = delete;

  /// Returns the equilibrium under q̈ = -ω² (q - center), with lines at their positions at time
  /// `lines`. The model is left with the frozen mesh.
  State at(double lines);
  /// Returns ω² of every unknown (n_dofs) [1/s²].
  const VectorXd& spin() const { return spin_; }
  /// Adds the change of the velocity of bodies that rotate with their hubs, due to a change of q,
  /// to `rate`. If transposed: adds the derivatives by q that follow from derivatives by the
  /// velocity.
  void add_turn(const VectorXd& change, VectorXd& rate, bool transposed) const;

 private:
  Workspace& model_;
  std::span<const MovingRoot> moving_roots_;
  double t_;
  std::vector<std::unique_ptr<LineGrid>> moving_;
  VectorXd spin_, center_;
};

/// Returns the static equilibrium under the inertia forces of the rigid motion at t [s]; the lines
/// of the model are left at t. A strained body rotates like a rigid body, so that damping of the
/// material does not resist the rotation.
State carried_equilibrium(Workspace& model, std::span<const MovingRoot> moving_roots,
                          const BodyPoses& body_poses, double t);
/// Returns the angular velocity of every body in the state `rigid` [rad/s]; a strained body rotates
/// with it, too.
std::vector<double> spins(const Model& model, const State& rigid);
/// Adds sign · spin × change to the velocities of every body; the transposed operation has sign -1.
void add_turns(const Model& model, const std::vector<double>& spins, const VectorXd& change,
               double sign, VectorXd& rate);

/// The equilibrium of a steady start at one time.
struct SteadyEquilibrium {
  State rigid, strained;         ///< State of the rigid motion, and equilibrium.
  std::vector<Turning> turning;  ///< Angular velocity and acceleration of every body.
  std::vector<double> angle;     ///< Rotation angle of every body [rad].
};
/// Computes the equilibrium of a steady start at t [s]; the lines of the model are left at t.
/// @throws Error (numerical) as solve_steady_equilibrium().
SteadyEquilibrium steady_equilibrium(Workspace& model, std::span<const MovingRoot> moving_roots,
                                     const BodyPoses& body_poses, double t);
/// Computes the static equilibrium at zero velocity.
/// @param x  in: a rigid state; out: the equilibrium.
/// @returns true if the equilibrium is exact; otherwise a force -kLastHold M (q - q₀) acts, which
/// holds degrees of freedom with hardly any restoring force.
bool start_in_equilibrium(Workspace& model, State& x);
/// Rotates the vectors of every body by an angle [rad].
void turn_by(const Model& model, const std::vector<double>& angles, VectorXd& vectors);

/// Weights of the equilibria at t, t + δ and t + 2 δ in the rate of a start, in units of 1 / (2 δ).
inline constexpr double kForward[] = {-3, 4, -1};

}  // namespace flexmorph::fem::start
