#include "cases/check/static_nodes.h"

#include "cases/assembly/static_conditions.h"
#include "cases/check/plausibility.h"
#include "io/files.h"

namespace flexmorph::cases {
namespace {

std::string point_text(const Vec2& p) {
  return "(" + io::to_text(p.x(), 4) + ", " + io::to_text(p.y(), 4) + ")";
}

}  // namespace

std::string static_nodes_text(const Scene& scene, const mmc::BodyProblem& problem) {
  std::string out;
  for (const LocatedNodes& found : located_nodes(scene, problem.grid, problem.outside)) {
    const bool one = found.count == 1;
    out += summary_row(found.what,
                       io::to_text(found.count) + (one ? " node at " : " nodes from ") +
                           point_text(found.extent.lower) +
                           (one ? std::string() : " to " + point_text(found.extent.upper)) + " m");
  }
  return out;
}

std::string drawing_text(const Domain& domain) {
  if (!domain.is_drawn) return "";
  const Vec2 size = domain.bounds.upper - domain.bounds.lower;
  const size_t holes = domain.shape.holes.size();
  return summary_row("drawing", io::to_text(size.x(), 6) + " x " + io::to_text(size.y(), 6) +
                                    " m, lower left corner at " + point_text(domain.bounds.lower) +
                                    " m, " + std::to_string(holes) +
                                    (holes == 1 ? " hole" : " holes"));
}

}  // namespace flexmorph::cases
