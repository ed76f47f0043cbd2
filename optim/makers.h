#pragma once

#include <map>
#include <memory>
#include <string>

#include "optim/optimizer.h"

namespace flexmorph::optim {

/// Options of one optimizer by their names.
using Options = std::map<std::string, double>;

/// Returns the default options of one optimizer, replaced by the values that the user has set.
/// @throws Error (input) for a name that the defaults do not contain (the message lists the valid
///         names), and for values that are not finite.
Options with_defaults(const Settings& settings, const Options& defaults);

/// Returns the optimizer `mma` or `gcmma` (mma.cpp). There is one such function per optimizer file;
/// optimizers.cpp holds the table. Each function checks the options of its optimizer.
/// @throws Error (input) for unknown options and for options out of range.
std::unique_ptr<Optimizer> make_mma(const Settings& settings);
/// Returns the optimizer `nlopt_mma` or `nlopt_ccsaq` (nlopt.cpp).
/// @throws Error (input) for unknown options and for options out of range.
std::unique_ptr<Optimizer> make_nlopt(const Settings& settings);
/// Returns the optimizer `ipopt` (ipopt.cpp).
/// @throws Error (input) for unknown options and for options out of range; Error (numerical) if MPI
///         does not start, see start_mpi_for_ipopt().
std::unique_ptr<Optimizer> make_ipopt(const Settings& settings);

/// Checks that the value of an option lies within its range.
/// @throws Error (input) unless low <= value <= high.
void check_option(const Settings& settings, const std::string& option, double value, double low,
                  double high);

}  // namespace flexmorph::optim
