#pragma once

#include <string>
#include <vector>

#include "cases/build/build.h"

/// Shipped cases as tests read them.
namespace flexmorph::cases {

using Changes = std::vector<std::string>;

/// A shipped case with overrides, "key=value" each. @throws Error (input).
inline Scene read(const std::string& name, const Changes& changes = {}) {
  return read_scene(io::CaseFile(std::string(FLEXMORPH_CASES) + "/" + name + ".toml", changes));
}

}  // namespace flexmorph::cases
