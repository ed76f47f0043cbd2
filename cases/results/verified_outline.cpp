#include "cases/results/verified_outline.h"

#include <cmath>

#include "fem/triangles/t6.h"
#include "io/files.h"

namespace flexmorph::cases {

std::vector<double> mises_of(const verification::OutlineVerification& verification) {
  std::vector<double> out(verification.mesh.points.size());
  for (std::size_t k = 0; k < out.size(); ++k)
    out[k] = fem::von_mises(verification.stress.col(static_cast<Eigen::Index>(k)));
  return out;
}

std::vector<std::string> narrow_words(const VerifiedOutline& outline) {
  constexpr int kNamed = 4;
  std::vector<std::string> out;
  for (const bool solid : {true, false}) {
    std::string places;
    int n = 0;
    for (const NarrowPlace& p : outline.narrow) {
      if (p.solid != solid || ++n > kNamed) continue;
      places += (n == 1 ? ": " : ", ") + io::to_text(p.width, 3) + " m at (" +
                io::to_text(p.center.x(), 4) + ", " + io::to_text(p.center.y(), 4) + ")";
    }
    if (n == 0) continue;
    const std::string which = n == 1 ? "one " : std::to_string(n) + " ";
    const std::string what =
        solid ? (n == 1 ? "place is" : "places are") +
                    std::string(" narrower than twice design.min_thickness, ") +
                    io::to_text(outline.thickness, 3)
              : (n == 1 ? "gap is" : "gaps are") + std::string(" narrower than a cell, ") +
                    io::to_text(outline.cell, 3);
    out.push_back("body '" + outline.body + "', its outline: " + which + what + " m" + places +
                  (n > kNamed ? ", ..." : ""));
  }
  return out;
}

std::string outline_words(const VerifiedOutline& outline, double crisp_compliance) {
  const std::string head = outline.body + ": ";
  if (!outline.verification) return head + "no body-fitted compliance: " + outline.why_not;
  const verification::OutlineVerification& j = *outline.verification;
  if (!std::isfinite(j.compliance))
    return head + "body-fitted compliance infinite: load '" + j.unsupported_load +
           "' acts on nothing that is held";
  const double apart = 100 * (crisp_compliance / j.compliance - 1);
  std::string out =
      head + "body-fitted compliance " + io::to_text(j.compliance, 5) + " (error about " +
      io::to_text(100 * j.error, 2) + " %) at volume " + io::to_text(outline.volume, 4) +
      "; its cells say " + io::to_text(crisp_compliance, 5) + ", " +
      io::to_text(std::abs(apart), 2) + (apart < 0 ? " % less" : " % more") + "; largest stress " +
      io::to_text(j.largest_stress, 4) + " Pa at (" + io::to_text(j.largest_at.x(), 4) + ", " +
      io::to_text(j.largest_at.y(), 4) + ") m";
  if (j.mesh_loads.empty()) out += "; springs hold its far edge, so there is no design.inp";
  if (j.n_omitted_pieces > 0)
    out += "; " + std::to_string(j.n_omitted_pieces) + " of " + std::to_string(j.n_pieces) +
           " pieces are held by nothing";
  return out;
}

}  // namespace flexmorph::cases
