#pragma once

#include <memory>

#include "fem/heat.h"
#include "fem/model/model.h"

namespace flexmorph::fem {

/// A term of a hot body that is made of strains.
///
/// Multiplicative split F = F_e F_Θ of the deformation gradient with F_Θ = s 1, s = 1 + α ΔT(t):
/// the elastic strains are those of F/s, T (27), (28). r = Qᵀ N is linear in the unknowns, so that
/// F/s is the gradient of the same element at q/s, and
///
///   U(q, t) = sᵖ U_c(q/s),   F = sᵖ⁻¹ F_c(q/s),   K = sᵖ⁻² K_c(q/s),
///   ∂U/∂t at fixed q = (p U - F · q) ṡ/s
///
/// U_c, F_c, K_c  energy, force and tangent of the cold term [J], [N], [N/m]
/// p              exponent of the volume, Heat::volume_exponent()
///
/// whatever U_c is, so that one decorator serves every elastic term. A term that dissipates sees
/// the rate of the elastic strains, that of q/s: growing freely takes no work. With σ = ṡ/s
///
///   F = sᵖ⁻¹ F_c(x, y),   x = q/s,  y = ẋ = (q̇ - σ q)/s,   P = sᵖ P_c(x, y)
///   F · q̇ = P + σ F · q
///
/// so that the same formula, p U - F · q by σ, is the power of its temperature. Forces on free
/// material lines are ∂U/∂p_l = sᵖ ∂U_c/∂p_l: material coordinates do not grow. A mean force of the
/// cold term that is an exact discrete gradient gives one of the hot term, s that of the mean time:
/// at constant temperature the energy is kept.
///
/// T (26), the elastic strain of the displacements without their thermal part, is not objective and
/// is not used; fem/README.md, Heat.
///
/// scale_load() multiplies the temperature, ΔT → μ ΔT: paths of equilibria may follow it.
///
/// @throws Error (input) unless the term is a StrainTerm and the heat is complete; at heat_to() and
/// scale_load() (numerical) where s is not a positive number.
std::unique_ptr<Term> make_heated(BodyTerm cold, const Heat& heat);

/// Makes a body hot: wraps its terms of strains and sets Body::heat. Before the first
/// Model::prepare(), which puts the terms to their temperature.
/// @throws Error (input) for a rigid body, one that is hot already, or one without such terms.
void heat(Body& body, const Heat& heat);

}  // namespace flexmorph::fem
