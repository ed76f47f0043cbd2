#pragma once

#include <optional>
#include <string>
#include <vector>

namespace flexmorph::cases {

struct RunResult;
struct Scene;

/// A number of parts, beside that of the design and that of uniform material.
struct ComparedNumber {
  std::string body;  ///< empty: of all bodies together
  std::string name;  ///< as in run.json where it is there
  std::string unit, words;
  std::optional<double> part, design, uniform;
};

/// Numbers of verified parts beside those of the design of a run, found in the same way, and of
/// uniform material.
struct PartComparison {
  std::vector<std::pair<std::string, std::string>> files;  ///< of parts: body, path
  std::string design;              ///< folder of the run with the design; empty: there is none
  std::vector<std::string> notes;  ///< sentences on what the numbers are not
  std::vector<ComparedNumber> numbers;
};

/// Returns mass, compliances, stress, deflections, widths and measures of the motion of a result
/// with parts.
/// @param design  of the evaluated design; null: none is compared
std::vector<ComparedNumber> compared_numbers(const Scene& scene, const RunResult& parts,
                                             const RunResult* design);

/// Returns a header and a row per number, with the part's differences in per cent.
std::vector<std::vector<std::string>> comparison_rows(const PartComparison& comparison);

}  // namespace flexmorph::cases
