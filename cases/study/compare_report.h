#pragma once

#include <span>
#include <string>
#include <utility>
#include <vector>

#include "cases/scene/scene.h"
#include "cases/study/result_table.h"
#include "io/plots.h"

namespace flexmorph::cases {

/// The plan of a comparison of optimizers; its runs are in the order [optimizer][start].
struct Comparison {
  std::string case_name;                ///< Path or name of the case.
  std::vector<std::string> optimizers;  ///< Names of the optimizers.
  int starts = 0;                       ///< Number of starts of every optimizer.
  ResultTable table;                    ///< First columns and goals of the table of results.
  std::vector<Variant> variants;        ///< The runs, in the order [optimizer][start].
};

/// Returns a header and a row per optimizer: medians over the starts, the range of the ranking
/// figure (see figure_of()), and whether the difference from the best optimizer exceeds the spread.
std::vector<std::vector<std::string>> summary_of(const Comparison& plan,
                                                 std::span<const VariantResult> runs);

/// Returns the completed runs of one optimizer, with the indices of their starts (from 0).
std::vector<std::pair<const VariantResult*, int>> runs_of(const Comparison& plan,
                                                          std::span<const VariantResult> runs,
                                                          size_t optimizer);

/// Returns plots of the convergence over state solves and over CPU time, and data profiles.
io::Figure comparison_figure(const Comparison& plan, std::span<const VariantResult> runs);

/// Writes compare.csv, compare.md, compare.svg and compare.html into a folder.
/// @throws Error (input) when a file cannot be written.
void write_comparison(const Comparison& plan, std::span<const VariantResult> runs,
                      const std::string& directory);

}  // namespace flexmorph::cases
