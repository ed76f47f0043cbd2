#pragma once

#include <nlohmann/json.hpp>
#include <string>

extern template class nlohmann::basic_json<>;  // compiled once, in run_json.cpp

namespace flexmorph::test {

using nlohmann::json;

/// Returns what run.json of a run's folder says. @throws json::parse_error where it is not JSON
json run_json(const std::string& folder);

}  // namespace flexmorph::test
