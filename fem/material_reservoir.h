#pragma once

#include <functional>

#include "fem/force_element.h"
#include "fem/load_law.h"
#include "fem/rigid.h"

namespace flexmorph::fem {

/// Material reservoir of a plate: the material that has not yet left the planar rigid body from
/// which the plate is fed, so that the mass of that body varies in time (fem/README.md, Stored
/// material). The material has the width w of the plate and lies across the axis of the outlet, as
/// it does in the plate.
struct MaterialReservoir {
  /// Form of the reservoir.
  enum class Kind {
    coil,  ///< A coil at one point of the body, with which the material moves until it leaves.
    rod    ///< A straight rod that ends at its location and slides along the axis of the outlet.
  } kind = Kind::coil;
  Vec2 outlet{0, 0};  ///< Middle of the root of the plate in the axes of the body [m].
  double angle = 0;   ///< Angle of the axis of the outlet in the axes of the body [rad].

  /// Location of the coil, or of the end of the rod where material leaves, in the axes of the body
  /// [m].
  Vec2 at{0, 0};
  double width = 0;         ///< Width w of the plate [m].
  double area_density = 0;  ///< Mass per area of the plate, ρc [kg/m²].

  /// Stored length ℓ(t) with its rates [m]; ℓ' = -s with the feed speed s.
  std::function<Motion(double)> length;
};

/// Creates the inertia of the material in the reservoir, at fixed material points as in a plate,
/// for a RigidBody that `moves`:
///
///   f = ∫ ρc Nᵀ r̈ dA = M(t) q̈ + 2 s B q̇ + s' B q,     r = N(X) q,  ∂r/∂t = s D q (rod; coil: 0)
///
/// M is the mass matrix of a rigid body with the current mass, centre and inertia of the material
/// in the reservoir, and B = ∫ρc Nᵀ D dA. The flow power of the term contains the energy that
/// leaves.
/// @throws Error (input) for numbers that are not finite, a width or a density that is not positive
std::unique_ptr<Term> make_reservoir_inertia(const MaterialReservoir& reservoirs);
/// Creates the weight of the material in the reservoir under gravity (2) [m/s²].
/// @throws Error (input) as make_reservoir_inertia(), and for gravity with another number of
/// components
std::unique_ptr<Term> make_reservoir_weight(const MaterialReservoir& reservoirs,
                                            const LoadLaw& gravity);

/// Creates the force element of the outlet. It accelerates material from the velocity that the
/// material has in the reservoir to the velocity that it has at the root of the plate. The force on
/// the unknowns q of the body is
///
///   f = ρc s ∫ (N_oᵀ (N_o q̇ + s r_m) - N_sᵀ (N_s q̇ + s D q)) dy
///
/// where N_o belongs to the outlet, N_s to the location of the reservoir, and r_m is the position
/// gradient of the plate at its root. There is no force on the plate. With this force the body, the
/// material in the reservoir and the material in the plate together conserve their linear and
/// angular momentum. The power of the force element is -f · q̇.
/// @param body   name of the rigid body
/// @param plate  name of the plate; the material leaves through its first m-line
/// @throws Error (input) as make_reservoir_inertia(); at bind() for bodies of another kind.
std::unique_ptr<ForceElement> make_outlet(std::string name, std::string body, std::string plate,
                                          const MaterialReservoir& reservoirs);

/// Mass properties of the material in the reservoir at one time.
struct ReservoirState {
  /// Mass [kg], and moment of inertia about the centre of mass [kg m²].
  double mass = 0, inertia = 0;
  Vec2 center{0, 0};  ///< Centre of mass in the axes of the body [m].
};
/// Returns the mass properties of the material in the reservoir at time t [s].
ReservoirState reservoir_at(const MaterialReservoir& reservoirs, double t);

}  // namespace flexmorph::fem
