#pragma once

#include "fem/section.h"
#include "fem/terms/eulerian_work.h"

namespace flexmorph::fem {

/// Energy density W = h/2 εᵀ C ε of a St. Venant-Kirchhoff membrane, P (6)-(8); measures r_m, r_n.
class MembraneDensity final : public LinearDensity {
 public:
  /// Creates the density of a section.
  explicit MembraneDensity(const PlaneSection& s)
      : LinearDensity(green_lagrange(), s.thickness * s.elasticity()),
        elasticity_(s.thickness * s.elasticity()) {}
  double energy(const Measures& z, Measures* gradient, MeasureHessian* hessian) const override;

 private:
  Eigen::Matrix3d elasticity_;  // h C [N/m]
};

}  // namespace flexmorph::fem
