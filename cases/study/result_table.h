#pragma once

#include <string>
#include <vector>

#include "cases/study/study.h"

/// Tables of the designs of many runs. Their columns are the same in all studies.
namespace flexmorph::cases {

/// The first columns of a table of results, and the goals of the designs, which a study defines.
struct ResultTable {
  std::vector<std::string> names;                ///< Names of the first columns.
  std::vector<std::vector<std::string>> values;  ///< Values of the first columns, by run.
  std::vector<mmc::Goal> goals;                  ///< Goals of designed bodies, [run][body].

  /// Returns the number of designed bodies of every run.
  size_t n_bodies() const { return values.empty() ? 0 : goals.size() / values.size(); }
  /// Returns the goal of a designed body of a run.
  const mmc::Goal& goal(size_t run, size_t body) const { return goals.at(run * n_bodies() + body); }
};

/// Returns the figure by which designs are ranked. It is body-fitted compliance x volume / allowed
/// volume [J], because the volumes of designs differ slightly. Without a body-fitted compliance,
/// the compliance and the volume are those of the crisp design. If another response is minimized,
/// the figure is the value of this response of the crisp design.
double figure_of(const BodyResult& result, const mmc::Goal& goal);

/// Returns the largest relative violation of a limit by the final design; 0 if it is feasible.
double violation_of(const BodyResult& result, const mmc::Goal& goal);

/// Writes a CSV file with a row per run and designed body, in full precision.
/// @throws Error (input) when the file cannot be written.
void write_results(const ResultTable& table, std::span<const VariantResult> runs,
                   const std::string& path);

/// Returns a header and a row per run and designed body for a report.
std::vector<std::vector<std::string>> result_rows(const ResultTable& table,
                                                  std::span<const VariantResult> runs);

}  // namespace flexmorph::cases
