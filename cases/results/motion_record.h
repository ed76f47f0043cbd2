#pragma once

#include "cases/results/animation.h"
#include "cases/results/series.h"
#include "fem/dynamics/motion.h"
#include "fem/solve/statics.h"
#include "geometry/archive.h"
#include "io/plane_frames.h"

/// Results of a motion or of a path of equilibria.
namespace flexmorph {

namespace io {
/// Saves or restores a picture of a mechanism.
void archive(Archive& memory, PlaneFrame& frame);
}  // namespace io

namespace cases {

/// Names of the columns that the program reads from tables.
inline constexpr const char *kTimeColumn = "time", *kKineticColumn = "energy.kinetic",
                            *kStrainColumn = "energy.strain", *kDesignedColumn = "energy.designed",
                            *kPotentialColumn = "energy.potential",
                            *kEnergyErrorColumn = "energy.error", *kFactorColumn = "load_factor";
/// Ending of the names of columns with tip deflections.
inline const std::string kDeflectionEnding = ".tip_deflection";
/// Ending of the names of columns with deflections of observed points.
inline const std::string kAcrossEnding = "_across";

/// The result of a motion: a row per step, pictures, remarks on its start, and the counts of the
/// time integration.
struct MotionRecord {
  Series table;                           ///< Table with the columns of MotionColumns.
  std::vector<io::PlaneFrame> snapshots;  ///< Pictures of the mechanism.
  Animation animation;                    ///< Frames for the animation of the report.
  std::vector<std::string> remarks;       ///< Remarks on a start that differs from the case.
  fem::MotionResult result;               ///< Counts, drifts and events of the time integration.

  /// Returns the times of the rows (n_rows) [s].
  const std::vector<double>& time() const { return table.at(kTimeColumn); }
  /// Returns the integral ∫ U dt of the strain energy by the trapezoidal rule [J s]: of the
  /// designed bodies, if the table has a column for their energy, otherwise of the model.
  double strain_integral() const;
  /// Returns the largest |tip deflection| of a body [m]; nothing if the table has no such column.
  std::optional<double> amplitude(const std::string& body) const;
};

/// Statistics of a quantity over a motion.
struct Variation {
  double mean = 0;          ///< Mean over time.
  double rms = 0;           ///< Root mean square about the mean, over time.
  double peak_to_peak = 0;  ///< Difference of the largest and the smallest value.
  double largest = 0;       ///< Largest absolute value.
};
/// Computes the statistics of a quantity; integrals over time use the trapezoidal rule.
/// @param time    increasing times (n) [s], n >= 2
/// @param values  values of the quantity (n)
Variation variation_of(std::span<const double> time, std::span<const double> values);

/// The result of a [static] analysis: a table with a row per equilibrium.
struct PathRecord {
  Series table;              ///< Table with the columns of path_columns().
  std::vector<double> arc;   ///< Arc length of the path in scaled displacements (n_rows) [-].
  Animation animation;       ///< Frames for the animation of the report.
  fem::StaticResult result;  ///< Counts of the solver and last load factor.
  std::vector<std::string> redundant_joints;  ///< Joints whose forces are not unique.
};

/// The largest size of a column and the time at which it is reached [s].
struct LargestError {
  double size = 0, time = 0;  ///< Largest absolute value, and its time [s].
};
/// Returns the largest |delta| over a motion of the body that follows a trajectory.
/// @param quantity  delta_x, delta_y [m] or delta_angle [rad]
LargestError largest_error(const MotionRecord& motion, const std::string& body,
                           const std::string& quantity);

}  // namespace cases

}  // namespace flexmorph
