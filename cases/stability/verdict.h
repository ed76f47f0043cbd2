#pragma once

#include <array>
#include <optional>
#include <string>

#include "cases/study/study.h"

/// Verdicts on the runs of a stability study, from their exit codes and their files.
namespace flexmorph::cases {

enum class Verdict {
  stable,    ///< exit code 0, all numbers are finite, and the run gives no warning
  refused,   ///< exit code 2 or 3: the run was refused or gave up, and a message says why
  degraded,  ///< the run gives a warning, or exceeded its time limit
  wrong      ///< a crash, a hang, a number that is not finite, or an end without a message
};
std::string to_string(Verdict verdict);

/// Numbers of a run that the report of a stability study shows: the energy defect over the largest
/// energy, the largest |Φ| [m] and |Φ_t + Φ_q q̇| [m/s], Newton iterations per step or equilibrium,
/// the number of rejected steps, the largest condition, and the smallest area ratio.
inline constexpr std::array<const char*, 7> kRunNumbers = {
    "energy_defect",  "position_drift", "velocity_drift",     "newton_per_step",
    "rejected_steps", "condition",      "smallest_area_ratio"};

struct Assessment {
  Verdict verdict = Verdict::wrong;
  std::string reason;  ///< one sentence; empty for a stable run
  std::array<std::optional<double>, kRunNumbers.size()> numbers;  ///< absent where there is none
};

/// Returns the verdict on a run that has ended.
Assessment assess(const VariantResult& run);

}  // namespace flexmorph::cases
