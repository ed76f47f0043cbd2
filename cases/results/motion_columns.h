#pragma once

#include "cases/results/body_measures.h"
#include "cases/results/mechanism_columns.h"
#include "cases/results/motion_record.h"

/// The columns of motion.csv and path.csv.
namespace flexmorph::cases {

/// An observed point of a designed body, and the frame in which its deflection is measured. The
/// frame is that of the hub (the rigid frame with prescribed motion that carries a body) or sleeve;
/// for a body between two pins it is the line through the pins, otherwise the root edge.
struct DeflectingPoint {
  const Observe* point = nullptr;  ///< The observed point.
  const fem::MovingRoot* growth =
      nullptr;                 ///< Moving root in the hub or sleeve; null: `line` is used.
  std::array<Vec2, 2> line{};  ///< Two material points that define the frame [m].
};
/// Returns the displacement of the point across the undeformed body, in the frame of the point [m].
double deflection_across(const fem::Model& model, const DeflectingPoint& at, const fem::State& x);

/// The columns of motion.csv and the computation of its rows.
class MotionColumns {
 public:
  /// Creates the columns of a scene; the scene and the moving roots have to outlive them.
  /// @param moving_roots  moving roots of the model
  /// @param balance  true if the motion computes its energy balance, which adds columns
  MotionColumns(const Scene& scene, std::span<const fem::MovingRoot> moving_roots, bool balance);

  /// Describes the values of a row, in their order.
  const std::vector<ColumnInfo>& columns() const { return columns_; }
  /// Sets the undeformed state from which measured displacements are counted. Only scenes with
  /// [[measure]] need it.
  void set_undeformed(fem::State x) { undeformed_ = std::move(x); }
  /// Computes the row of a step (n_columns). The span is valid until the next call.
  std::span<const double> row(const fem::MotionStep& step);
  /// Saves or restores the data on which rows depend besides their step.
  /// @param model  model of the motion; restoring prepares it for the first step
  void archive(Archive& memory, fem::Workspace& model);

 private:
  void describe(const std::string& name, const char* unit, std::string meaning, ColumnGroup group);
  void describe_bodies(std::span<const fem::MovingRoot> moving_roots);
  void describe_deflecting_points(std::span<const fem::MovingRoot> moving_roots);
  void describe_energies();
  void append_bodies(const fem::MotionStep& step);
  void append_energies(const fem::MotionStep& step);

  const Scene& scene_;
  bool balance_;
  std::vector<const fem::MovingRoot*> deflecting_;  // bodies with a tip deflection
  std::vector<DeflectingPoint> points_;             // observed points of designed bodies
  std::vector<const Body*> flowing_;                // bodies with a column for their length
  std::vector<double fem::MotionStep::*> terms_;    // energies in the columns of terms
  std::vector<std::string> designed_;               // bodies of the column of designed bodies
  MechanismColumns mechanism_;
  std::vector<ColumnInfo> columns_;
  std::vector<double> row_;
  fem::State undeformed_, first_;
  std::optional<BodyMeasures> measures_;
};

/// Returns the names of the energy columns of the terms of all bodies, each name once.
std::vector<std::string> columns_of_terms(const Scene& scene);

/// Describes the columns of path.csv: number and load factor of the equilibrium, displacements of
/// observed points, measured quantities, rigid bodies, joints and springs, strain energy, and
/// iterations of Newton's method.
std::vector<ColumnInfo> path_columns(const Scene& scene);

/// Returns the tip deflection of a body with a moving root: the coordinate of the middle of its
/// free end across the axis of the hub [m].
double tip_deflection(const fem::Model& model, const fem::MovingRoot& growth, const fem::State& x);

}  // namespace flexmorph::cases
