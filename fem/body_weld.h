#pragma once

#include <memory>
#include <string>

#include "fem/joint.h"

namespace flexmorph::fem {

/// An edge across a plate, or an end of a beam, named by its body.
struct EdgeLocation {
  /// Name of the body, and name of the edge: "root" or "free_end".
  std::string body, edge;
};

/// Creates a joint that welds two bodies in the plane, plates or beams, at their edges. In the
/// undeformed bodies the m axis of b has the angle θ = `angle` [rad] to the m axis of a at the
/// weld, counter-clockwise. Therefore a vector x of b is the corresponding vector of a, turned and
/// scaled: x_b = c ⊗ x_a, where ⊗ is the product of complex numbers and the constant c = e^{iθ}
/// x_b⁰ / x_a⁰ follows from the reference vectors, each in the axes of its own body.
///
///   two beams         r_b = r_a,   (c ⊗ r_n,a) × r_n,b = 0                    (partial)
///                     or r_n,b = c ⊗ r_n,a                                    (edge)
///                     and r_m,b = c' ⊗ r_m,a                                  (full)
///   two plates        r_b = r_a, r_n,b = c r_n,a at every pair of nodes       (edge)
///                     and r_m,b = c r_m,a, r_mn,b = r_mn,a                    (full)
///   a plate b on a    r_b = r_a + y c ⊗ r_n,a, r_n,b = c ⊗ r_n,a, y the       (edge)
///   beam a            coordinate of b across the plate; or with a and b exchanged
///
/// The sections of both bodies turn together in every mode. With `partial` the height of each
/// section may change independently, with `edge` both heights change together. `full` makes the
/// whole position gradient continuous, so that two plates or beams in a straight line behave like
/// one body with the combined mesh. Where a plate is welded to a beam the edge of the plate stays
/// straight. Plates are joined edge to edge: c = cos θ is 1, or -1 where two roots or two free ends
/// meet. All rows except those of `partial` are linear.
///
/// @throws Error (input) at once for an angle that is not finite and for the same body given as a
/// and b; at bind() for a body or an edge that does not exist, for an edge that runs along the
/// plate or moves through the material, for bodies in space, for other modes than those listed, and
/// for plates whose nodes do not coincide or have different kinds of unknowns.
std::unique_ptr<Joint> make_body_weld(std::string name, EdgeLocation a, EdgeLocation b,
                                      double angle, WeldMode mode);

}  // namespace flexmorph::fem
