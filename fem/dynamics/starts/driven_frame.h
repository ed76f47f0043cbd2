#pragma once

#include <concepts>

#include "fem/model/workspace.h"

namespace flexmorph::fem {

/// Returns the rotation matrix of an angle [rad]; its columns are the axes of the rotated frame.
Eigen::Matrix2d rotation(double angle);

/// Returns the motion of the axes of a rigid body at state x. The unknowns of the body are a point
/// and a unit vector (natural coordinates, fem/elements/rigid_body.h).
FrameMotion frame_of(const Body& rigid, const State& x);

/// The driven frame (hub) of a plate: the planar rigid frame to which an edge of the plate is
/// welded. Its motion is prescribed, or it is fixed to a rigid body.
class DrivenFrame {
 public:
  DrivenFrame() = default;
  /// Creates a frame with prescribed motion.
  template <std::convertible_to<FrameDrive> Drive>
  DrivenFrame(Drive drive) : drive_(std::move(drive)) {}
  /// Creates a frame that is fixed to a rigid body.
  /// @param point, angle  Origin and angle of the frame in the axes of the body [m], [rad].
  DrivenFrame(std::string body, const Vec2& point, double angle)
      : body_(std::move(body)), point_(point), angle_(angle) {}

  /// Returns the name of the rigid body; empty for a frame with prescribed motion.
  const std::string& body() const { return body_; }
  /// Returns the prescribed motion; empty for a frame that is fixed to a rigid body.
  const FrameDrive& drive() const { return drive_; }
  /// Returns the origin of the frame in the axes of the rigid body [m].
  const Vec2& point() const { return point_; }
  /// Returns the angle of the frame in the axes of the rigid body [rad].
  double angle() const { return angle_; }
  /// Returns the motion of the frame at state x.
  FrameMotion at(const Model& model, const State& x) const;

 private:
  FrameDrive drive_;
  std::string body_;
  Vec2 point_{0, 0};
  double angle_ = 0;
};

}  // namespace flexmorph::fem
