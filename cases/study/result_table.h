#pragma once

#include <string>
#include <vector>

#include "cases/study/study.h"

/// Tables of the designs of many runs, with the same columns for all studies.
namespace flexmorph::cases {

/// What a study adds to the results of its runs.
struct ResultTable {
  std::vector<std::string> names;                ///< of its own first columns
  std::vector<std::vector<std::string>> values;  ///< in these columns, of every run
  std::vector<mmc::Goal> goals;                  ///< of every designed body of every run

  size_t n_bodies() const { return values.empty() ? 0 : goals.size() / values.size(); }
  const mmc::Goal& goal(size_t run, size_t body) const { return goals.at(run * n_bodies() + body); }
};

/// Returns what designs are ranked by: body-fitted compliance x volume / volume allowed, because
/// volumes differ a little [J]; of designs without a body-fitted one the sharp compliance. Where
/// another response is minimized, its value of the sharp design.
double figure_of(const BodyResult& result, const mmc::Goal& goal);

/// Returns how far the final design is beyond its limits, relative; 0 when it is feasible.
double violation_of(const BodyResult& result, const mmc::Goal& goal);

/// Writes a row per run and designed body, in full precision.
/// @throws Error (input) when the file cannot be written.
void write_results(const ResultTable& table, std::span<const VariantResult> runs,
                   const std::string& path);

/// Returns a row per run and designed body for a report; the first row is the header.
std::vector<std::vector<std::string>> result_rows(const ResultTable& table,
                                                  std::span<const VariantResult> runs);

}  // namespace flexmorph::cases
