#pragma once

#include <span>
#include <string>
#include <vector>

#include "cases/stability/verdict.h"

namespace flexmorph::cases {

/// Options of the command `stability`.
struct StabilityOptions {
  std::vector<std::string> cases;            ///< Case files or names; empty: all shipped cases.
  std::vector<std::string> suites;           ///< Names; empty: all suites not on request only.
  std::vector<std::string> overrides;        ///< Overrides of all cases, "KEY=VALUE".
  std::string directory = "runs/stability";  ///< Folder of the study.
  int jobs = 1;                              ///< Number of processes at the same time.
  double timeout = 60;                       ///< Limit of the CPU time of a run [s].
  bool quiet = false;  ///< True if only the summary and the rows that are WRONG are printed.
  Dispatch dispatch;   ///< Destination of the runs.
};

/// A row of the report: one changed run of one case, and its verdict.
struct StabilityRow {
  std::string case_name, suite, parameter;  ///< Names of the case, the suite and the change.
  bool has_run = false;                     ///< True if the run has ended.
  int exit_code = -1;                       ///< Exit code of the run; -1 if a signal ended it.
  double seconds_cpu = 0;                   ///< CPU time of the run [s].
  Assessment assessment;                    ///< Verdict on the run, with its numbers.
};

/// Runs the suites on cases. Every run is a process of its own with limits of time and memory.
/// Writes stability.csv, .md and .svg, which are rewritten after every tenth run, and one run
/// folder per run. If a run with the same case has already ended, it is assessed again from its
/// files.
/// @return exit code: 0; 3 if a run is WRONG; 4 if runs are missing or interrupted
/// @throws Error (input) for an unknown case or suite, and for an unchanged case that is refused
int check_stability(const StabilityOptions& options);

/// Writes a CSV file with a row per run, in full precision.
void write_stability_csv(std::span<const StabilityRow> rows, const std::string& path);
/// Returns the report as Markdown: legend, counts of verdicts per suite, and all rows.
std::string stability_markdown(std::span<const StabilityRow> rows);
/// Returns the text for the terminal: all rows or only the rows that are WRONG, and a summary.
/// @param all  true for all rows
std::string stability_text(std::span<const StabilityRow> rows, bool all);
/// Returns a map of the verdicts as SVG, with one line per change and one column per case. The
/// colour of a cell shows the verdict; its text is the error of the energy balance or, without it,
/// the number of Newton iterations.
std::string stability_svg(std::span<const StabilityRow> rows);

}  // namespace flexmorph::cases
