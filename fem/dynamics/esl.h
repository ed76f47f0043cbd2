#pragma once

#include "fem/dynamics/mesh_changes/growth.h"
#include "fem/esl_set.h"

namespace flexmorph::fem {

/// Point mass on a body, for its d'Alembert force in the loads.
struct AttachedMass {
  double mass = 0;      ///< [kg]
  Vec2 material{0, 0};  ///< material coordinates (m, n) [m]
};

/// A force on a body that is not its own weight or inertia: of a joint, or applied.
struct AttachedForce {
  Vec2 material{0, 0};  ///< where it acts; at an edge across: (X of the edge, 0) [m]
  bool spread = false;  ///< over the whole width at that X, as on an edge that stays straight
  Vec2 force{0, 0};     ///< in the world [N]
  double moment = 0;    ///< about the point, where spread [N m]
  bool held = false;    ///< of a joint at an edge: it may hold back the edge's thermal growth
};

/// A joint that acts on a plate besides the one that carries it, by its name in the model.
struct AttachedJoint {
  std::string name;
  Vec2 material{0, 0};  ///< as above [m]
  bool spread = false;
};

/// What the joints do to a body at x (multipliers of x). @throws Error (input) for unknown names.
std::vector<AttachedForce> joint_forces(Workspace& model, const State& x, const Body& body,
                                        std::span<const AttachedJoint> joints);

/// Equivalent static load of one body at one time.
///
/// In the frame of the hub (origin o, rotation R), for nodes X of the design mesh outside of it:
///
///   u(X) = Rᵀ (r(X) - o) - (X - m₀),   a(X) = Rᵀ (r̈(X) - g)
///
/// and the concentrated forces: -m a at the node of every point mass, forces of joints and loads
/// (spread ones: linearly across, with their resultant and moment). Inside the hub u = 0, and a is
/// continued by the rigid, extending body: -ω² x + ω̇ × x + 2 ω × ẋ + ẍ with x = X - m₀(t).
///
/// A hot body (Body::heat) that is free is s = 1 + a times as large, a = α ΔT, and nothing strains
/// it; its deformation is what is left when that growth about the root point (m₀, 0) is taken off,
///
///   w(X) = u(X) - e_Θ(X),   e_Θ = a (X - m₀, Y)
///
/// An edge that is welded to a cold hub stays as wide as it was, w = -g (0, Y) with g = a there;
/// g is measured on the root line (least squares), because other edges grow, wholly or in part. The
/// continuation into the hub grows like the body, across it as its edge does. What a joint holds
/// back across the far edge, whichever way that is turned, is measured in the same way (with the
/// length of ∂r/∂Y); the deformation has it already.
///
/// The root is taken to be on the nearest line of the grid: up to half a cell of plate that is in
/// the hub counts as outside of it, or the other way round.
///
/// @param grid    design mesh in material coordinates (root side at x0)
/// @param masses, forces  must sit on nodes of the grid
///
/// Source: P (31), (32); fem/README.md, Equivalent static loads.
EslSet equivalent_static_load(Workspace& model, const State& x, const Growth& growth,
                              const Grid& grid, std::span<const AttachedMass> masses,
                              std::span<const AttachedForce> forces, const VectorXd& gravity);

/// The same of a link between two pins, which nothing clamps: the frame is the line through the
/// pins, material points P1 and P2, as it is turned against that of the undeformed link,
///
///   o = r(P1),   R: (P2 - P1) direction -> r(P2) - r(P1) direction
///   u(X) = Rᵀ (r(X) - o) - (X - P1),   a(X) = Rᵀ (r̈(X) - g)
///
/// so that u is zero at the first pin and lies along the line at the second one. Forces of the
/// joints at both pins belong to `forces`.
///
/// Source: fem/README.md, Equivalent static loads.
/// @throws Error (input) for pins, masses or forces that are not at nodes of the grid.
EslSet equivalent_static_load(Workspace& model, const State& x, const Body& body,
                              const std::array<Vec2, 2>& pins, const Grid& grid,
                              std::span<const AttachedMass> masses,
                              std::span<const AttachedForce> forces, const VectorXd& gravity);

/// The node of the grid at a point. @throws Error (input) where there is none.
int node_at(const Grid& grid, const Vec2& point);

}  // namespace flexmorph::fem
