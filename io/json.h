#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

namespace flexmorph::io {

/// JSON as files have it: indented, keys in their order, a line end. Numbers that are not finite
/// are null, bytes that are not UTF-8 the replacement character.
std::string json_text(const nlohmann::ordered_json& value);

}  // namespace flexmorph::io
