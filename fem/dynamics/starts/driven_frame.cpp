#include "fem/dynamics/starts/driven_frame.h"

#include <cmath>

namespace flexmorph::fem {
namespace {

Vec2 quarter_turn(const Vec2& x) { return {-x.y(), x.x()}; }

}  // namespace

Eigen::Matrix2d rotation(double angle) {
  Eigen::Matrix2d r;
  r << std::cos(angle), -std::sin(angle), std::sin(angle), std::cos(angle);
  return r;
}

FrameMotion frame_of(const Body& rigid, const State& x) {
  const int r = rigid.first_dof, u = r + 2;
  const Vec2 axis = x.q.segment<2>(u), across = quarter_turn(axis);
  const double square = axis.squaredNorm();
  FrameMotion f;
  f.origin = x.q.segment<2>(r);
  f.origin_rate = x.v.segment<2>(r);
  f.origin_acceleration = x.a.segment<2>(r);
  f.angle = std::atan2(axis.y(), axis.x());
  f.angle_rate = across.dot(x.v.segment<2>(u)) / square;
  f.angle_acceleration = across.dot(x.a.segment<2>(u)) / square;
  return f;
}

FrameMotion DrivenFrame::at(const Model& model, const State& x) const {
  if (body_.empty()) return drive_(x.t);
  FrameMotion f = frame_of(model.body(body_), x);
  const Vec2 arm = rotation(f.angle) * point_, across = quarter_turn(arm);
  f.origin += arm;
  f.origin_rate += f.angle_rate * across;
  f.origin_acceleration += f.angle_acceleration * across - f.angle_rate * f.angle_rate * arm;
  f.angle += angle_;
  return f;
}

}  // namespace flexmorph::fem
