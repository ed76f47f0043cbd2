#pragma once

#include "optim/mmc/under_repair.h"

namespace flexmorph::mmc {

/// Makes one component of two that lie end to end, over and over: chains of short ones have
/// scalloped outlines, and a narrow place at every joint. Compliance times volume may rise by
/// half a hundredth in all; what is optimized from there shapes it anew.
/// @return how many went
int join_parts(UnderRepair& design);

/// Puts bars of the least thickness across the void where they lessen compliance times volume, one
/// after the other. Between points i and j of the design a bar of cross section A gives way to the
/// displacements u that are there: to first order (the topological derivative of a ground
/// structure)
///
///   dC = - Σ w_l E A / L (e · (u_j - u_i))²,   e from i to j, L their distance, over all loads l.
///
/// The bars that promise most for their volume are tried.
/// @return how many were put there
int bear_parts(UnderRepair& design);

}  // namespace flexmorph::mmc
