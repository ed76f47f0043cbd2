#pragma once

#include <concepts>

#include "fem/model/workspace.h"

namespace flexmorph::fem {

/// Columns are the axes of a frame turned by an angle [rad].
Eigen::Matrix2d rotation(double angle);

/// Where a rigid body is, and how it moves: its unknowns are a point and a unit vector (natural
/// coordinates, fem/elements/rigid_body.h).
FrameMotion frame_of(const Body& rigid, const State& x);

/// The planar frame that an edge of a plate is welded to: driven, or fixed to a rigid body.
class Carrier {
 public:
  Carrier() = default;
  template <std::convertible_to<FrameDrive> Drive>
  Carrier(Drive drive) : drive_(std::move(drive)) {}
  /// @param point, angle  of the frame in the axes of the body [m], [rad]
  Carrier(std::string body, const Vec2& point, double angle)
      : body_(std::move(body)), point_(point), angle_(angle) {}

  const std::string& body() const { return body_; }  ///< empty where driven
  const FrameDrive& drive() const { return drive_; }
  const Vec2& point() const { return point_; }  ///< in the axes of the body
  double angle() const { return angle_; }
  FrameMotion at(const Model& model, const State& x) const;

 private:
  FrameDrive drive_;
  std::string body_;
  Vec2 point_{0, 0};
  double angle_ = 0;
};

}  // namespace flexmorph::fem
