#pragma once

#include "fem/term.h"

namespace flexmorph::fem {

/// A term whose forces come from strains, and from their rates: it does not see rigid motions. Heat
/// acts on such terms (thermal/heated.h).
class StrainTerm : public Term {
 public:
  /// Puts a term of a hot body (Body::heat) where its temperature is at time t.
  virtual void heat_to(double /*t*/) {}
  /// Power that the temperature gives to one element [W]: the rate of the term's energy at fixed
  /// unknowns and fixed lines, and for a force without energy what its work on them is short of.
  virtual double heat_power(int, const Local&) const { return 0; }
};

}  // namespace flexmorph::fem
