#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "fem/dynamics/mesh_changes/mesh_map.h"
#include "fem/dynamics/starts/carrier.h"
#include "fem/line_grid.h"

namespace flexmorph::fem {

/// A plate that sits in a hub or a sleeve, in space in one that turns about z: the frame that its
/// root (or another m-line) is welded to, and when its mesh changes.
struct Growth {
  std::string body;
  Carrier hub;
  double max_length = 0.1;   ///< a longer boundary element is split in its middle; ∞: never [m]
  double min_length = 0.03;  ///< a shorter one is merged with its neighbour [m]
  int line = 0;              ///< the m-line that is welded: 0 is the root
  double slide = 0;          ///< rate at the start of that line, where it is free [m/s]
  double cell =
      0;  ///< lines come so far behind the first one, and not in the middle; 0: they do [m]

  /// The longest element that a removal may leave, so that no insertion follows it at once [m].
  double merged_below() const { return cell > 0 ? max_length : 0.9 * max_length; }
};

/// The material lines of a body. @throws Error (input) when the body has other elements.
const LineGrid& grid_of(const Body& body);

/// Values of the body's unknowns as a matrix (n_vectors x dim).
using VectorRows = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
VectorRows rows_of(const Body& body, const VectorXd& all);

/// Position, material velocity and material acceleration of one material point, in the plane: of a
/// body in space the first two entries.
struct PointMotion {
  Vec2 position, velocity, acceleration;
};
PointMotion point_motion(const Body& body, const State& x, const Vec2& material);

/// Position of one material point; z = 0 for a body in the plane.
/// @throws Error (input) when the point is outside the body.
Vec3 point_position(const Body& body, const State& x, const Vec2& material);

/// When the boundary element next leaves [min_length, max_length] in (t, end], and how; t =
/// infinity when it does not. A removal needs a merged element below Growth::merged_below() (else
/// the pair would chatter: fem/README.md, Insertion and removal).
struct NextChange {
  double t;
  MeshChange change;
};
NextChange next_change(const Body& body, const Growth& growth, double t, double end, double step);

/// The change that the boundary element of a *free* root line asks for where the line is now: split
/// when longer than max_length, merged when shorter than min_length and the merged element stays
/// below Growth::merged_below(). Where the line will be is not known beforehand, so that there is
/// no time to land on: the change is executed at the end of the step in which the limit was passed.
/// A split does not alter the field (h16), whenever it comes.
///
/// Nothing where the welded line is not the root, or is not free. Joints of the body at "line 3"
/// and the like do not follow the change: such models have no limits.
std::optional<MeshChange> change_due(const Body& body, const Growth& growth);

/// Changes the mesh at x.t and carries the state over (MeshMap); the line inserted or removed is
/// the one next to the root. A free root line stays the scalar unknown it is.
///
/// Insertion: new nodes take position, slopes, and material velocity with its derivatives from the
/// field at the fixed material point; accelerations likewise (N q̈ + 2 Ṅ q̇ + N̈ q). With h16 the
/// field of position and velocity does not change at all. Removal keeps the values of the
/// remaining nodes (it misses by the interpolation error). Multipliers keep their values. Forces
/// are not in balance then: balance_forces().
///
/// @returns what was done to the vectors of the state.
///
/// Source: P Fig. 3, 4; fem/README.md, Insertion and removal.
/// @param cell  Growth::cell
MeshMap change_mesh(Workspace& model, Body& body, MeshChange change, State& x, double cell = 0);

}  // namespace flexmorph::fem
