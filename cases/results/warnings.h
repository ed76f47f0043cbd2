#pragma once

#include "cases/results/run_result.h"
#include "cases/scene/scene.h"

/// Warnings of a run about its own results.
namespace flexmorph::cases {

/// Returns the warnings about a result. They report designs that are not connected or worse than
/// uniform material, gaps that are bridged by partly filled cells, violated limits, nearly singular
/// joints, energy that is lost or gained, and mesh changes that change the strain energy by more
/// than 5 % of its largest value.
std::vector<Warning> warnings_of(const Scene& scene, const RunResult& result);

/// Returns notes about a result that need no correction: widths of solid regions and of the domain
/// that are smaller than the required ones.
std::vector<std::string> notes_of(const RunResult& result);

/// Tells whether the integrator hardly damps Lagrange multipliers. With constraints,
/// generalized_alpha is stable only for rho_inf < 1 - c h, where c depends on the rates of the
/// motion (Arnold & Brüls 2007 assume rho_inf < 1). For example, a free slider-crank with h = 1e-3
/// s becomes unstable at rho_inf = 0.99 after 8 s.
bool damps_no_multipliers(const Scene& scene);
/// Returns the message that the integrator hardly damps multipliers, with a remedy.
std::string undamped_text(const Scene& scene);
/// Returns a message on the alternating force of a joint: since when, and by which amplitude.
std::string alternation_text(const fem::Alternation& found);

/// Tells whether none of the warnings makes the result unusable.
bool usable(const std::vector<Warning>& warnings);
/// Returns the status of a complete run: "done" or "done, not usable".
std::string done_text(const std::vector<Warning>& warnings);
/// Returns a count for messages, ", 2 warnings"; empty for n = 0.
/// @param one   noun for n = 1
/// @param many  noun for n > 1
std::string counted(size_t n, const std::string& one, const std::string& many);

}  // namespace flexmorph::cases
