#pragma once

#include <optional>

#include "fem/dofs.h"
#include "fem/load_law.h"
#include "fem/marker.h"
#include "fem/term.h"

namespace flexmorph::fem {

/// Interface of a force element between bodies: springs, dampers, motors, loads on markers. An
/// effect inside one body is a Term. Further abilities of a force element are the interfaces below,
/// from which its class also derives; the model looks them up once, when the force element is added
/// (model/model_force_element.h).
class ForceElement {
 public:
  virtual ~ForceElement() = default;
  /// Returns a copy that shares no data with this force element; call bind() before it is
  /// evaluated.
  virtual std::unique_ptr<ForceElement> clone() const = 0;
  /// Returns the name of the force element, which messages use.
  virtual std::string name() const = 0;

  /// Finds the unknowns of the force element by the names of bodies; it is called again after every
  /// change of a mesh or a design.
  /// @throws Error (input) for a body that does not exist.
  virtual void bind(std::span<const BodyView> bodies) = 0;

  /// Adds the generalized force f (n_dofs), a contribution to F in M q̈ + F = 0.
  /// @throws Error (numerical) where the force is not defined.
  virtual void add_force(const State& x, VectorXd& out) const = 0;

  /// Appends the positions of the entries of add_tangent(), in the same order; they stay the same
  /// between two calls of bind().
  virtual void add_pattern(std::vector<Eigen::Triplet<double>>& out) const = 0;
  /// Appends the entries of w.q ∂f/∂q + w.v ∂f/∂v; row and column are unknowns of the model.
  virtual void add_tangent(const State& x, const Weights& w,
                           std::vector<Eigen::Triplet<double>>& out) const = 0;

  /// Returns the strain energy stored in the force element and the potential of conservative loads
  /// [J]; zero where there is none.
  virtual Energies energies(const State&) const { return {}; }
  /// Returns the power that enters the model through the force element in addition to the change of
  /// its energies [W]: negative for a damper; it includes the power of a motor and the power needed
  /// to shift a marker along its axis.
  virtual double power(const State&) const { return 0; }
};

/// Interface of a force element with an energy-conserving mean force over a time step, see
/// MeanForceTerm.
class MeanForceElement {
 public:
  virtual ~MeanForceElement() = default;
  /// Adds the mean force of a step from q0 to q1 (n_dofs).
  virtual void add_mean_force(const State& mean, const VectorXd& q0, const VectorXd& q1,
                              VectorXd& out) const = 0;
  /// Appends the derivative of the mean force, at the positions of ForceElement::add_tangent().
  virtual void add_mean_tangent(const State& mean, const VectorXd& q0, const VectorXd& q1,
                                const Weights& w,
                                std::vector<Eigen::Triplet<double>>& out) const = 0;
};
/// Throws the error that a force element has no mean force.
/// @throws Error (input)
[[noreturn]] void refuse_mean_force(const std::string& force_element);

/// Interface of a force element that may count an angle over whole turns.
class TurningForceElement {
 public:
  virtual ~TurningForceElement() = default;
  /// Returns true if the element counts an angle; State::turned then has an entry for it.
  virtual bool counts_turns() const { return true; }
  /// Returns the counted angle at a state [rad]; it differs by less than 180 degrees from the angle
  /// after the last accepted step.
  virtual double turned(const State& x) const = 0;
  /// Sets the index of the angle in State::turned; the model calls it.
  /// @param location  index in State::turned
  void set_turn_index(int location) { location_ = location; }

 protected:
  /// Returns the index of the angle in State::turned.
  int location() const { return location_; }

 private:
  int location_ = 0;
};

/// Data of a spring and damper along the line between two points at the distance l = |p_b - p_a|;
/// the tension is N = k (l - l₀) + c l̇.
struct SpringData {
  double stiffness = 0;    ///< Stiffness k [N/m].
  double damping = 0;      ///< Damping coefficient c [N s/m].
  double free_length = 0;  ///< Length l₀ of the unloaded spring [m].
};
/// Creates a spring and damper between two points. It has a mean force where no marker is shifted
/// along its axis.
/// @throws Error (input) for a number that is negative or not finite; at bind() see Marker::bind();
/// (numerical) where the points coincide and the direction matters (l₀ > 0 or c > 0).
std::unique_ptr<ForceElement> make_spring(std::string name, MarkerLocation a, MarkerLocation b,
                                          const SpringData& spring);

/// Data of a torsion spring and damper between axes 1 of two rigid bodies (or the ground). With the
/// angle φ = θ_b - θ_a - φ₀, the moment M = k φ + c φ̇ acts on b against φ and on a in the opposite
/// direction. Whole turns are counted: the angle is continued from its value at the last accepted
/// step.
struct TorsionSpringData {
  double stiffness = 0;   ///< Torsional stiffness k [N m/rad].
  double damping = 0;     ///< Torsional damping c [N m s/rad].
  double rest_angle = 0;  ///< Angle φ₀ of the unloaded spring [rad].

  /// Angle near which θ_b - θ_a lies before the first step [rad]; φ₀ if absent.
  std::optional<double> start_angle{};
};
/// Creates a torsion spring and damper between axes 1 of two rigid bodies or the ground; it has no
/// mean force.
/// @throws Error (input) for a stiffness or damping that is negative or not finite, and for an
/// angle φ₀ that is not finite or below -1e6; at bind() see Marker::bind().
std::unique_ptr<ForceElement> make_torsion_spring(std::string name, MarkerLocation a,
                                                  MarkerLocation b,
                                                  const TorsionSpringData& spring);

/// Creates a force on a point (2) [N], along the axes of the world or, if `turns`, along the axes
/// of the marker, so that it turns with its rigid body. Model::scale_loads() scales it. It has a
/// potential where it is constant in the world frame, and a mean force if it does not turn and its
/// marker is not shifted along its axis.
/// @throws Error (input) for a number that is not finite and for another number of components
std::unique_ptr<ForceElement> make_point_force(const std::string& name, MarkerLocation at,
                                               const LoadLaw& force, bool turns = false);

/// Creates a torque on a rigid body (1), counter-clockwise [N m]; Model::scale_loads() scales it.
/// It has no mean force.
/// @throws Error (input) for a number that is not finite and for another number of components
std::unique_ptr<ForceElement> make_torque(const std::string& name, MarkerLocation at,
                                          const LoadLaw& torque);

}  // namespace flexmorph::fem
