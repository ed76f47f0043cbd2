#pragma once

#include "cases/results/run_result.h"
#include "cases/scene/scene.h"

/// What a run says against its own results.
namespace flexmorph::cases {

/// Finds designs in pieces or worse than uniform material, bridged gaps, limits that are violated,
/// nearly singular joints, energy that is lost or gained, and changes of a mesh that move more than
/// 5 % of the largest strain energy.
std::vector<Warning> warnings_of(const Scene& scene, const RunResult& result);

/// Tells whether the integrator hardly damps multipliers. With constraints, generalized_alpha is
/// stable for rho_inf < 1 - c h only, with c of the rates of the motion (Arnold & Brüls 2007 assume
/// rho_inf < 1): a free slider-crank with h = 1e-3 is lost at 0.99, after 8 s.
bool damps_no_multipliers(const Scene& scene);
/// Says that the integrator hardly damps multipliers, and what helps.
std::string undamped_words(const Scene& scene);
/// Says since when and by how much the multipliers of a joint alternate.
std::string alternation_words(const fem::Alternation& found);

/// Tells whether no warning makes the result unusable.
bool usable(const std::vector<Warning>& warnings);
/// Status of a run that came to its end.
std::string done_words(const std::vector<Warning>& warnings);
/// ", 2 warnings"; empty for n = 0.
std::string counted(size_t n, const std::string& one, const std::string& many);

}  // namespace flexmorph::cases
