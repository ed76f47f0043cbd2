#pragma once

#include <map>
#include <memory>
#include <string>

#include "optim/optimizer.h"

namespace flexmorph::optim {

using Options = std::map<std::string, double>;

/// The defaults of one optimizer with what the user set instead.
/// @throws Error (input) for a name the defaults do not have, naming those they have, and for
///         values that are not finite.
Options with_defaults(const Settings& settings, const Options& defaults);

/// One maker per file; optimizers.cpp holds the table. They check their own options.
std::unique_ptr<Optimizer> make_mma(const Settings& settings);    // mma.cpp: mma, gcmma
std::unique_ptr<Optimizer> make_nlopt(const Settings& settings);  // nlopt.cpp
std::unique_ptr<Optimizer> make_ipopt(const Settings& settings);  // ipopt.cpp

/// @throws Error (input) unless low <= value <= high.
void check_option(const Settings& settings, const std::string& option, double value, double low,
                  double high);

}  // namespace flexmorph::optim
