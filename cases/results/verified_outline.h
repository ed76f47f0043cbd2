#pragma once

#include <optional>
#include <string>
#include <vector>

#include "optim/mmc/cycles/design_verification.h"

/// The verification of final designs by their outlines.
namespace flexmorph::cases {

/// The finite-element check of the exported outline of a final design.
struct VerifiedOutline {
  std::string body;
  std::optional<verification::OutlineVerification> verification;
  std::string why_not;              ///< where there is no verification
  double volume = 0;                ///< part of the domain that the outline covers [-]
  double curve_tolerance = 0;       ///< of its curves in design.dxf and design.step [m]
  double seconds = 0;               ///< CPU seconds, files included
  double cell = 0, thickness = 0;   ///< smallest gap and width that a part should have [m]
  std::vector<NarrowPlace> narrow;  ///< places of the outline below these, narrowest first
};

/// Sentences on places of material and on gaps that are too narrow; none where there are none.
std::vector<std::string> narrow_words(const VerifiedOutline& outline);

/// "beam: body-fitted compliance 75.1 (error about 0.3 %) ...; its cells say 74.4, 0.9 % less".
/// @param crisp_compliance  of the cells of the design [J]
std::string outline_words(const VerifiedOutline& outline, double crisp_compliance);

/// Von Mises stress at the nodes of the last mesh (n_nodes) [Pa].
std::vector<double> mises_of(const verification::OutlineVerification& verification);

}  // namespace flexmorph::cases
