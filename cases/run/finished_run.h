#pragma once

#include <string>
#include <vector>

#include "cases/scene/scene.h"

/// Runs that came to their end, read from their folders.
namespace flexmorph::cases {

/// Returns the path of the case that a finished run keeps in its folder.
/// @throws Error (input) where there is no such run.
std::string finished_case(const std::string& directory);

/// Returns the changes of a case, "design.0.start='...'", that put the designs of a finished run of
/// it in place of their starts.
std::vector<std::string> changes_to_designs(const std::string& directory, const Scene& scene);

}  // namespace flexmorph::cases
