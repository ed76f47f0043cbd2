#pragma once

#include <string>
#include <vector>

#include "cases/scene/scene.h"

/// Functions that read finished runs from their folders.
namespace flexmorph::cases {

/// Returns the path of the case file that is stored in the folder of a finished run.
/// @throws Error (input) if the folder contains no finished run.
std::string finished_case(const std::string& directory);

/// Returns the overrides of a case, "design.0.start='...'", with which its designs start from the
/// final designs of a finished run.
/// @param directory  folder of the finished run of the same case
std::vector<std::string> changes_to_designs(const std::string& directory, const Scene& scene);

}  // namespace flexmorph::cases
