#pragma once

#include <span>
#include <string>

#include "cases/assembly/prepared_case.h"

namespace flexmorph::cases {

/// Returns a text about a case: its contents, the features that it does not use, and the cost of
/// its items.
/// @param name       path, or name of a shipped case
/// @param overrides  KEY=VALUE
/// @param explain    true: returns the case with all its default values instead
/// @throws Error (input) when the case cannot be used
std::string check_case(const std::string& name, std::span<const std::string> overrides,
                       bool explain);
/// Returns a text about a case that was built: its contents, the features that it does not use, and
/// the cost of its items.
std::string check_text(const PreparedCase& prepared);

}  // namespace flexmorph::cases
