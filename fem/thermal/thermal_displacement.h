#pragma once

#include "fem/element.h"

namespace flexmorph::fem {

/// Mass integrals of a mesh. N_k multiplies the identity, so that one direction represents all; the
/// matrices of T are the present ones ⊗ 1.
struct ThermalMatrices {
  /// Mass matrix ∫ ρb N Nᵀ dA (n x n), n the number of vector unknowns of the body [kg m^order].
  MatrixXd M;
  VectorXd S;                 ///< First moment ∫ ρb N dA = M A_r.
  VectorXd A_r;               ///< Translation: 1 at positions, 0 at gradients, T (8).
  MatrixXd reference;         ///< Unknowns e_o of the reference (n x dim).
  Eigen::RowVectorXd centre;  ///< Centre of mass X_cm = Sᵀ e_o / Sᵀ A_r [m].

  /// Returns e_o - A_r X_cm (n x dim). A free, uniform, isotropic expansion by a = α ΔT adds a
  /// times this matrix to the unknowns: positions move away from the centre of mass, gradients grow
  /// by the factor a.
  MatrixXd from_centre() const { return reference - A_r * centre; }
};

/// Returns the mass integrals of a mesh.
/// @param area_density  ρb, density times width or thickness [kg/m²]
/// @throws Error (input) for a rigid body and for a mesh with lines that move.
ThermalMatrices thermal_matrices(const Element& element, double area_density,
                                 const ScaleFactors& factors = {});

}  // namespace flexmorph::fem
