#pragma once

#include <string>
#include <utility>
#include <vector>

namespace flexmorph::cases {

extern const char* const kVersion;  ///< Version of Flexmorph, such as "0.1.0".
/// Commit of the sources; with a plus sign if files were changed after it; empty if it is unknown.
extern const char* const kCommit;
extern const char* const kCasesFolder;  ///< Folder of the shipped cases in the source tree.

/// Returns the names and versions of the libraries that Flexmorph was built with.
std::vector<std::pair<std::string, std::string>> library_versions();

}  // namespace flexmorph::cases
