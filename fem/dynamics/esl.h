#pragma once

#include "fem/dynamics/mesh_changes/moving_root.h"
#include "fem/esl_set.h"

namespace flexmorph::fem {

/// A point mass on a body; its d'Alembert force is one of the equivalent static loads.
struct AttachedMass {
  double mass = 0;      ///< Mass [kg].
  Vec2 material{0, 0};  ///< Material coordinates (m, n) of the point mass [m].
};

/// A force on a body other than its own weight and inertia: the force of a joint, or a load.
struct AttachedForce {
  /// Material point (m, n) where the force acts [m]; for an edge across the plate (X of the edge,
  /// 0).
  Vec2 material{0, 0};
  /// True if the force acts over the whole width at this X, as on an edge that stays straight.
  bool spread = false;
  /// Force vector in the axes of the world [N].
  Vec2 force{0, 0};
  /// Moment about the material point [N m]; used only if `spread` is true.
  double moment = 0;
  /// True for the force of a joint at an edge, which may prevent the thermal growth of the edge.
  bool held = false;
};

/// A joint that acts on a plate in addition to the joint that carries the plate.
struct AttachedJoint {
  /// Name of the joint in the model.
  std::string name;
  /// Material point (m, n) where the joint acts [m]; for an edge across the plate (X of the edge,
  /// 0).
  Vec2 material{0, 0};
  /// True if the joint acts over the whole width at this X.
  bool spread = false;
};

/// Returns the force and the moment that each joint exerts on a body at state x, from the
/// multipliers of x. The moment is about the material point of the joint.
/// @throws Error (input) if a joint name is unknown.
std::vector<AttachedForce> joint_forces(Workspace& model, const State& x, const Body& body,
                                        std::span<const AttachedJoint> joints);

/// Returns the equivalent static load of one plate at one time.
///
/// The hub is the rigid frame that carries the plate (origin o, rotation R); its motion is
/// prescribed or it is fixed to a rigid body. In the axes of the hub, the displacement and the
/// acceleration of a node X of the design mesh outside the hub are
///
///   u(X) = Rᵀ (r(X) - o) - (X - m₀),   a(X) = Rᵀ (r̈(X) - g),
///
/// where m₀ is the material coordinate of the root. The concentrated forces are -m a at the node of
/// each point mass, and the forces of joints and loads. A spread force is distributed linearly over
/// the nodes across the plate, with the given resultant and moment. Inside the hub u = 0, and a
/// follows from the rigid, extending body: it is the sum of the acceleration of o, of -g, and of
/// -ω² x + ω̇ × x + 2 ω × ẋ + ẍ with x = X - m₀(t).
///
/// A hot body (Body::heat) that is free to expand becomes larger by the factor s = 1 + a with
/// a = α ΔT, and has no strain. Its deformation is the displacement minus this growth about the
/// root point (m₀, 0),
///
///   w(X) = u(X) - e_Θ(X),   e_Θ = a (X - m₀, Y).
///
/// On the root line w = -g (0, Y). An edge that is welded to a cold hub keeps its width, so that
/// g = a. Other edges grow completely or in part; therefore the growth of the root line is measured
/// by least squares, and g is a minus this growth. The continuation into the hub grows like the
/// body along its axis, and like the root line across it. The growth that a joint prevents across
/// the far edge is measured by least squares, too, from the length of ∂r/∂Y because this edge may
/// be rotated; the deformation contains it already.
///
/// The root is moved to the nearest line of the grid. Therefore up to half a cell of plate inside
/// the hub is treated as outside, or up to half a cell outside as inside.
///
/// @param grid     Design mesh in material coordinates (root side at x0).
/// @param masses   Point masses; they must lie on nodes of the grid.
/// @param forces   Forces of joints and loads; they must act on nodes of the grid.
/// @param gravity  Acceleration of gravity in the axes of the world [m/s²], or empty.
/// @throws Error (input) if a mass or a force is not at a node, or a force along an edge not at a
///         column of nodes; Error (numerical) if the thermal
///         stretch s is not positive.
///
/// Source: P (31), (32); fem/README.md, Equivalent static loads.
EslSet equivalent_static_load(Workspace& model, const State& x, const MovingRoot& growth,
                              const Grid& grid, std::span<const AttachedMass> masses,
                              std::span<const AttachedForce> forces, const VectorXd& gravity);

/// Returns the equivalent static load of a body between two pins (a connecting rod), which no hub
/// carries. The frame of the load is the line through the pins, material points P1 and P2. Its
/// rotation R is that of the line between the pins relative to the undeformed body,
///
///   o = r(P1),   R: (P2 - P1) direction -> r(P2) - r(P1) direction
///   u(X) = Rᵀ (r(X) - o) - (X - P1),   a(X) = Rᵀ (r̈(X) - g).
///
/// Therefore u is zero at the first pin and parallel to the line at the second pin. The forces of
/// the joints at both pins must be among `forces`.
///
/// Source: fem/README.md, Equivalent static loads.
/// @throws Error (input) if a pin, a mass or a force is not at a node of the grid.
EslSet equivalent_static_load(Workspace& model, const State& x, const Body& body,
                              const std::array<Vec2, 2>& pins, const Grid& grid,
                              std::span<const AttachedMass> masses,
                              std::span<const AttachedForce> forces, const VectorXd& gravity);

/// Returns the node of the grid at a point. @throws Error (input) if there is no node.
int node_at(const Grid& grid, const Vec2& point);

}  // namespace flexmorph::fem
