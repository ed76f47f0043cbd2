#include "io/json.h"

#include <nlohmann/json.hpp>

namespace flexmorph::io {

std::string json_text(const nlohmann::ordered_json& value) {
  return value.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + "\n";
}

}  // namespace flexmorph::io
