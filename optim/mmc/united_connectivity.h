#pragma once

#include <span>

#include "optim/mmc/body_problem.h"

namespace flexmorph::mmc {

/// connectivity_of() of a design: pieces are counted on its union, which its cells may fuse or
/// lose. Where the outlines cannot be united, by its cells. @param fractions  of true material
/// (n_cells)
Connectivity united_connectivity(const BodyProblem& problem, std::span<const Component> components,
                                 const VectorXd& fractions);

}  // namespace flexmorph::mmc
