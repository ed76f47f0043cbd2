#pragma once

#include "fem/element.h"

namespace flexmorph::fem {

/// Mass integrals of a mesh. N_k multiplies the identity, so that one direction stands for all; the
/// matrices of T are these ⊗ 1.
struct ThermalMatrices {
  MatrixXd M;    ///< ∫ ρb N Nᵀ dA (n x n), n the vector unknowns of the body [kg m^order]
  VectorXd S;    ///< ∫ ρb N dA = M A_r
  VectorXd A_r;  ///< translation: 1 at positions, 0 at gradients, T (8)
  MatrixXd reference;         ///< e_o (n x dim)
  Eigen::RowVectorXd centre;  ///< X_cm = Sᵀ e_o / Sᵀ A_r [m]

  /// Returns e_o - A_r X_cm (n x dim). A free, uniform, isotropic growth by a = α ΔT adds a times
  /// it to the unknowns: positions grow from the centre of mass, gradients by the factor a.
  MatrixXd from_centre() const { return reference - A_r * centre; }
};

/// @param area_density  ρb, density times width or thickness [kg/m²]
/// @throws Error (input) for a rigid body and for a mesh with lines that move.
ThermalMatrices thermal_matrices(const Element& element, double area_density,
                                 const Factors& factors = {});

}  // namespace flexmorph::fem
