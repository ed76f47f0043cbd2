#pragma once

#include <functional>
#include <vector>

#include "optim/mmc/problem/body_problem.h"

namespace flexmorph::mmc {

/// Removes unloaded components from a crisp design. A component is removed if three conditions
/// hold: the material that it covers alone has less than a fifth of the mean strain energy per
/// area, the product of compliance and volume does not rise without it, and no connection is lost.
/// Components of symmetric designs are removed together with their images.
/// @param keeps_width  true if no removal may reduce the smallest width of material or of gaps
///                     below the smaller one of its present and its required value, because no
///                     later stage would restore it
/// @param keep_running  cancellation callback, called before every trial; false ends the search. An
/// empty
///               callback lets the search continue
/// @return indices of the removed components in the list, ascending
/// @throws Error (numerical) from statics and from unite().
std::vector<int> remove_unloaded_components(const BodyProblem& problem, ComplianceEvaluator& loads,
                                            Design& design, bool keeps_width = false,
                                            const std::function<bool()>& keep_running = {});

}  // namespace flexmorph::mmc
