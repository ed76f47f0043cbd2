#pragma once

#include "cases/study/study.h"

namespace flexmorph::cases {

struct SweepOptions {
  StudyOptions study;
  std::vector<std::string> vary;  ///< "KEY=V1,V2,..."
  int index = 0;                  ///< run this variant only, from 1; 0: all, and collect
  bool list = false;              ///< print the variants instead
  std::string reference;          ///< CSV with columns of motion.csv, drawn as points; or empty
};

/// One key and its values. Those of "case" are cases: each takes the place of the study's.
struct Varied {
  std::string key;
  std::vector<std::string> values;
};
/// "KEY=V1,V2": commas within brackets, braces and quotes belong to a value.
/// @throws Error (input) for no key, no value or an empty one.
Varied read_varied(const std::string& text);

/// All combinations, the last key fastest, named by the last parts of their keys.
/// @throws Error (input) for none, or a key twice.
std::vector<Variant> combinations(const std::vector<Varied>& varied);

/// Runs a case with every combination of values, and collects sweep.csv, sweep.md and sweep.svg
/// (designs above their histories; of scenes without a design observed quantities, one curve per
/// variant, and where the last key has three numbers or more sweep_ends.svg, the ends of the runs
/// against them) in the study's folder; the table goes to the terminal.
/// @return exit code as run_variants(). @throws Error (input).
int sweep_case(const SweepOptions& options);

}  // namespace flexmorph::cases
