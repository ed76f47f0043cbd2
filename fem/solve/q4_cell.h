#pragma once

#include <array>

#include "fem/section.h"
#include "geometry/base.h"

namespace flexmorph::fem {

/// Corners of a cell, counterclockwise from (left, bottom): offsets of node (i, j).
inline constexpr std::array<int, 4> kCornerI = {0, 1, 1, 0}, kCornerJ = {0, 0, 1, 1};

/// Returns the 8 x 8 stiffness of a rectangular bilinear plane-stress cell of full material, by 2 x
/// 2 Gauss points [N/m]. Corners are counterclockwise from (left, bottom), x and y interleaved.
Eigen::Matrix<double, 8, 8> q4_stiffness(const PlaneSection& s, double dx, double dy);

/// Returns the scalar consistent mass matrix of a rectangular bilinear cell between its corners
/// [kg], 4 x 4.
Eigen::Matrix4d q4_mass(const PlaneSection& s, double dx, double dy);

/// Evaluates u . K u of one cell for many loads, K = q4_stiffness().
///
/// Constant strain and the two hourglass shapes of a bilinear field on a rectangle do not couple,
/// and 2 x 2 Gauss points integrate them exactly. Therefore u . K u is a sum of a few squares of
///   s = 2 dx u,x     d = 2 dy u,y     h = dx dy u,xy     (at the centre)
/// for each of the two displacements u and v. This takes a quarter of the operations of the 8 x 8
/// product.
class Q4Energy {
 public:
  /// Computes the coefficients of a cell of size dx x dy [m].
  Q4Energy(const PlaneSection& s, double dx, double dy);

  /// Values of n loads at the corners.
  struct Corners {
    /// Values of the displacements in x and y at the four corners, each an array of n loads.
    std::array<const double*, 4> u, v;
  };
  /// Computes energy[l] = w[l] u_l . K u_l; none of the arrays may overlap `energy`.
  void weighted(const Corners& corners, const double* w, Eigen::Index n, double* energy) const;

 private:
  double s_u_, d_v_, coupling_, d_u_, s_v_, shear_, h_u_, h_v_;
};

/// Evaluates z . M a of one cell for many fields, M = q4_mass(), in the shapes that diagonalise M.
class Q4MassProduct {
 public:
  /// Computes the coefficients of a cell of size dx x dy [m].
  Q4MassProduct(const PlaneSection& s, double dx, double dy)
      : mass_(s.density * s.thickness * dx * dy / 144) {}

  /// Values of n fields at the four corners of a cell.
  using Corners = std::array<const double*, 4>;
  /// Computes product[l] = z_l . M a_l; none of the arrays may overlap `product`.
  void multiply(const Corners& z, const Corners& a, Eigen::Index n, double* product) const;

 private:
  double mass_;
};

}  // namespace flexmorph::fem
