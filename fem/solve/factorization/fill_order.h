#pragma once

#include <span>
#include <vector>

namespace flexmorph::fem {

/// Returns an elimination order with little fill for the Cholesky factor of a symmetric matrix
/// (CAMD), in which the group numbers ascend.
///
/// @param starts, neighbours  for every node, the nodes it shares an entry with, itself included,
///     ascending; the list of node k begins at starts[k] and ends before starts[k + 1]
/// @param groups  group of every node, 0 ...
/// @returns nodes, the first to be eliminated first
/// @throws Error (numerical) when there is not enough memory.
///
/// Source: Amestoy, Davis, Duff (1996), SIAM J. Matrix Anal. Appl. 17, 886-905.
std::vector<int> fill_order(std::span<const int> starts, std::span<const int> neighbours,
                            std::span<const int> groups);

}  // namespace flexmorph::fem
