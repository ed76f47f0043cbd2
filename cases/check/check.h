#pragma once

#include <span>
#include <string>

namespace flexmorph::cases {

/// Says what a case contains, what it leaves out, and what each part costs.
/// @param name       path, or name of a shipped case
/// @param overrides  KEY=VALUE
/// @param explain    returns the case with all its defaults instead
/// @throws Error (input) when the case cannot be used
std::string check_case(const std::string& name, std::span<const std::string> overrides,
                       bool explain);

}  // namespace flexmorph::cases
