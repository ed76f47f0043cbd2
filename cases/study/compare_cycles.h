#pragma once

#include "cases/study/study.h"

namespace flexmorph::cases {

struct CompareCyclesOptions {
  StudyOptions study;
  std::vector<std::string> ways;  ///< of "esl", "corrected", "direct"
};

/// Designs a case by equivalent static loads alone, goes on with corrected cycles, and with the
/// optimizer on the motion itself, all three certified by the same motion; writes compare.csv and
/// compare.md (a row per way: J, KKT residual, motions, CPU time) and compare.svg (J over CPU time)
/// into the study's folder; the table goes to the terminal.
/// @return exit code as run_variants(). @throws Error (input).
int compare_cycles(const CompareCyclesOptions& options);

}  // namespace flexmorph::cases
