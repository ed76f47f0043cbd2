#include "cases/run/outline_verification.h"

#include <algorithm>

#include "cases/assembly/verified_loads.h"
#include "cases/output/outline_meshes.h"
#include "geometry/cpu_time.h"

namespace flexmorph::cases {
namespace {

/// Smallest accepted ratio of a width to the required width; it allows for round-off and for the
/// tolerance of the outline.
constexpr double kWidthTolerance = 0.99;

void find_narrow(const mmc::BodyProblem& problem, std::span<const Region> regions,
                 VerifiedOutline& out) {
  out.cell = std::min(problem.grid.dx(), problem.grid.dy());
  out.thickness =
      problem.widths.solid > 0 ? problem.widths.solid : 2 * problem.bands.back().min_half_thickness;
  // Neighbouring inscribed discs belong to one location; only the narrowest disc is kept.
  for (const LengthScaleViolation& p : mmc::length_scale_violations_of(
           problem, regions, kWidthTolerance * std::max(out.cell, out.thickness))) {
    const double wanted = p.solid ? out.thickness : out.cell;
    const bool known =
        std::any_of(out.narrow.begin(), out.narrow.end(), [&](const LengthScaleViolation& q) {
          return q.solid == p.solid && (q.center - p.center).norm() < 2 * wanted;
        });
    if (!known && p.width < kWidthTolerance * wanted) out.narrow.push_back(p);
  }
}

}  // namespace

VerifiedOutline verify_outline_of(const Scene& scene, const mmc::BodyProblem& problem,
                                  const fem::EslSets* loads,
                                  const std::function<bool()>& keep_running, RunFolder* folder) {
  VerifiedOutline out;
  out.body = problem.body;
  out.curve_tolerance = problem.export_tolerance;
  const double clock = thread_seconds();
  try {
    const std::vector<Region> regions = mmc::exported_regions(problem);
    find_narrow(problem, regions, out);
    if (loads != nullptr) out.why_not = mmc::reason_not_verifiable(problem);
    if (!out.why_not.empty()) return out;
    const verification::Loads by_position = loads != nullptr
                                                ? mmc::loads_by_position(problem, *loads)
                                                : loads_by_position(scene, problem);
    out.volume = area(regions) / area(mmc::domain_of(problem));
    out.verification = mmc::verify_design(problem, regions, by_position, keep_running);
    if (folder) write_outline_meshes(scene, problem, regions, *out.verification, *folder);
  } catch (const Error& error) {
    out.verification.reset();
    out.why_not = error.what();
  }
  out.seconds = thread_seconds() - clock;
  return out;
}

}  // namespace flexmorph::cases
