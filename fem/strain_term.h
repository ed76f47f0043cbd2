#pragma once

#include "fem/term.h"

namespace flexmorph::fem {

/// A term whose forces follow from strains and their rates, so that rigid motions cause no force.
/// Temperature acts on such terms (thermal/heated.h).
class StrainTerm : public Term {};

/// Interface of a term of a body with a temperature (Body::heat).
class HeatedTerm {
 public:
  virtual ~HeatedTerm() = default;
  /// Sets the temperature of the term to its value at time t [s].
  virtual void heat_to(double t) = 0;
  /// Returns the power that the change of temperature supplies to one element [W]. For an elastic
  /// term it is the rate of the energy at fixed unknowns and fixed lines; for a force without
  /// energy (damping) it is the dissipated power minus the power of the force on the unknowns.
  virtual double heat_power(int e, const Local& x) const = 0;
};

}  // namespace flexmorph::fem
