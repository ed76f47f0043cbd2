#pragma once

#include "cases/results/series.h"
#include "fem/dynamics/motion.h"
#include "fem/solve/statics.h"
#include "geometry/memory.h"
#include "io/plane_frames.h"

/// What a motion or a path of equilibria leaves behind.
namespace flexmorph {

namespace io {
void remember(Memory& memory, PlaneFrame& frame);  ///< saves or restores a picture
}  // namespace io

namespace cases {

/// Names of columns that code looks up.
inline constexpr const char *kTimeColumn = "time", *kKineticColumn = "energy.kinetic",
                            *kStrainColumn = "energy.strain",
                            *kPotentialColumn = "energy.potential",
                            *kDefectColumn = "energy.defect", *kFactorColumn = "load_factor";
/// The end of the names of columns with tip deflections.
inline const std::string kDeflectionEnding = ".tip_deflection";
/// The end of the names of columns with deflections of observed points.
inline const std::string kAcrossEnding = "_across";

/// The result of a motion: a row per step, pictures, remarks on its start, and the counts of the
/// time integration.
struct MotionRecord {
  Series table;                           ///< columns of MotionColumns
  std::vector<io::PlaneFrame> snapshots;  ///< pictures of a mechanism
  std::vector<std::string> remarks;  ///< sentences on the start, where it differs from the case
  fem::MotionResult result;

  const std::vector<double>& time() const { return table.at(kTimeColumn); }
  /// ∫ U dt of the whole model by the trapezoidal rule [J s].
  double strain_integral() const;
  /// Largest |tip deflection| of a body [m]; nothing where the table has no such column.
  std::optional<double> amplitude(const std::string& body) const;
};

/// Says how a quantity varies over a motion.
struct Variation {
  double mean = 0;          ///< over time
  double rms = 0;           ///< root mean square about the mean, over time
  double peak_to_peak = 0;  ///< largest less smallest value
  double largest = 0;       ///< largest size
};
/// Integrates over time by the trapezoidal rule.
/// @param time    [s] (n), rising, at least two
/// @param values  (n)
Variation variation_of(std::span<const double> time, std::span<const double> values);

/// The result of a [static] analysis: a row per equilibrium.
struct PathRecord {
  Series table;             ///< columns of path_columns()
  std::vector<double> arc;  ///< length of the path in scaled displacements, per row [-]
  fem::StaticResult result;
};

/// The largest size of a column and the time at which it is reached [s].
struct LargestError {
  double size = 0, time = 0;
};
/// The largest |delta| of a trajectory's body over a motion.
/// @param quantity  delta_x, delta_y [m] or delta_angle [rad]
LargestError largest_error(const MotionRecord& motion, const std::string& body,
                           const std::string& quantity);

}  // namespace cases

}  // namespace flexmorph
