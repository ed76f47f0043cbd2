#pragma once

#include <optional>
#include <string>
#include <vector>

#include "optim/mmc/cycles/design_verification.h"

/// The verification of final designs by their outlines.
namespace flexmorph::cases {

/// The finite-element check of the exported outline of a final design.
struct VerifiedOutline {
  std::string body;  ///< Name of the body.

  /// Result of the finite-element verification; absent if there is none.
  std::optional<verification::OutlineVerification> verification;

  std::string why_not;             ///< Reason if there is no verification.
  double volume = 0;               ///< Fraction of the domain that the outline covers [-].
  double curve_tolerance = 0;      ///< Tolerance of the curves in design.dxf and design.step [m].
  double seconds = 0;              ///< CPU time, including the time for writing files [s].
  double cell = 0, thickness = 0;  ///< Required smallest gap, and smallest width of material [m].

  /// Violations of the minimum length scale: locations of the outline where a gap is narrower than
  /// `cell` or material narrower than `thickness`, narrowest first.
  std::vector<LengthScaleViolation> narrow;
};

/// Returns messages on locations where material or a gap is too narrow; none if there are no such
/// locations.
std::vector<std::string> narrow_text(const VerifiedOutline& outline);

/// Returns a message on the verification of an outline: "beam: body-fitted compliance 75.1 J
/// (estimated error 0.3 %), ...; compliance on the design mesh 74.4 J (0.9 % lower); ...".
/// @param crisp_compliance  compliance of the cells of the crisp design [J]
std::string outline_text(const VerifiedOutline& outline, double crisp_compliance);

/// Returns the von Mises stress at the nodes of the last mesh (n_nodes) [Pa].
std::vector<double> mises_of(const verification::OutlineVerification& verification);

}  // namespace flexmorph::cases
