#pragma once

#include "cases/study/study.h"

namespace flexmorph::cases {

/// Options of the command `sweep`.
struct SweepOptions {
  StudyOptions study;             ///< Options of the study.
  std::vector<std::string> vary;  ///< Varied keys with their values, "KEY=V1,V2,...".
  std::string reference;          ///< CSV file with columns of motion.csv to plot; or empty.
};

/// A varied key and its values. The values of the key "case" are cases that replace the case of the
/// study.
struct Varied {
  std::string key;                  ///< Path of the key in the case file, or "case".
  std::vector<std::string> values;  ///< Values of the key, as text of a case file.
};
/// Reads a key and its values from "KEY=V1,V2". Commas within brackets, braces and quotes belong to
/// a value.
/// @throws Error (input) for a text without a key or value, or with an empty value.
Varied read_varied(const std::string& text);

/// Returns all combinations of the values; the value of the last key changes fastest. The names of
/// the variants consist of the last components of the keys, in alphabetical order, and of the
/// values.
/// @throws Error (input) for no key, a repeated key, or too many combinations.
std::vector<Variant> combinations(const std::vector<Varied>& varied);

/// Runs a case with every combination of values, writes sweep.csv, sweep.md and sweep.svg into the
/// folder of the study, and prints the table on the terminal. The picture shows designs above their
/// histories. For scenes without a design it shows the observed quantities with one curve per
/// variant; if the last key has three or more numbers, sweep_ends.svg shows the values at the end
/// of the runs against these numbers.
/// @return exit code as run_variants()
/// @throws Error (input) for options or a case that cannot be used
int sweep_case(const SweepOptions& options);

}  // namespace flexmorph::cases
