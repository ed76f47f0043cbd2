#pragma once

#include <optional>

#include "fem/dofs.h"
#include "fem/load_law.h"
#include "fem/marker.h"
#include "fem/term.h"

namespace flexmorph::fem {

/// The seam of forces between bodies: springs, dampers, motors, loads on markers. What acts inside
/// one body is a Term.
class Link {
 public:
  virtual ~Link() = default;
  /// A copy that shares nothing with this one; to be bound before it is evaluated.
  virtual std::unique_ptr<Link> clone() const = 0;
  virtual std::string name() const = 0;

  /// Looks up the unknowns it acts on, by the names of bodies; called again after every change of a
  /// mesh or a design. @throws Error (input) for a body that does not exist.
  virtual void bind(std::span<const BodyView> bodies) = 0;

  /// Adds the generalized force that stands on the left of  M q̈ + F = Q  (n_dofs).
  /// @throws Error (numerical) where it is not defined.
  virtual void add_force(const State& x, VectorXd& out) const = 0;

  /// Appends the places of add_tangent(), in its order; the same between two bind().
  virtual void add_pattern(std::vector<Eigen::Triplet<double>>& out) const = 0;
  /// Appends w.q ∂f/∂q + w.v ∂f/∂v; places are unknowns of the model.
  virtual void add_tangent(const State& x, const Weights& w,
                           std::vector<Eigen::Triplet<double>>& out) const = 0;

  /// As Term::add_mean_force() and its tangent, at the places of add_tangent().
  /// @throws Error (input) when the link has none.
  virtual void add_mean_force(const State& mean, const VectorXd& q0, const VectorXd& q1,
                              VectorXd& out) const;
  virtual void add_mean_tangent(const State& mean, const VectorXd& q0, const VectorXd& q1,
                                const Weights& w, std::vector<Eigen::Triplet<double>>& out) const;

  /// Energies [J], zero where it has none: stored in it, and of loads that are conservative.
  virtual double strain_energy(const State&) const { return 0; }
  virtual double potential_energy(const State&) const { return 0; }
  /// Power that enters the model through the link besides what its energies give and take [W]:
  /// negative in a damper, that of a motor, and that of what shifts a marker along its axis.
  virtual double power(const State&) const { return 0; }

  /// Does it follow an angle over whole turns? Then State::turned has a place for it.
  virtual bool counts_turns() const { return false; }
  /// That angle at a state, less than half a turn from what it was after the last accepted step.
  virtual double turned(const State&) const { return 0; }
  /// @param place  in State::turned; said by the model that it is part of
  void set_place(int place) { place_ = place; }

  /// As Term::scale_load().
  virtual void scale_load(double /*factor*/) {}

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
