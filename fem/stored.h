#pragma once

#include <functional>

#include "fem/link.h"
#include "fem/load_law.h"
#include "fem/rigid.h"

namespace flexmorph::fem {

/// Material of a plate that has not left its planar rigid body yet, of which it takes along more or
/// less (fem/README.md, Stored material). It lies across the axis of the outlet as it does in the
/// plate, over the width w.
struct StoredMaterial {
  enum class Kind {
    coil,  ///< at one place of the body, with which it moves until it leaves
    rod    ///< a straight rod behind its place, which slides along the outlet's axis
  } kind = Kind::coil;
  Vec2 outlet{0, 0};        ///< middle of the plate's root, in the body's axes [m]
  double angle = 0;         ///< of the outlet's axis there [rad]
  Vec2 at{0, 0};            ///< of the coil, or of the rod's end that leaves, in the same axes [m]
  double width = 0;         ///< w [m]
  double area_density = 0;  ///< of the plate, ρc [kg/m²]
  std::function<Motion(double)> length;  ///< what is stored, ℓ(t) [m]; ℓ' = -s, s the feed speed
};

/// Inertia of what is stored, at fixed material points as in a plate, for a RigidBody that `moves`:
///
///   f = ∫ ρc Nᵀ r̈ dA = M(t) q̈ + 2 s B q̇ + s' B q,     r = N(X) q,  ∂r/∂t = s D q (rod; coil: 0)
///
/// M is that of a rigid body of the mass, centre and inertia of what is stored now, B = ∫ρc Nᵀ D
/// dA. Its flow power contains the energy that leaves.
/// @throws Error (input) for numbers that are not finite, a width or a density that is not positive
std::unique_ptr<Term> make_stored_inertia(const StoredMaterial& stored);
/// Its weight; gravity (2) [m/s²].
/// @throws Error (input) as above, and for gravity of another size
std::unique_ptr<Term> make_stored_weight(const StoredMaterial& stored, const LoadLaw& gravity);

/// What it takes to bring material from where it is stored, with the velocity it has there, into
/// the root of the plate, with the velocity that it has there: per width the momentum
///
///   f = ρc s ∫ (N_oᵀ (N_o q̇ + s r_m) - N_sᵀ (N_s q̇ + s D q)) dy                 on the body's q
///
/// N_o, N_s of the outlet and of the place of the store; r_m the slope of the plate at its root.
/// The plate feels nothing of it. With it, body, stored and flown-out material keep their linear
/// and angular momentum. Its power is -f · q̇.
/// @param body, plate  their names; the material leaves through the plate's first m-line
/// @throws Error (input) as above; at bind() for bodies of another kind.
std::unique_ptr<Link> make_outlet(std::string name, std::string body, std::string plate,
                                  const StoredMaterial& stored);

/// Mass, centre and inertia about the centre of what is stored at a time.
struct StoredNow {
  double mass = 0, inertia = 0;
  Vec2 center{0, 0};
};
StoredNow stored_at(const StoredMaterial& stored, double t);

}  // namespace flexmorph::fem
