#include "cases/output/rigid_fit.h"

#include <Eigen/SVD>
#include <cmath>

namespace flexmorph::cases {
namespace {

/// Returns the position of a point; its third coordinate is 0 in the plane.
Vec3 point(int dim, std::span<const double> all, size_t k) {
  const auto d = static_cast<size_t>(dim);
  return {all[d * k], all[d * k + 1], dim == 3 ? all[d * k + 2] : 0};
}

Vec3 mean(int dim, std::span<const double> all) {
  Vec3 sum(0, 0, 0);
  const size_t n = all.size() / static_cast<size_t>(dim);
  for (size_t k = 0; k < n; ++k) sum += point(dim, all, k);
  return sum / static_cast<double>(n);
}

}  // namespace

RigidFit rigid_fit(int dim, std::span<const double> from, std::span<const double> to) {
  const Vec3 from_mean = mean(dim, from), to_mean = mean(dim, to);
  Eigen::Matrix3d product = Eigen::Matrix3d::Zero();  // sum of (to - mean) (from - mean)ᵀ
  for (size_t k = 0; k < from.size() / static_cast<size_t>(dim); ++k)
    product += (point(dim, to, k) - to_mean) * (point(dim, from, k) - from_mean).transpose();
  RigidFit out;
  if (dim == 2) {
    const double angle = std::atan2(product(1, 0) - product(0, 1), product(0, 0) + product(1, 1));
    out.rotation.topLeftCorner<2, 2>() << std::cos(angle), -std::sin(angle), std::sin(angle),
        std::cos(angle);
  } else {
    const Eigen::JacobiSVD<Eigen::Matrix3d> svd(product, Eigen::ComputeFullU | Eigen::ComputeFullV);
    Eigen::Matrix3d sign = Eigen::Matrix3d::Identity();  // a rotation, not a reflection
    if ((svd.matrixU() * svd.matrixV().transpose()).determinant() < 0) sign(2, 2) = -1;
    out.rotation = svd.matrixU() * sign * svd.matrixV().transpose();
  }
  out.translation = to_mean - out.rotation * from_mean;
  return out;
}

SplitDisplacements split_displacements(int dim, std::span<const double> from,
                                       std::span<const double> to) {
  const RigidFit fit = rigid_fit(dim, from, to);
  SplitDisplacements out;
  for (size_t k = 0; k < from.size() / static_cast<size_t>(dim); ++k) {
    const Vec3 before = point(dim, from, k), moved = fit.rotation * before + fit.translation,
               motion = moved - before, deformation = point(dim, to, k) - moved;
    for (int c = 0; c < dim; ++c) {
      out.motion.push_back(motion[c]);
      out.deformation.push_back(deformation[c]);
    }
  }
  return out;
}

}  // namespace flexmorph::cases
