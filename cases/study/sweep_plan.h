#pragma once

#include <span>
#include <string>
#include <vector>

#include "cases/study/sweep.h"
#include "cases/study/sweep_motion.h"

/// What the parts of a sweep know of each other.
namespace flexmorph::cases {

/// A sweep as it was planned.
struct Sweep {
  std::string case_name;
  std::vector<Varied> varied;
  std::vector<Variant> variants;  // all combinations, the last key fastest
  std::vector<mmc::Goal> goals;   // of every designed body of every variant: they may be varied
  Motions reference;              // of scenes without a design

  size_t n_bodies() const { return goals.size() / variants.size(); }
  /// Variants in a row that differ in the last key only.
  size_t n_last() const { return varied.back().values.size(); }
  const std::string& value(size_t variant, size_t key) const;
  /// What designs of a variant are ranked by.
  double figure(size_t variant, const BodyResult& result, size_t body) const;
  /// The first so many keys, and their values of a variant: "speed = 0.1, min_thickness = 0.005".
  std::string title_of(size_t variant, size_t n_keys) const;
  std::string title_of(size_t variant) const { return title_of(variant, varied.size()); }
};

/// The last part of a dotted key.
std::string last_part(const std::string& key);

/// A row per variant and designed body.
std::vector<std::vector<std::string>> design_table(const Sweep& sweep,
                                                   std::span<const VariantResult> runs);

/// STEM.csv, STEM.md and STEM.svg of designs: the table, and on one page designs above their
/// histories and the deflections of their motions, P Figs. 13 to 23.
void write_designs(const Sweep& sweep, std::span<const VariantResult> runs,
                   const std::string& stem);

}  // namespace flexmorph::cases
