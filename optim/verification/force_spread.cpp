#include "optim/verification/force_spread.h"

#include <Eigen/Dense>

namespace flexmorph::verification {
namespace {

/// Adds the forces of a pin on the half of the rim that its force points to.
/// @return true if this half can carry the force
bool add_bearing(const ForceSpread& load, std::span<const Vec2> points,
                 std::span<const double> shares, std::vector<Vec2>& out) {
  constexpr double kMinRatio = 1e-6;  // smallest det / trace² of the loaded half of the rim
  const auto normal = [&](size_t k) -> Vec2 { return (points[k] - load.center).normalized(); };
  Eigen::Matrix2d sum = Eigen::Matrix2d::Zero();
  for (size_t k = 0; k < points.size(); ++k)
    if (const Vec2 n = normal(k); n.dot(load.force) > 0) sum += shares[k] * n * n.transpose();
  if (sum.determinant() <= kMinRatio * sum.trace() * sum.trace()) return false;
  const Vec2 a = sum.inverse() * load.force;
  for (size_t k = 0; k < points.size(); ++k)
    if (const Vec2 n = normal(k); n.dot(load.force) > 0) out[k] += shares[k] * n.dot(a) * n;
  return true;
}

/// Adds the forces of a moment. @return true if the points have a lever
bool add_moment(const ForceSpread& load, std::span<const Vec2> points,
                std::span<const double> shares, std::vector<Vec2>& out) {
  Vec2 middle = Vec2::Zero();
  for (size_t k = 0; k < points.size(); ++k) middle += shares[k] * points[k];
  double levers = 0;
  for (size_t k = 0; k < points.size(); ++k)
    levers += shares[k] * (points[k] - middle).squaredNorm();
  if (levers == 0) return false;
  for (size_t k = 0; k < points.size(); ++k) {
    const Vec2 arm = points[k] - middle;
    out[k] += load.moment / levers * shares[k] * Vec2(-arm.y(), arm.x());
  }
  return true;
}

}  // namespace

std::vector<Vec2> spread(const ForceSpread& load, std::span<const Vec2> points,
                         std::span<const double> shares) {
  std::vector<Vec2> out(points.size(), Vec2::Zero());
  if (load.bearing) {
    if (!add_bearing(load, points, shares, out)) return {};
  } else {
    for (size_t k = 0; k < points.size(); ++k) out[k] = shares[k] * load.force;
  }
  if (load.moment != 0 && !add_moment(load, points, shares, out)) return {};
  return out;
}

}  // namespace flexmorph::verification
