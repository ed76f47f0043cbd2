#pragma once

#include <array>

#include "fem/section.h"
#include "geometry/base.h"

/// The six-node triangle of plane stress with straight sides. Its displacements are quadratic,
///
///   N_i = L_i (2 L_i - 1) at corners,   N_ij = 4 L_i L_j between them
///
/// in the area coordinates L. Strains are linear, so that three points integrate K exactly. The
/// nodes are numbered as in PartMesh: corners counterclockwise, then the middles of sides 0-1, 1-2,
/// 2-0.
///
/// Source: Fraeijs de Veubeke (1965).
namespace flexmorph::fem {

/// Area coordinates of a point; their sum is 1.
using AreaPoint = std::array<double, 3>;

/// Interior points that integrate quadratic polynomials exactly, each with a third of the area.
inline constexpr std::array<AreaPoint, 3> kThreePoints = {
    {{2. / 3, 1. / 6, 1. / 6}, {1. / 6, 2. / 3, 1. / 6}, {1. / 6, 1. / 6, 2. / 3}}};

/// A point of an integration rule with its fraction of the area.
struct WeightedPoint {
  AreaPoint at;   ///< Area coordinates of the point.
  double weight;  ///< Fraction of the area.
};
/// Returns the rule that is exact for polynomials of degree 4. Source: Dunavant (1985), IJNME 21,
/// 1129-1148.
const std::array<WeightedPoint, 6>& six_points();

/// Returns the values of the six shape functions.
Eigen::Matrix<double, 6, 1> t6_shapes(const AreaPoint& at);

/// One triangle, defined by its corners.
class T6 {
 public:
  /// Creates a triangle with corners in counterclockwise order [m].
  explicit T6(const std::array<Vec2, 3>& corners);

  /// Returns the area of the triangle [m²].
  double area() const { return area_; }
  /// Returns the position of a point [m].
  Vec2 position(const AreaPoint& at) const;
  /// Returns the matrix B of ε = B u (Voigt: ε₁₁, ε₂₂, 2ε₁₂), x and y of a node next to each other.
  Eigen::Matrix<double, 3, 12> strains(const AreaPoint& at) const;
  /// Returns the stiffness of the triangle [N/m].
  Eigen::Matrix<double, 12, 12> stiffness(const PlaneSection& section) const;

 private:
  std::array<Vec2, 3> corners_;
  Eigen::Matrix<double, 3, 2> slopes_;  // dL/dx, dL/dy
  double area_;
};

/// Returns the von Mises stress of plane stress (σ₁₁, σ₂₂, σ₁₂).
double von_mises(const Vec3& stress);

}  // namespace flexmorph::fem
