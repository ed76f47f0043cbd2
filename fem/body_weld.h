#pragma once

#include <memory>
#include <string>

#include "fem/joint.h"

namespace flexmorph::fem {

/// An edge of a plate across it, or the end of a beam: "root" or "free_end".
struct EdgePlace {
  std::string body, edge;
};

/// Two bodies in the plane, plates or beams, welded at their edges. In the undeformed bodies the
/// axis m of b stands at the angle θ [rad] to that of a, at the weld and counter-clockwise, so that
/// a vector x of b is one of a turned and scaled: x_b = c ⊗ x_a, with the product of complex
/// numbers and a constant c = e^{iθ} x_b⁰ / x_a⁰ of the references, each in its own axes.
///
///   two beams         r_b = r_a,   (c ⊗ r_n,a) × r_n,b = 0                    (partial)
///                     or r_n,b = c ⊗ r_n,a                                    (edge)
///                     and r_m,b = c' ⊗ r_m,a                                  (full)
///   two plates        r_b = r_a, r_n,b = c r_n,a at every pair of nodes       (edge)
///                     and r_m,b = c r_m,a, r_mn,b = r_mn,a                    (full)
///   a plate b on a    r_b = r_a + y c ⊗ r_n,a, r_n,b = c ⊗ r_n,a, y the       (edge)
///   beam a            coordinate of b across; or the other way round
///
/// Sections turn together. `partial` lets both grow on their own, `edge` together; `full` makes the
/// whole gradient continuous: two plates or beams that go on straight are then one of that mesh.
/// Where a plate is welded to a beam its edge is straight. Plates meet edge on edge: c = cos θ is
/// 1, or -1 where two roots or two free ends meet. All rows but those of `partial` are linear.
///
/// @throws Error (input) at bind() for a body or an edge that does not exist, runs along the plate
///         or moves through the material, for bodies in space, the same body twice, modes other
///         than these, and plates whose nodes do not meet or do not have the same unknowns.
std::unique_ptr<Joint> make_body_weld(std::string name, EdgePlace a, EdgePlace b, double angle,
                                      WeldMode mode);

}  // namespace flexmorph::fem
