#pragma once

#include <span>
#include <string>
#include <vector>

#include "cases/study/result_table.h"
#include "cases/study/sweep.h"
#include "cases/study/sweep_motion.h"

/// What the parts of a sweep know of each other.
namespace flexmorph::cases {

/// A sweep as it was planned.
struct Sweep {
  std::string case_name;
  std::vector<Varied> varied;
  std::vector<Variant> variants;  // all combinations, the last key fastest
  ResultTable table;              // goals may be varied; none: scenes without a design
  Motions reference;              // of scenes without a design

  /// Variants in a row that differ in the last key only.
  size_t n_last() const { return varied.back().values.size(); }
  const std::string& value(size_t variant, size_t key) const;
  /// The first so many keys, and their values of a variant: "speed = 0.1, min_thickness = 0.005".
  std::string title_of(size_t variant, size_t n_keys) const;
  std::string title_of(size_t variant) const { return title_of(variant, varied.size()); }
};

/// The last part of a dotted key.
std::string last_part(const std::string& key);

/// STEM.csv, STEM.md and STEM.svg of designs: the table, and on one page designs above their
/// histories and the deflections of their motions, P Figs. 13 to 23.
void write_designs(const Sweep& sweep, std::span<const VariantResult> runs,
                   const std::string& stem);

}  // namespace flexmorph::cases
