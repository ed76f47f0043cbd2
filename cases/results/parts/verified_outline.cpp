#include "cases/results/parts/verified_outline.h"

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

std::vector<std::string> narrow_text(const VerifiedOutline& outline) {
  constexpr int kMaxListed = 4;
  std::vector<std::string> out;
  for (const bool solid : {true, false}) {
    std::string locations;
    int n = 0;
    for (const LengthScaleViolation& p : outline.narrow) {
      if (p.solid != solid || ++n > kMaxListed) continue;
      locations += (n == 1 ? ": " : ", ") + io::to_text(p.width, 3) + " m at (" +
                   io::to_text(p.center.x(), 4) + ", " + io::to_text(p.center.y(), 4) + ")";
    }
    if (n == 0) continue;
    const std::string which = n == 1 ? "one " : std::to_string(n) + " ";
    const std::string what =
        solid ? (n == 1 ? "location" : "locations") +
                    std::string(" with material narrower than 2 * design.min_thickness = ") +
                    io::to_text(outline.thickness, 3)
              : (n == 1 ? "gap" : "gaps") + std::string(" narrower than one cell, ") +
                    io::to_text(outline.cell, 3);
    out.push_back("The outline of body '" + outline.body + "' has " + which + what + " m" +
                  locations + (n > kMaxListed ? ", ..." : "") + ".");
  }
  return out;
}

std::string outline_text(const VerifiedOutline& outline, double crisp_compliance) {
  const std::string head = outline.body + ": ";
  if (!outline.verification) return head + "the outline was not verified: " + outline.why_not;
  const verification::OutlineVerification& j = *outline.verification;
  if (!std::isfinite(j.compliance))
    return head + "the body-fitted compliance is infinite, because load '" + j.unsupported_load +
           "' acts on material without a support";
  const double apart = 100 * (crisp_compliance / j.compliance - 1);
  std::string out =
      head + "body-fitted compliance " + io::to_text(j.compliance, 5) + " J (estimated error " +
      io::to_text(100 * j.error, 2) + " %), volume fraction " + io::to_text(outline.volume, 4) +
      "; compliance on the design mesh " + io::to_text(crisp_compliance, 5) + " J (" +
      io::to_text(std::abs(apart), 2) + (apart < 0 ? " % lower" : " % higher") +
      "); largest stress " + io::to_text(j.largest_stress, 4) + " Pa at (" +
      io::to_text(j.largest_at.x(), 4) + ", " + io::to_text(j.largest_at.y(), 4) + ") m";
  if (j.mesh_loads.empty())
    out += "; design.inp is not written, because springs support the far edge";
  if (j.n_omitted_regions > 0)
    out += "; connected regions without a support: " + std::to_string(j.n_omitted_regions) +
           " of " + std::to_string(j.n_connected_regions);
  return out;
}

}  // namespace flexmorph::cases
