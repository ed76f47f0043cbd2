#pragma once

#include <span>
#include <string>
#include <vector>

#include "cases/study/result_table.h"
#include "cases/study/sweep.h"
#include "cases/study/sweep_motion.h"

/// The plan of a sweep, which its functions for motions and for designs share.
namespace flexmorph::cases {

/// The plan of a sweep: the varied keys, the variants, and the table of results.
struct Sweep {
  std::string case_name;          ///< Path or name of the case.
  std::vector<Varied> varied;     ///< Varied keys with their values.
  std::vector<Variant> variants;  ///< All combinations; the value of the last key changes fastest.
  ResultTable table;  ///< First columns, and goals; there are no goals for scenes without a design.
  Motions reference;  ///< Reference motion for scenes without a design.

  /// Returns the number of consecutive variants that differ in the last key only.
  size_t n_last() const { return varied.back().values.size(); }
  /// Returns the value of a key in a variant.
  const std::string& value(size_t variant, size_t key) const;
  /// Returns the first keys with their values in a variant: "speed = 0.1, min_thickness = 0.005".
  /// @param n_keys  number of keys; without it all keys are used
  std::string title_of(size_t variant, size_t n_keys) const;
  std::string title_of(size_t variant) const { return title_of(variant, varied.size()); }
};

/// Returns the last component of a dotted key.
std::string last_part(const std::string& key);

/// Writes the files STEM.csv and STEM.md with the table of designs, and STEM.svg, which shows
/// designs above their histories and the deflections of their motions (as P Figs. 13 to 23, see
/// fem/README.md).
void write_designs(const Sweep& sweep, std::span<const VariantResult> runs,
                   const std::string& stem);

}  // namespace flexmorph::cases
