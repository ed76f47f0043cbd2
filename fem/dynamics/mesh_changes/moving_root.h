#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "fem/dynamics/mesh_changes/mesh_map.h"
#include "fem/dynamics/starts/driven_frame.h"
#include "fem/line_grid.h"

namespace flexmorph::fem {

/// Moving-root mesh control of a plate: the hub or sleeve to which its root (or another m-line) is
/// welded, and the limits at which elements at the moving root are split or merged. A hub is the
/// rigid frame that carries the plate; its motion is prescribed, or it is fixed to a rigid body.
/// The hub of a plate in space rotates about z.
struct MovingRoot {
  /// Name of the plate.
  std::string body;
  /// Hub or sleeve of the plate.
  DrivenFrame hub;
  /// Length of the longest boundary element [m]; a longer one is split in the middle; ∞: never.
  double max_length = 0.1;
  /// Length of the shortest boundary element [m]; a shorter one is merged with its neighbour.
  double min_length = 0.03;
  /// Index of the m-line that is welded; 0 is the root.
  int line = 0;
  /// Rate of the welded line at the start if it is a free line [m/s] (a mesh line whose material
  /// coordinate is an unknown).
  double slide = 0;
  /// Distance between an inserted line and the first line behind the root [m]; 0: a line is
  /// inserted in the middle of the boundary element.
  double cell = 0;

  /// Returns the length that a merged element must not reach, so that no insertion follows a
  /// removal at once [m].
  double merged_below() const { return cell > 0 ? max_length : 0.9 * max_length; }
};

/// Returns the elements of a body as a grid of material lines (mesh lines of constant material
/// coordinate). @throws Error (input) if the body has other elements.
const LineGrid& grid_of(const Body& body);

/// Values of the vector unknowns of a body as a matrix (n_vectors x dim).
using VectorRows = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
/// Returns the entries of a vector of the model (n_dofs) that belong to the vector unknowns of a
/// body (n_vectors x dim).
VectorRows rows_of(const Body& body, const VectorXd& all);

/// Motion of one material point in the plane; for a body in space its x and y components.
struct PointMotion {
  /// Position [m], material velocity [m/s] and material acceleration [m/s²].
  Vec2 position, velocity, acceleration;
};
/// Returns the motion of the material point (m, n) [m] of a body.
PointMotion point_motion(const Body& body, const State& x, const Vec2& material);

/// Returns the position of the material point (m, n) [m] of a body [m]; z = 0 for a body in the
/// plane.
/// @throws Error (input) if the point is outside the body.
Vec3 point_position(const Body& body, const State& x, const Vec2& material);

/// The next change of the mesh of a body.
struct NextChange {
  double t;           ///< Time of the change [s]; infinity if there is none.
  MeshChange change;  ///< Kind of the change.
};
/// Returns the next change of the mesh of a body with a driven root line: the first time in (t,
/// end] at which the boundary element leaves [min_length, max_length], and the kind of the change.
/// A removal requires that the merged element is shorter than MovingRoot::merged_below(); otherwise
/// insertion and removal would alternate (fem/README.md, Insertion and removal).
/// @param step  Spacing of the times at which the length is evaluated [s].
NextChange next_change(const Body& body, const MovingRoot& growth, double t, double end,
                       double step);

/// Returns the change that the boundary element at a *free* root line requires at the present
/// position of the line: a split if it is longer than max_length; a merge if it is shorter than
/// min_length and the merged element is shorter than MovingRoot::merged_below(). The future
/// positions of a free line are unknown, so that no step can end exactly when a limit is reached.
/// Therefore the change is executed at the end of the step in which the limit was passed. A split
/// does not alter the field (h16), whenever it is executed.
///
/// Returns nothing if no change is required, if the welded line is not the root, or if it is not
/// free. Joints of the body at "line 3" or other lines by number do not follow a change; models
/// with such joints have no limits.
std::optional<MeshChange> change_due(const Body& body, const MovingRoot& growth);

/// Changes the mesh of a body at time x.t and transfers the state to the new mesh (MeshMap). The
/// line next to the root is inserted or removed. A free root line remains a scalar unknown.
///
/// Insertion: the new nodes take position, slopes, and the material velocity with its derivatives
/// from the field at a fixed material point, and also the accelerations (N q̈ + 2 Ṅ q̇ + N̈ q). With
/// h16 the fields of position and velocity do not change at all. Removal: the remaining nodes keep
/// their values, so that the field changes by the interpolation error. Multipliers keep their
/// values. Afterwards the forces are not in balance; see balance_forces().
///
/// @param cell  See MovingRoot::cell.
/// @returns the map that was applied to the vectors of the state.
///
/// Source: P Fig. 3, 4; fem/README.md, Insertion and removal.
MeshMap change_mesh(Workspace& model, Body& body, MeshChange change, State& x, double cell = 0);

}  // namespace flexmorph::fem
