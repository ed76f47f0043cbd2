#pragma once

#include <string>
#include <vector>

/// The command `report`: one page that compares finished runs.
namespace flexmorph::cases {

/// Options of the command `report`.
struct ReportOptions {
  std::vector<std::string> runs;         ///< Run folders.
  std::string path = "comparison.html";  ///< File that is written.
};

/// Writes a page that compares runs: their designs and numbers, the settings that differ between
/// them, the convergence of their designs and their motions.
/// @return message with the path of the page
/// @throws Error (input) for a folder that is no run folder; Error (numerical) when the page cannot
///         be written.
std::string compare_runs(const ReportOptions& options);

}  // namespace flexmorph::cases
