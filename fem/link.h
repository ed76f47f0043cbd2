#pragma once

#include <optional>

#include "fem/dofs.h"
#include "fem/load_law.h"
#include "fem/marker.h"
#include "fem/term.h"

namespace flexmorph::fem {

/// A force element between bodies: springs, dampers, motors, loads on markers. What acts inside one
/// body is a Term. What a force element can do besides it says by deriving from the interfaces
/// below, too; the model asks once, when it is added (model/model_link.h).
class Link {
 public:
  virtual ~Link() = default;
  /// Returns a copy that shares nothing with this one; it is to be bound before it is evaluated.
  virtual std::unique_ptr<Link> clone() const = 0;
  /// Returns what messages call it.
  virtual std::string name() const = 0;

  /// Looks up the unknowns it acts on, by the names of bodies; called again after every change of a
  /// mesh or a design. @throws Error (input) for a body that does not exist.
  virtual void bind(std::span<const BodyView> bodies) = 0;

  /// Adds the generalized force that stands on the left of  M q̈ + F = Q  (n_dofs).
  /// @throws Error (numerical) where it is not defined.
  virtual void add_force(const State& x, VectorXd& out) const = 0;

  /// Appends the places of add_tangent(), in its order; they stay between two bind().
  virtual void add_pattern(std::vector<Eigen::Triplet<double>>& out) const = 0;
  /// Appends w.q ∂f/∂q + w.v ∂f/∂v; places are unknowns of the model.
  virtual void add_tangent(const State& x, const Weights& w,
                           std::vector<Eigen::Triplet<double>>& out) const = 0;

  /// Returns its energies [J], zero where it has none: strain energy stored in it, and the
  /// potential of loads that are conservative.
  virtual Energies energies(const State&) const { return {}; }
  /// Returns the power that enters the model through it besides what its energies give and take
  /// [W]: negative in a damper, that of a motor, and that of what shifts a marker along its axis.
  virtual double power(const State&) const { return 0; }
};

/// A force element with a mean force of a step that keeps the energy, see MeanForceTerm.
class MeanForceLink {
 public:
  virtual ~MeanForceLink() = default;
  /// Adds the mean force of a step from q0 to q1 (n_dofs).
  virtual void add_mean_force(const State& mean, const VectorXd& q0, const VectorXd& q1,
                              VectorXd& out) const = 0;
  /// Appends its derivative, at the places of Link::add_tangent().
  virtual void add_mean_tangent(const State& mean, const VectorXd& q0, const VectorXd& q1,
                                const Weights& w,
                                std::vector<Eigen::Triplet<double>>& out) const = 0;
};
/// Says that a force element has no mean force. @throws Error (input)
[[noreturn]] void refuse_mean_force(const std::string& link);

/// A force element that may follow an angle over whole turns.
class TurningLink {
 public:
  virtual ~TurningLink() = default;
  /// Tells whether it does; then State::turned has a place for the angle.
  virtual bool counts_turns() const { return true; }
  /// Returns that angle at a state, less than half a turn from what it was after the last accepted
  /// step [rad].
  virtual double turned(const State& x) const = 0;
  /// @param place  in State::turned; said by the model that it is part of
  void set_place(int place) { place_ = place; }

 protected:
  int place() const { return place_; }

 private:
  int place_ = 0;
};

/// Springs along a line and forces on points have mean forces where no place is shifted; torsion
/// springs and torques have none.

/// Spring and damper along the line between two points, l = |p_b - p_a|: the tension is
/// N = k (l - l₀) + c l̇.
struct SpringData {
  double stiffness = 0;    ///< k [N/m]
  double damping = 0;      ///< c [N s/m]
  double free_length = 0;  ///< l₀ [m]
};
/// @throws Error (input) for a number that is negative or not finite; at bind() see Marker::bind();
/// (numerical) where the points meet and the direction matters (l₀ > 0 or c > 0).
std::unique_ptr<Link> make_spring(std::string name, MarkerPlace a, MarkerPlace b,
                                  const SpringData& spring);

/// Torsion spring and damper between axes 1 of two rigid bodies (or the ground): with φ the angle
/// θ_b - θ_a - φ₀, the moment M = k φ + c φ̇ turns b back and a forth. Turns count: the angle goes
/// on from that of the last accepted step.
struct TorsionSpringData {
  double stiffness = 0;   ///< k [N m/rad]
  double damping = 0;     ///< c [N m s/rad]
  double rest_angle = 0;  ///< φ₀ [rad]
  /// What θ_b - θ_a is next to before the first step [rad]; else it is next to φ₀.
  std::optional<double> start_angle{};
};
std::unique_ptr<Link> make_torsion_spring(std::string name, MarkerPlace a, MarkerPlace b,
                                          const TorsionSpringData& spring);

/// Force on a point (2) [N], along the axes of the world, or along those of the place: then it
/// turns with its rigid body. Model::scale_loads() scales it. It has a potential where it is
/// constant in the world.
/// @throws Error (input) for a number that is not finite
std::unique_ptr<Link> make_point_force(std::string name, MarkerPlace at, const LoadLaw& force,
                                       bool turns = false);

/// Torque on a rigid body (1), counter-clockwise [N m]; Model::scale_loads() scales it.
std::unique_ptr<Link> make_torque(std::string name, MarkerPlace at, const LoadLaw& torque);

}  // namespace flexmorph::fem
