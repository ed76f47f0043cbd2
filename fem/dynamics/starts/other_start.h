#pragma once

#include <optional>

#include "fem/model/workspace.h"

namespace flexmorph::fem {

/// An assembled position that was found from other positions than the given ones.
struct OtherStart {
  State x;             ///< Assembled state.
  int tried = 0;       ///< Number of other starts.
  int assembled = 0;   ///< Number of starts that led to an assembled position.
  int assemblies = 0;  ///< Number of different assembled positions that were found.
};

/// Returns the number of starts that other_start() tries for a model.
int n_other_starts(const Model& model);

/// Looks for an assembled position of rigid bodies where the given positions do not lead to one:
/// the bodies are turned and moved by growing random amounts, which are the same in every run.
/// Bodies whose angle to the ground or to each other is prescribed keep this angle, because such
/// joints have false roots (an axis turned by 180 degrees). Of the assembled positions of the
/// smallest change of the start the one that is nearest to the given positions is returned; of two
/// that are equally near, the one whose bodies are turned counterclockwise.
/// @param guess  the given positions
/// @returns nothing if no start leads to an assembled position
std::optional<OtherStart> other_start(Workspace& model, const State& guess);

}  // namespace flexmorph::fem
