#pragma once

#include <string>
#include <vector>

#include "cases/output/report.h"

namespace flexmorph::cases {

/// What a run has to say against its own results, in a sentence.
struct Warning {
  std::string words;
  bool unusable = false;  ///< nobody can use the result: it ends "done, not usable", kMissed
};

/// Designs in pieces or worse than none, bridged gaps, limits that are not kept; nearly singular
/// joints, energy that is missed.
std::vector<Warning> warnings_of(const Scene& scene, const RunReport& report);

/// On constraints generalized_alpha is stable for rho_inf < 1 - c h only, with c of the rates of
/// the motion (Arnold & Brüls 2007 assume rho_inf < 1): a free slider-crank with h = 1e-3 is lost
/// at 0.99, after 8 s.
bool damps_no_multipliers(const Scene& scene);
std::string undamped_words(const Scene& scene);
std::string alternation_words(const fem::Alternation& found);

bool usable(const std::vector<Warning>& warnings);
/// Status of a run that came to its end.
std::string done_words(const std::vector<Warning>& warnings);
/// ", 2 warnings"; nothing without any.
std::string counted(size_t n, const std::string& one, const std::string& many);

}  // namespace flexmorph::cases
