#include "fem/force_elements/pair_coordinate.h"

#include <cmath>
#include <numbers>

namespace flexmorph::fem {
namespace {

using Values = MarkerPair::Values;
constexpr auto kPositionA = MarkerPair::kPositionA, kAxisA = MarkerPair::kAxisA,
               kPositionB = MarkerPair::kPositionB, kAxisB = MarkerPair::kAxisB;

Vec2 difference(const Values& y) { return y.segment<2>(kPositionB) - y.segment<2>(kPositionA); }

/// Adds sign times the angle of the axis e at index `part` of y. The gradient is θ_e = J e / |e|²,
/// with J the rotation by 90 degrees.
void add_angle(const Values& y, MarkerPair::Part part, double sign, PairCoordinate& out) {
  const double x = y[part], z = y[part + 1], square = x * x + z * z;
  out.z += sign * std::atan2(z, x);
  out.z_y.segment<2>(part) += sign / square * Vec2(-z, x);
  Eigen::Matrix2d by_ee;
  by_ee << 2 * x * z, z * z - x * x, z * z - x * x, -2 * x * z;
  out.z_yy.block<2, 2>(part, part) += sign / (square * square) * by_ee;
}

}  // namespace

PairCoordinate coordinate_along(const Values& y, int axis) {
  // z = e · (M d), with M the identity for axis 0 and the rotation by -90 degrees for axis 1.
  Eigen::Matrix2d m = Eigen::Matrix2d::Identity();
  if (axis == 1) m << 0, 1, -1, 0;
  const Vec2 e = y.segment<2>(kAxisA), d = difference(y);
  PairCoordinate out;
  out.z = e.dot(m * d);
  out.z_y.segment<2>(kAxisA) = m * d;
  out.z_y.segment<2>(kPositionB) = m.transpose() * e;
  out.z_y.segment<2>(kPositionA) = -(m.transpose() * e);
  out.z_yy.block<2, 2>(kAxisA, kPositionB) = m;
  out.z_yy.block<2, 2>(kPositionB, kAxisA) = m.transpose();
  out.z_yy.block<2, 2>(kAxisA, kPositionA) = -m;
  out.z_yy.block<2, 2>(kPositionA, kAxisA) = -m.transpose();
  return out;
}

PairCoordinate distance_between(const Values& y) {
  const Vec2 d = difference(y);
  PairCoordinate out;
  out.z = d.norm();
  if (!(out.z > 0)) return out;
  const Vec2 e = d / out.z;
  const Eigen::Matrix2d by_dd = (Eigen::Matrix2d::Identity() - e * e.transpose()) / out.z;
  out.z_y.segment<2>(kPositionB) = e;
  out.z_y.segment<2>(kPositionA) = -e;
  out.z_yy.block<2, 2>(kPositionA, kPositionA) = by_dd;
  out.z_yy.block<2, 2>(kPositionB, kPositionB) = by_dd;
  out.z_yy.block<2, 2>(kPositionA, kPositionB) = -by_dd;
  out.z_yy.block<2, 2>(kPositionB, kPositionA) = -by_dd;
  return out;
}

PairCoordinate angle_between(const Values& y, double near) {
  PairCoordinate out;
  add_angle(y, kAxisA, -1, out);
  add_angle(y, kAxisB, 1, out);
  out.z = near + std::remainder(out.z - near, 2 * std::numbers::pi);
  return out;
}

void add_along(const PairCoordinate& c, const Values& rate, const CoordinateForce& n,
               PairForce& out) {
  out.s += n.total * c.z_y;
  out.conservative += n.elastic * c.z_y;
  out.s_y += c.z_y * (n.by_z * c.z_y + n.by_rate * (c.z_yy * rate)).transpose() + n.total * c.z_yy;
  out.s_rate += n.by_rate * c.z_y * c.z_y.transpose();
}

}  // namespace flexmorph::fem
