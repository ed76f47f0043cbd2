#pragma once

#include <span>

#include "fem/element.h"

namespace flexmorph::fem {

/// Mass integrals of a mesh. N_k multiplies the identity, so that one direction stands for all; the
/// matrices of T are these ⊗ 1.
struct ThermalMatrices {
  MatrixXd M;     ///< ∫ ρb N Nᵀ dA (n x n), n the vector unknowns of the body [kg m^order]
  MatrixXd M_rd;  ///< Σ_j ∫ ρb N_rd N_rdᵀ dA, N_rd = N - N(x_o), x_o first node of element j
  VectorXd S;     ///< ∫ ρb N dA = M A_r
  VectorXd A_r;   ///< translation: 1 at positions, 0 at gradients, T (8)
  MatrixXd reference;         ///< e_o (n x dim)
  Eigen::RowVectorXd centre;  ///< X_cm = Sᵀ e_o / Sᵀ A_r [m]

  /// e_o - A_r X_cm (n x dim).
  MatrixXd from_centre() const { return reference - A_r * centre; }
};

/// @param area_density  ρb, density times width or thickness [kg/m²]
/// @throws Error (input) for a rigid body and for a mesh with lines that move.
ThermalMatrices thermal_matrices(const Element& element, double area_density,
                                 const Factors& factors = {});

/// H_di (n x n - 1): all coordinates of one direction by the independent ones, with no translation,
/// A_rᵀ M e = 0, T (10). The independent ones are all but `eliminated`, in their order.
/// @throws Error (input) unless `eliminated` is the number of a position: gradients do not
/// translate, and most cannot be found from T (10) (r_y of a beam has S = 0).
MatrixXd sweeping_matrix(const ThermalMatrices& m, int eliminated);

/// e_Θ: what a free, uniform, isotropic growth by a = α ΔT adds to the unknowns, three ways. Only
/// T's check of each other: what runs is the closed form.
struct ThermalDisplacement {
  MatrixXd value;        ///< (n x dim)
  double condition = 0;  ///< of the matrix that was solved, unknowns scaled to lengths; worst
                         ///< direction
};

/// T (7)-(11): M_H e_i = Hᵀ M_1 e_o, M_H = Hᵀ M_rd H, which is positive definite.
/// @param eliminated  number of the eliminated vector unknown for each direction (dim): one
///                    translation per direction and body
/// @throws Error (input) for another number of them, or as sweeping_matrix(); (numerical) when M_H
/// is not positive definite.
ThermalDisplacement thermal_displacement_by_sweeping(const Element& element, double a,
                                                     std::span<const int> eliminated);

/// T (12)-(15): Hᵀ I_u H e_i = Hᵀ M⁻¹ ∫ ρb N a (X - X_o) dA, I_u = 1 - M⁻¹ S S(x_o), x_o the first
/// node of the body. (16), with x instead of X - X_o, holds for straight references only.
ThermalDisplacement thermal_displacement_by_mass(const Element& element, double a,
                                                 std::span<const int> eliminated);

/// a (e_o - A_r X_cm): positions grow from the centre of mass, gradients by the factor a.
MatrixXd thermal_displacement(const Element& element, double a);

}  // namespace flexmorph::fem
