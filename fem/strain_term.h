#pragma once

#include "fem/term.h"

namespace flexmorph::fem {

/// A term whose forces come from strains, and from their rates: it does not see rigid motions. Heat
/// acts on such terms (thermal/heated.h).
class StrainTerm : public Term {};

/// A term of a hot body (Body::heat).
class HeatedTerm {
 public:
  virtual ~HeatedTerm() = default;
  /// Puts the term where its temperature is at time t.
  virtual void heat_to(double t) = 0;
  /// Returns the power that the temperature gives to one element [W]: the rate of the term's energy
  /// at fixed unknowns and fixed lines, and for a force without energy what its work on them is
  /// short of.
  virtual double heat_power(int e, const Local& x) const = 0;
};

}  // namespace flexmorph::fem
