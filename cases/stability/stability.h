#pragma once

#include <span>
#include <string>
#include <vector>

#include "cases/stability/verdict.h"

namespace flexmorph::cases {

struct StabilityOptions {
  std::vector<std::string> cases;      ///< files or names; empty: all shipped ones
  std::vector<std::string> suites;     ///< names; empty: all that do not run on request only
  std::vector<std::string> overrides;  ///< KEY=VALUE of all cases
  std::string directory = "runs/stability";
  int jobs = 1;         ///< number of processes at a time
  double timeout = 60;  ///< CPU time of a run [s]
  bool quiet = false;   ///< prints only the summary and what is WRONG
};

/// One changed run of one case, and its verdict.
struct StabilityRow {
  std::string case_name, suite, parameter;
  bool has_run = false;
  int exit_code = -1;
  double seconds_cpu = 0;
  Assessment assessment;
};

/// Runs the suites on cases, every run in a process of its own with limits of time and memory.
/// Writes stability.csv, .md and .svg, anew after every tenth run, and one run folder per run
/// below. A run that ended before with the same case is assessed again from its files.
/// @return exit code: 0, 3 when a run is WRONG, 4 when interrupted
/// @throws Error (input) for an unknown case or suite, and for a case that is refused unchanged.
int check_stability(const StabilityOptions& options);

void write_stability_csv(std::span<const StabilityRow> rows, const std::string& path);
std::string stability_markdown(std::span<const StabilityRow> rows);
/// Returns the text for the terminal: all rows, or only the rows that are WRONG, and a summary.
std::string stability_text(std::span<const StabilityRow> rows, bool all);
/// Returns a map: one line per parameter, one column per case, the verdict as colour, and the
/// energy defect (else the Newton iterations) as text.
std::string stability_svg(std::span<const StabilityRow> rows);

}  // namespace flexmorph::cases
