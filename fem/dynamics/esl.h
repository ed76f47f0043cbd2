#pragma once

#include "fem/dynamics/growth.h"
#include "fem/esl_set.h"

namespace flexmorph::fem {

/// Point mass on a body, for its d'Alembert force in the loads.
struct AttachedMass {
  double mass = 0;      ///< [kg]
  Vec2 material{0, 0};  ///< material coordinates (m, n) [m]
};

/// Equivalent static load of one body at one time.
///
/// In the frame of the hub (origin o, rotation R), for nodes X of the design mesh outside of it:
///
///   u(X) = Rᵀ (r(X) - o) - (X - m₀),   a(X) = Rᵀ (r̈(X) - g)
///
/// and the concentrated force -m a at the node of every point mass. Inside the hub u = 0, and a is
/// continued by the rigid, extending body: -ω² x + ω̇ × x + 2 ω × ẋ + ẍ with x = X - m₀(t).
///
/// @param grid    design mesh in material coordinates (root side at x0)
/// @param masses  must sit on nodes of the grid
/// @throws Error (input) when the root line is not on a line of the grid (to 1e-6 of a cell).
///
/// Source: P (31), (32); design.md section 8.
EslSet equivalent_static_load(const Model& model, const State& x, const Growth& growth,
                              const Grid& grid, std::span<const AttachedMass> masses,
                              const VectorXd& gravity);

}  // namespace flexmorph::fem
