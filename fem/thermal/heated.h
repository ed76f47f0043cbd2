#pragma once

#include <memory>

#include "fem/heat.h"
#include "fem/model/model.h"

namespace flexmorph::fem {

/// Returns the elastic term of a heated body, made from the term of the cold body.
///
/// Multiplicative split F = F_e F_Θ of the deformation gradient with F_Θ = s 1, s = 1 + α ΔT(t):
/// the elastic strains are those of F/s, T (27), (28). r = Qᵀ N is linear in the unknowns.
/// Therefore F/s is the gradient of the same element at q/s, and
///
///   U(q, t) = sᵖ U_c(q/s),   F = sᵖ⁻¹ F_c(q/s),   K = sᵖ⁻² K_c(q/s),
///   ∂U/∂t at fixed q = (p U - F · q) ṡ/s
///
/// U_c, F_c and K_c are energy, force and tangent of the cold term [J], [N], [N/m], and p is the
/// exponent of the volume, Heat::volume_exponent().
///
/// This holds for every U_c, so that one decorator serves every elastic term. A dissipative term
/// uses the rate of the elastic strains at q/s, because free thermal expansion does no work. With σ
/// = ṡ/s
///
///   F = sᵖ⁻¹ F_c(x, y),   x = q/s,  y = ẋ = (q̇ - σ q)/s,   P = sᵖ P_c(x, y)
///   F · q̇ = P + σ F · q
///
/// so that σ (p U - F · q) is the power of its temperature, too. Forces on free material lines are
/// ∂U/∂p_l = sᵖ ∂U_c/∂p_l, because material coordinates do not expand. If the mean force of the
/// cold term is an exact discrete gradient, so is that of the heated term, with s at the mean time;
/// at constant temperature the energy is conserved.
///
/// T (26), the elastic strain of the displacements without their thermal part, is not objective and
/// is not used; fem/README.md, Heat.
///
/// scale_load() multiplies the temperature, ΔT → μ ΔT, so that paths of equilibria may follow it.
///
/// @throws Error (input) unless the term is a StrainTerm and the heat is complete; at heat_to() and
///     scale_load() (numerical) where s is not a positive number.
std::unique_ptr<Term> make_heated(BodyTerm cold, const Heat& heat);

/// Makes a body a heated one: wraps its elastic terms and sets Body::heat. Call it before the first
/// Model::prepare(), which sets the temperature of the terms.
/// @throws Error (input) for a rigid body, one that is heated already, or one without elastic
///     terms.
void heat(Body& body, const Heat& heat);

}  // namespace flexmorph::fem
