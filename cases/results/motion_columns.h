#pragma once

#include "cases/results/body_measures.h"
#include "cases/results/mechanism_columns.h"
#include "cases/results/motion_record.h"

/// The columns of motion.csv and path.csv.
namespace flexmorph::cases {

/// An observed point of a designed body, and the frame that its deflection is counted in: that of
/// the hub or sleeve that carries the body; of a link the line through its pins; otherwise the
/// root edge of the body.
struct DeflectingPoint {
  const Observe* point = nullptr;
  const fem::Growth* growth = nullptr;  ///< of the hub or sleeve; null: `line` makes the frame
  std::array<Vec2, 2> line{};           ///< two material points of the body [m]
};
/// Returns the displacement of the point across the undeformed body, in that frame [m].
double deflection_across(const fem::Model& model, const DeflectingPoint& at, const fem::State& x);

/// Computes the rows of motion.csv.
class MotionColumns {
 public:
  /// @param growths  moving roots of the model
  /// @param balance  whether the motion keeps its energy balance, which has columns of its own
  MotionColumns(const Scene& scene, std::span<const fem::Growth> growths, bool balance);

  /// Describes the values of a row, in their order.
  const std::vector<ColumnInfo>& columns() const { return columns_; }
  /// Sets the undeformed state that measured displacements are counted from. Only scenes with
  /// [[measure]] need it.
  void set_undeformed(fem::State x) { undeformed_ = std::move(x); }
  /// Computes the row of a step (n_columns). The span is valid until the next call.
  std::span<const double> row(const fem::MotionStep& step);
  /// Saves and restores what rows depend on besides their step.
  /// @param model  of the motion; restoring prepares it for the first step
  void remember(Memory& memory, fem::Workspace& model);

 private:
  void describe(const std::string& name, const char* unit, std::string meaning, ColumnGroup group);
  void describe_bodies(std::span<const fem::Growth> growths);
  void describe_deflecting_points(std::span<const fem::Growth> growths);
  void describe_energies();
  void append_bodies(const fem::MotionStep& step);
  void append_energies(const fem::MotionStep& step);

  const Scene& scene_;
  bool balance_;
  std::vector<const fem::Growth*> deflecting_;    // bodies with a tip deflection
  std::vector<DeflectingPoint> points_;           // of designed bodies
  std::vector<const Body*> flowing_;              // bodies with a column for their length
  std::vector<double fem::MotionStep::*> terms_;  // energies that the columns of terms hold
  MechanismColumns mechanism_;
  std::vector<ColumnInfo> columns_;
  std::vector<double> row_;
  fem::State undeformed_, first_;
  std::optional<BodyMeasures> measures_;
};

/// Names of the columns that the terms of the bodies account for, each once.
std::vector<std::string> columns_of_terms(const Scene& scene);

/// Describes the columns of path.csv: number and load factor of an equilibrium, displacements of
/// observed points, measured quantities, rigid bodies, joints and springs, strain energy, and
/// iterations of Newton's method.
std::vector<ColumnInfo> path_columns(const Scene& scene);

/// Tip deflection of a body with a moving root: coordinate of the middle of its free end across the
/// axis of the hub [m].
double tip_deflection(const fem::Model& model, const fem::Growth& growth, const fem::State& x);

}  // namespace flexmorph::cases
