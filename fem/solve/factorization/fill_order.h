#pragma once

#include <span>
#include <vector>

namespace flexmorph::fem {

/// An order of little fill for the Cholesky factor of a symmetric matrix, in which groups ascend
/// (CAMD).
///
/// @param starts, neighbours  of every node those it shares an entry with, itself included,
///                            ascending: those of node k are from starts[k] to starts[k + 1]
/// @param groups  of every node, 0 ...
/// @returns nodes, the first to be eliminated first
/// @throws Error (numerical) when there is no memory for it.
///
/// Source: Amestoy, Davis, Duff (1996), SIAM J. Matrix Anal. Appl. 17, 886-905.
std::vector<int> fill_order(std::span<const int> starts, std::span<const int> neighbours,
                            std::span<const int> groups);

}  // namespace flexmorph::fem
