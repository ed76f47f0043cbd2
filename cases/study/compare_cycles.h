#pragma once

#include "cases/study/study.h"

namespace flexmorph::cases {

/// Options of the command `compare` for kinds of design cycles.
struct CompareCyclesOptions {
  StudyOptions study;             ///< Options of the study.
  std::vector<std::string> ways;  ///< Kinds of cycles: "esl", "corrected", "direct".
};

/// Designs a case with each kind of design cycles and compares the results. The kinds are
/// equivalent static loads alone ("esl"), these followed by corrected cycles ("corrected"), and
/// these followed by the optimizer on the motion itself ("direct"). All designs are certified by
/// the same motion. Writes compare.csv and compare.md (a row per kind: J, KKT residual, motions,
/// CPU time) and compare.svg (J over CPU time) into the folder of the study, and prints the table
/// on the terminal.
/// @return exit code as run_variants()
/// @throws Error (input) for options or a case that cannot be used
int compare_cycles(const CompareCyclesOptions& options);

}  // namespace flexmorph::cases
