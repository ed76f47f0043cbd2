#pragma once

#include <functional>
#include <optional>
#include <string>

#include "cases/output/run_folder.h"
#include "optim/mmc/design_verification.h"

/// The judge's part of a run: its verdict on every final design, and its mesh for other programs.
namespace flexmorph::cases {

/// A final design as its outline says it is.
struct JudgedBody {
  std::string body;
  std::optional<verification::OutlineVerification> verdict;
  std::string why_not;              ///< where there is no verdict
  double volume = 0;                ///< part of the domain, of the outline
  double seconds = 0;               ///< CPU seconds, files included
  double cell = 0, thickness = 0;   ///< smallest gap and width that a part should have [m]
  std::vector<NarrowPlace> narrow;  ///< what is below, of the exported outline, narrowest first
};

/// "body 'beam', its outline: 3 places are narrower than ... m: 0.0014 m at (0.2, 0.1), ..." of its
/// material and of its gaps; none where there are none.
std::vector<std::string> narrow_words(const JudgedBody& judged);

/// Judges the design of a problem and writes design.inp, .msh, .geo and, where the scene wants
/// files for ParaView, .vtu. A judge that fails says why; the run goes on.
/// @param loads  of the motion; null: those of a plate at rest
/// @param go_on  asked on the way: a verdict of coarser meshes says how far it got
JudgedBody judge_body(const Scene& scene, const mmc::BodyProblem& problem,
                      const fem::EslSets* loads, const std::function<bool()>& go_on,
                      RunFolder& folder);

/// "beam: body-fitted compliance 75.1 (error below 0.3 %), by its cells 74.4: 0.9 % less; ..."
std::string judged_words(const JudgedBody& judged, double sharp_compliance);

}  // namespace flexmorph::cases
