#include "fem/triangles/t6.h"

#include <cmath>

namespace flexmorph::fem {

const std::array<WeightedPoint, 6>& six_points() {
  constexpr double a = 0.445948490915965, wa = 0.223381589678011;
  constexpr double b = 0.091576213509771, wb = 0.109951743655322;
  static const std::array<WeightedPoint, 6> points = {{{{1 - 2 * a, a, a}, wa},
                                                       {{a, 1 - 2 * a, a}, wa},
                                                       {{a, a, 1 - 2 * a}, wa},
                                                       {{1 - 2 * b, b, b}, wb},
                                                       {{b, 1 - 2 * b, b}, wb},
                                                       {{b, b, 1 - 2 * b}, wb}}};
  return points;
}

Eigen::Matrix<double, 6, 1> t6_shapes(const AreaPoint& at) {
  const auto [l0, l1, l2] = at;
  Eigen::Matrix<double, 6, 1> n;
  n << l0 * (2 * l0 - 1), l1 * (2 * l1 - 1), l2 * (2 * l2 - 1), 4 * l0 * l1, 4 * l1 * l2,
      4 * l2 * l0;
  return n;
}

T6::T6(const std::array<Vec2, 3>& corners) : corners_(corners) {
  const auto& [a, b, c] = corners;
  const double twice = (b - a).x() * (c - a).y() - (b - a).y() * (c - a).x();
  area_ = 0.5 * twice;
  slopes_ << b.y() - c.y(), c.x() - b.x(), c.y() - a.y(), a.x() - c.x(), a.y() - b.y(),
      b.x() - a.x();
  slopes_ /= twice;
}

Vec2 T6::position(const AreaPoint& at) const {
  return at[0] * corners_[0] + at[1] * corners_[1] + at[2] * corners_[2];
}

Eigen::Matrix<double, 3, 12> T6::strains(const AreaPoint& at) const {
  Eigen::Matrix<double, 6, 2> slopes;
  for (int k = 0; k < 3; ++k) {
    const auto i = static_cast<std::size_t>(k), j = static_cast<std::size_t>((k + 1) % 3);
    slopes.row(k) = (4 * at[i] - 1) * slopes_.row(k);
    slopes.row(3 + k) = 4 * (at[j] * slopes_.row(k) + at[i] * slopes_.row((k + 1) % 3));
  }
  Eigen::Matrix<double, 3, 12> b = Eigen::Matrix<double, 3, 12>::Zero();
  for (int k = 0; k < 6; ++k) {
    b(0, 2 * k) = b(2, 2 * k + 1) = slopes(k, 0);
    b(1, 2 * k + 1) = b(2, 2 * k) = slopes(k, 1);
  }
  return b;
}

Eigen::Matrix<double, 12, 12> T6::stiffness(const PlaneSection& section) const {
  const Eigen::Matrix3d d = section.thickness * area_ / 3 * section.elasticity();
  Eigen::Matrix<double, 12, 12> k = Eigen::Matrix<double, 12, 12>::Zero();
  for (const AreaPoint& at : kThreePoints) {
    const Eigen::Matrix<double, 3, 12> b = strains(at);
    k.noalias() += b.transpose() * d * b;
  }
  return k;
}

double von_mises(const Vec3& s) {
  return std::sqrt(s[0] * s[0] - s[0] * s[1] + s[1] * s[1] + 3 * s[2] * s[2]);
}

}  // namespace flexmorph::fem
