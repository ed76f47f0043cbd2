#pragma once

namespace flexmorph::fem {

/// Unknowns first, first + 1, ... last - 1, two at a time the entries of vectors in the plane, all
/// of which turn by one angle.
struct TurnedVectors {
  int first = 0, last = 0;
  double cosine = 1, sine = 0;
};

}  // namespace flexmorph::fem
