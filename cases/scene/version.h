#pragma once

#include <string>
#include <utility>
#include <vector>

namespace flexmorph::cases {

extern const char* const kVersion;      ///< of Flexmorph: "0.1.0"
extern const char* const kCasesFolder;  ///< of the shipped cases in the source tree

/// Names and versions of the libraries Flexmorph was built with.
std::vector<std::pair<std::string, std::string>> library_versions();

}  // namespace flexmorph::cases
