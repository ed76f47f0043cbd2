#pragma once

#include <span>
#include <string>
#include <utility>
#include <vector>

#include "cases/scene/scene.h"
#include "cases/study/result_table.h"

namespace flexmorph::cases {

/// A comparison as it was planned: runs in the order [optimizer][start].
struct Comparison {
  std::string case_name;
  std::vector<std::string> optimizers;
  int starts = 0;
  ResultTable table;
  std::vector<Variant> variants;
};

/// A row per optimizer, the first row is the header: medians over the starts, the range of the
/// figure, and whether the spread tells an optimizer from the best one.
std::vector<std::vector<std::string>> summary_of(const Comparison& plan,
                                                 std::span<const VariantResult> runs);

/// The runs of one optimizer that are done, with their starts (from 0).
std::vector<std::pair<const VariantResult*, int>> runs_of(const Comparison& plan,
                                                          std::span<const VariantResult> runs,
                                                          size_t optimizer);

/// Convergence over state solves and over CPU time, and data profiles.
std::string comparison_svg(const Comparison& plan, std::span<const VariantResult> runs);

/// Writes compare.csv, compare.md and compare.svg.
/// @throws Error (input) when a file cannot be written.
void write_comparison(const Comparison& plan, std::span<const VariantResult> runs,
                      const std::string& directory);

}  // namespace flexmorph::cases
