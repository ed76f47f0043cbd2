#pragma once

#include <array>
#include <optional>
#include <string>

#include "cases/study/study.h"

/// Verdicts on the runs of a stability study, from their exit codes and their files.
namespace flexmorph::cases {

/// The verdict on a run.
enum class StabilityVerdict {
  stable,    ///< Exit code 0, all numbers are finite, and the run gives no warning.
  refused,   ///< Exit code 2 or 3: the run was refused or stopped, and a message gives the reason.
  degraded,  ///< The run gives a warning, or exceeded its time limit.
  wrong      ///< A crash, a hang, a number that is not finite, or an end without a message.
};
/// Returns the name of a verdict; "WRONG" is in capitals.
std::string to_string(StabilityVerdict verdict);

/// Names of the numbers of a run in the report of a stability study: the error of the energy
/// balance over the largest energy, the largest |Φ| [m] and |Φ_t + Φ_q q̇| [m/s], Newton iterations
/// per step or equilibrium, the number of rejected steps, the largest condition, and the smallest
/// area ratio.
inline constexpr std::array<const char*, 7> kRunNumbers = {
    "energy_error",   "position_drift", "velocity_drift",     "newton_per_step",
    "rejected_steps", "condition",      "smallest_area_ratio"};

/// The assessment of a run: its verdict, the reason, and its numbers.
struct Assessment {
  StabilityVerdict verdict = StabilityVerdict::wrong;  ///< Verdict on the run.
  std::string reason;  ///< Reason of the verdict; empty for a stable run.

  /// Numbers of the run, in the order of kRunNumbers; absent if the run does not have a number.
  std::array<std::optional<double>, kRunNumbers.size()> numbers;
};

/// Returns the verdict on a run that has ended.
Assessment assess(const VariantResult& run);

}  // namespace flexmorph::cases
