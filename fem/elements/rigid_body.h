#pragma once

#include "fem/element.h"
#include "fem/rigid.h"

namespace flexmorph::fem {

/// A planar rigid body in natural coordinates: a point r of the body and its first axis u,
///
///   x(X, Y) = r + X u + Y v,   v = u turned by +90 degrees,   |u|² = 1
///
/// u is an unknown with two entries; therefore the mass matrix is constant and joints are of degree
/// 2 at most. The joint make_unit_axis() (fem/body_joints.h), which every rigid body needs, keeps
/// the length of u. The vector unknowns are r (number 0) and u (number 1).
///
/// v is no multiple of u; therefore there are no shape functions r = Qᵀ N. Points of the body are
/// evaluated by a Marker (fem/marker.h), and mass and weight are separate terms (fem/rigid.h).
///
/// Source: García de Jalón & Bayo (1994), Kinematic and Dynamic Simulation of Multibody Systems,
/// ch. 2 and 4.2; fem/README.md, Rigid bodies and joints.
class RigidBody final : public Element, public MovingElement, public RigidClock {
 public:
  /// Creates the element of a rigid body.
  /// @param length  length that turns the axis into a displacement: a size of the body, such as its
  /// radius of gyration [m]
  /// @param moves   true if the mass changes in time because of a material reservoir
  /// (fem/material_reservoir.h)
  /// @throws Error (input) unless the length is positive.
  explicit RigidBody(double length, bool moves = false);

  std::unique_ptr<Element> clone() const override { return std::make_unique<RigidBody>(*this); }
  std::span<const int> vectors(int e) const override;
  double scale(int k) const override { return k == 0 ? 1 : length_; }
  bool is_position(int k) const override { return k == 0; }
  /// Returns r = (0, 0), u = (1, 0).
  MatrixXd reference() const override;
  void move_to(double t) override { time_ = t; }
  bool moving(int /*e*/) const override { return moves_; }
  double time() const override { return time_; }

 private:
  double length_, time_ = 0;
  bool moves_;
};

}  // namespace flexmorph::fem
