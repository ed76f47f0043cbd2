#pragma once

#include <Eigen/Core>

namespace flexmorph::fem {

/// What a plate in the plane is made of.
struct PlaneSection {
  double thickness = 0.01;      ///< [m]
  double youngs_modulus = 1e8;  ///< [Pa]
  double poisson_ratio = 0.3;   ///< [-]
  double density = 2700;        ///< [kg/m^3]

  /// Plane-stress stiffness P (8) in Voigt order 11, 22, 12 [Pa].
  Eigen::Matrix3d elasticity() const {
    const double nu = poisson_ratio;
    Eigen::Matrix3d c;
    c << 1, nu, 0, nu, 1, 0, 0, 0, (1 - nu) / 2;
    return youngs_modulus / (1 - nu * nu) * c;
  }
};

}  // namespace flexmorph::fem
