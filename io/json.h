#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

namespace flexmorph::io {

/// Returns JSON text for files: indented, with the keys in their order and a line end. Numbers that
/// are not finite become null; bytes that are not UTF-8 become the replacement character.
std::string json_text(const nlohmann::ordered_json& value);

}  // namespace flexmorph::io
