#include "optim/verification/balance.h"

#include <Eigen/LU>

#include "optim/verification/force_spread.h"

namespace flexmorph::verification {

MatrixXd PartBalance::rigid_motions(const PartMesh& mesh) {
  const auto n = static_cast<Eigen::Index>(mesh.points.size());
  Vec2 middle = Vec2::Zero(), lower = mesh.points.front(), upper = lower;
  for (const Vec2& p : mesh.points) {
    lower = lower.cwiseMin(p);
    upper = upper.cwiseMax(p);
  }
  middle = 0.5 * (lower + upper);
  const double size = (upper - lower).norm();
  MatrixXd out(2 * n, 3);
  for (Eigen::Index k = 0; k < n; ++k) {
    const Vec2 at = (mesh.points[static_cast<std::size_t>(k)] - middle) / size;
    out.block<2, 3>(2 * k, 0) << 1, 0, -at.y(), 0, 1, at.x();
  }
  return out;
}

PartBalance::PartBalance(const PartMesh& mesh, std::array<PinNodes, 2> pins)
    : rigid_(rigid_motions(mesh)),
      balancing_(MatrixXd::Zero(rigid_.rows(), 3)),
      pins_(std::move(pins)) {
  const Vec2 line = pins_[1].pin.center - pins_[0].pin.center;
  if (!(line.norm() > 0))
    throw Error::input("verification: both pins of a link are at the same location");
  across_ = Vec2(-line.y(), line.x()).normalized();
  for (std::size_t p = 0; p < 2; ++p)
    for (const auto& [node, share] : pins_[p].shares) {
      points_[p].push_back(mesh.point(node));
      if (p == 0)
        balancing_(2 * node, 0) = balancing_(2 * node + 1, 1) = share;
      else
        balancing_.block<2, 1>(2 * node, 2) = share * across_;
    }
  together_ = Eigen::Matrix3d(rigid_.transpose() * balancing_).inverse();
}

PartBalance::PartBalance(const PartMesh& mesh, const MatrixXd& inertia)
    : rigid_(rigid_motions(mesh)), balancing_(inertia) {
  together_ = Eigen::Matrix3d(rigid_.transpose() * balancing_).inverse();
}

void PartBalance::apply(VectorXd& forces) const {
  const auto reactions = [&]() -> Vec3 { return together_ * (rigid_.transpose() * forces); };
  const Vec3 c = reactions();
  const std::array<Vec2, 2> pushed = {-c.head<2>(), -c[2] * across_};
  for (std::size_t p = 0; p < 2; ++p) {
    if (!pins_[p].pin.bearing || pushed[p] == Vec2::Zero()) continue;
    std::vector<double> shares;
    for (const auto& [node, share] : pins_[p].shares) shares.push_back(share);
    const std::vector<Vec2> pressed = spread(
        {.force = pushed[p], .bearing = true, .center = pins_[p].pin.center}, points_[p], shares);
    for (std::size_t k = 0; k < pressed.size(); ++k)
      forces.segment<2>(2 * pins_[p].shares[k].first) += pressed[k];
  }
  forces -= balancing_ * reactions();
}

}  // namespace flexmorph::verification
