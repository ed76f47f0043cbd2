#pragma once

namespace flexmorph::fem {

/// A range of plane vectors among the unknowns that all rotate by one angle.
struct TurnedVectors {
  /// Range of the unknowns, first to last - 1; every two consecutive ones are the entries of a
  /// vector.
  int first = 0, last = 0;
  /// Cosine and sine of the angle of rotation.
  double cosine = 1, sine = 0;
};

}  // namespace flexmorph::fem
