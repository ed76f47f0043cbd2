#pragma once

#include <string>
#include <vector>

#include "cases/stability/suites.h"

/// How rows of suites are written, and the parts of their table.
namespace flexmorph::cases {

/// "body.0.thickness=0.0001".
std::string entry(const std::string& list, size_t index, const std::string& key, double value);
std::string entry_text(const std::string& list, size_t index, const std::string& key,
                       const std::string& value);

/// "[0, -9.81]".
std::string vector_of(const VectorXd& v);

/// Rows of the table of suites: loads, rest, insertion, long, joints, outputs.
std::vector<Suite> event_suites();

}  // namespace flexmorph::cases
