#pragma once

#include "fem/term.h"

/// Sections of the small models of tests. They are thinner or softer than real plates, so that
/// nonlinear terms matter.
namespace flexmorph::fem {

/// A section of 0.01 m x 1e8 Pa.
inline const PlaneSection kThinSection{0.01, 1e8, 0.3, 2700};
/// A section of 0.03 m x 1e8 Pa.
inline const PlaneSection kThickSection{0.03, 1e8, 0.3, 2700};
/// A section of 0.03 m x 1e6 Pa.
inline const PlaneSection kSoftSection{0.03, 1e6, 0.3, 2700};
/// A beam's section of 0.05 m x 2e8 Pa.
inline const PlaneSection kBeamSection{0.05, 2e8, 0.3, 7200};

}  // namespace flexmorph::fem
