#pragma once

#include <span>
#include <string>
#include <vector>

#include "cases/assembly/prepared_case.h"

namespace flexmorph::cases {

/// Largest number of cells of a static design whose solver is built for a check, which takes about
/// a second. For larger designs only the locations of loads and supports are determined, because a
/// factor of the matrix would take gigabytes of memory without being used.
inline constexpr int kMaxBuiltCells = 200'000;

/// A case that can be run: it is read, small enough for this machine, and was built once.
struct ReadyCase {
  io::CaseFile file;      ///< Case file with the overrides.
  PreparedCase prepared;  ///< Scene, with the models built from it.

  /// Overrides of keys of the case, "KEY=VALUE".
  std::vector<std::string> overrides = {};
};
/// Reads a case and builds its model, its design problems and its loads, as a run does first.
/// @param name       path, or name of a shipped case
/// @param overrides  KEY=VALUE
/// @param directory  run folder, on whose disk the results must fit; empty: as the case says
/// @throws Error naming the file, and line and column where they are known.
ReadyCase ready_case(const std::string& name, std::span<const std::string> overrides,
                     const std::string& directory = "");

/// Builds the model, the design problems and the loads of a case that was read.
/// @param overrides  overrides with which the file was read, KEY=VALUE
/// @param directory  run folder, on whose disk the results must fit; empty: as the case says
/// @throws Error naming the file, and line and column where they are known.
ReadyCase ready_case(io::CaseFile file, std::span<const std::string> overrides,
                     const std::string& directory = "");

/// Returns the folder of the shipped cases. For an installed program or shared library it is
/// share/flexmorph/cases beside its folder bin/, lib/ or lib/ARCHITECTURE/, and for the Python
/// package beside lib/, even if the installation was moved. Otherwise it is in the source tree, or,
/// without a source tree, below the prefix for which Flexmorph was configured.
std::string cases_folder();
/// Returns the path of a case file: the path itself, or the path of the shipped case of this name.
/// @throws Error (input) naming the shipped cases.
std::string find_case(const std::string& name);
/// Returns the title of a case, without reading more of it; its name if it has no title.
/// @param name  path, or name of a shipped case
std::string title_of_case(const std::string& name);
/// Returns a line with name and title for each shipped case.
std::string list_of_cases();
/// Returns the names of the shipped cases.
std::vector<std::string> shipped_cases();

/// Builds the model, the design problems and the loads of a case, as a run does first, so that
/// errors are reported before the run. Before that it throws for a case that is too large for this
/// machine (see require_disk()).
/// @param directory  run folder; empty: as the case says
/// @throws Error, which names the case file if the scene comes from one
void require_buildable(const PreparedCase& prepared, const std::string& directory = "");

/// Returns the message with the location in the case file in front of it: the location of the
/// joint, body, rigid body, spring, drive or load whose name is quoted first in the message, else
/// the file alone. A message that already begins with a location is returned unchanged.
std::string located_refusal(const Scene& scene, const std::string& message);

}  // namespace flexmorph::cases
