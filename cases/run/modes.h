#pragma once

#include <string>
#include <vector>

namespace flexmorph::cases {

/// Options of the command `modes`.
struct ModesOptions {
  std::string case_name;               ///< Path of a case, or name of a shipped case.
  std::string directory;               ///< Folder of the results; empty: runs/<name>_modes.
  std::vector<std::string> overrides;  ///< Overrides of keys of the case, "KEY=VALUE".
  double time = 0;                     ///< Time [s], or load factor of a [static] analysis.
  int count = 10;                      ///< Largest number of modes, rigid ones included.
  bool stopped = false;                ///< True if drives and material flow stand still.
};

/// Computes the natural modes of a case at one time, and writes modes.csv, modes.json, report.html
/// and the shapes (modes/*.vtu with modes/modes.pvd) into a folder.
/// @return text with the table of the modes
/// @throws Error (input) for a case or a time that cannot be used; Error (numerical) when no
///         equilibrium is found or the eigenvalues do not converge; no file is written then
std::string modes_of_case(const ModesOptions& options);

}  // namespace flexmorph::cases
