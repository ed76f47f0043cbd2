#pragma once

#include <Eigen/Core>

namespace flexmorph::fem {

/// The thickness and the material of a plate; none of them has a default value.
struct PlaneSection {
  double thickness;       ///< Thickness of the plate [m].
  double youngs_modulus;  ///< Young's modulus E [Pa].
  double poisson_ratio;   ///< Poisson's ratio ν [-].
  double density;         ///< Mass density [kg/m³].

  /// Creates a section of the given thickness and material, in the units of the members.
  PlaneSection(double its_thickness, double its_youngs_modulus, double its_poisson_ratio,
               double its_density)
      : thickness(its_thickness),
        youngs_modulus(its_youngs_modulus),
        poisson_ratio(its_poisson_ratio),
        density(its_density) {}

  /// Returns the plane-stress stiffness P (8) in Voigt order 11, 22, 12 [Pa].
  Eigen::Matrix3d elasticity() const {
    const double nu = poisson_ratio;
    Eigen::Matrix3d c;
    c << 1, nu, 0, nu, 1, 0, 0, 0, (1 - nu) / 2;
    return youngs_modulus / (1 - nu * nu) * c;
  }
};

}  // namespace flexmorph::fem
