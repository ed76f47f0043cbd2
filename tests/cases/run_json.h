#pragma once

#include <nlohmann/json.hpp>
#include <string>

extern template class nlohmann::basic_json<>;  // compiled once, in run_json.cpp

namespace flexmorph::test {

using nlohmann::json;

/// Returns the contents of run.json in the folder of a run. @throws json::parse_error if the file
/// is not valid JSON.
json run_json(const std::string& folder);

}  // namespace flexmorph::test
