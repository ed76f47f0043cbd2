#pragma once

#include <span>
#include <string>
#include <vector>

#include "cases/assembly/prepared_case.h"

namespace flexmorph::cases {

/// Cells of a design at rest whose solver is built for a look: a second's work. Of larger ones only
/// the places of loads and supports are looked up, without gigabytes for a factor nobody uses.
inline constexpr int kMostBuilt = 200'000;

/// A case that can be run: read, of a size for this machine, and built once.
struct ReadyCase {
  io::CaseFile file;
  PreparedCase prepared;
};
/// @param name  path, or name of a shipped case
/// @param directory  of the run folder, whose disk it must fit on; empty: as the case says
/// @throws Error naming the file, and line and column where they can be told.
ReadyCase ready_case(const std::string& name, std::span<const std::string> overrides,
                     const std::string& directory = "");

/// Path of a case file: the path itself, or that of a shipped case of this name.
/// @throws Error (input) naming the shipped cases.
std::string find_case(const std::string& name);
/// Names of the shipped cases.
std::vector<std::string> shipped_cases();

/// Builds what a run of the case builds first: what cannot be built is refused here, and before
/// that what is too large for this machine (see require_room()).
/// @throws Error, which names the case file where the scene comes from one
void require_buildable(const PreparedCase& prepared, const std::string& directory = "");

/// The message with the place in the case file in front: that of the joint, body, spring, drive or
/// load that it names first in quotes, else the file alone. As it is where it begins with a place.
std::string located_refusal(const Scene& scene, const std::string& message);

}  // namespace flexmorph::cases
