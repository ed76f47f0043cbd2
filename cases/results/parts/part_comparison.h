#pragma once

#include <optional>
#include <string>
#include <vector>

namespace flexmorph::cases {

struct RunResult;
struct Scene;

/// A number of the parts, with the same number of the design and of uniform material.
struct ComparedNumber {
  std::string body;         ///< Name of the body; empty means all bodies together.
  std::string name;         ///< Name of the number, as in run.json if it is there.
  std::string unit, words;  ///< Unit, and meaning of the number as text.
  std::optional<double> part, design, uniform;  ///< Values; absent if they were not computed.
};

/// Numbers of verified parts, compared with numbers of the design of a run, which are computed in
/// the same way, and with numbers of uniform material.
struct PartComparison {
  std::vector<std::pair<std::string, std::string>> files;  ///< Body and file path of every part.
  std::string design;                   ///< Folder of the run with the design; empty: no design.
  std::vector<std::string> notes;       ///< Messages on the limitations of the numbers.
  std::vector<ComparedNumber> numbers;  ///< The compared numbers.
};

/// Returns mass, volume fraction, compliances, stress, deflections, widths and strain energy
/// integral of a result with parts.
/// @param design  result of the evaluated design; null means that no design is compared
std::vector<ComparedNumber> compared_numbers(const Scene& scene, const RunResult& parts,
                                             const RunResult* design);

/// Returns a header and a row per number, with the differences of the part in per cent.
std::vector<std::vector<std::string>> comparison_rows(const PartComparison& comparison);

}  // namespace flexmorph::cases
