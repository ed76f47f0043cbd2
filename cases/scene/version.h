#pragma once

#include <string>
#include <utility>
#include <vector>

namespace flexmorph::cases {

inline constexpr const char* kVersion = FLEXMORPH_VERSION;
inline constexpr const char* kCasesFolder = FLEXMORPH_CASES;

/// Names and versions of the libraries Flexmorph was built with.
std::vector<std::pair<std::string, std::string>> library_versions();

}  // namespace flexmorph::cases
