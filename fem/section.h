#pragma once

#include <Eigen/Core>

namespace flexmorph::fem {

/// The thickness and the material of a plate, none of which has a default value.
struct PlaneSection {
  double thickness;       ///< [m]
  double youngs_modulus;  ///< [Pa]
  double poisson_ratio;   ///< [-]
  double density;         ///< [kg/m^3]

  PlaneSection(double its_thickness, double its_youngs_modulus, double its_poisson_ratio,
               double its_density)
      : thickness(its_thickness),
        youngs_modulus(its_youngs_modulus),
        poisson_ratio(its_poisson_ratio),
        density(its_density) {}

  /// Plane-stress stiffness P (8) in Voigt order 11, 22, 12 [Pa].
  Eigen::Matrix3d elasticity() const {
    const double nu = poisson_ratio;
    Eigen::Matrix3d c;
    c << 1, nu, 0, nu, 1, 0, 0, 0, (1 - nu) / 2;
    return youngs_modulus / (1 - nu * nu) * c;
  }
};

}  // namespace flexmorph::fem
