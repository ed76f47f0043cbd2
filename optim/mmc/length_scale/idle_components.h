#pragma once

#include <functional>
#include <vector>

#include "optim/mmc/problem/body_problem.h"

namespace flexmorph::mmc {

/// Removes the components of a crisp design that carry nothing: what a component covers alone has
/// less than a fifth of the mean strain energy, compliance times volume does not rise without it,
/// and what held together still does. Components of symmetric designs go with their images.
/// @param keeps_width  nothing goes whose removal makes material or gaps narrower than asked for
///                     that were not before: no stage comes that widens them
/// @param go_on  asked before every trial; false ends the search. Empty: it goes on
/// @return places of the removed components in the list, in rising order
/// @throws Error (numerical) from statics and from unite().
std::vector<int> remove_idle(const BodyProblem& problem, ComplianceEvaluator& loads, Design& design,
                             bool keeps_width = false, const std::function<bool()>& go_on = {});

}  // namespace flexmorph::mmc
