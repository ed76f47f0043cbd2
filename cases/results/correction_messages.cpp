#include "cases/results/correction_messages.h"

#include <numbers>

#include "io/files.h"

namespace flexmorph::cases {
namespace {

double degrees(double angle) { return angle * 180 / std::numbers::pi; }

}  // namespace

namespace {

std::string certified_text(const mmc::CertifiedDesign& d, double move_limit) {
  return io::to_text(d.value, 5) + ", KKT residual " + io::to_text(d.kkt, 3) +
         ", angle between the gradients of motion and loads " + io::to_text(degrees(d.angle), 3) +
         " degrees, predicted decrease at most " + io::to_text(100 * d.left, 3) +
         " % within a move limit of " + io::to_text(move_limit, 3) +
         ", largest violation of a limit " + io::to_text(d.violation, 2);
}

}  // namespace

std::string certificate_text(const mmc::OptimalityCertificate& c) {
  return c.objective +
         " of the regularized design: " + certified_text(c.regularized, c.move_limit) + ". " +
         c.objective + " of the crisp design: " + certified_text(c.crisp, c.move_limit);
}

std::string corrected_text(const mmc::CorrectedCycle& c) {
  std::string out = "corrected cycle " + std::to_string(c.cycle) +
                    ": J = " + io::to_text(c.value, 6) + ", KKT residual " + io::to_text(c.kkt, 3);
  if (c.cycle == 0)
    return out + ", angle between the gradients of motion and loads " +
           io::to_text(degrees(c.angle), 3) + " degrees";
  if (c.predicted != 0)
    out += ", trust region " + io::to_text(c.radius, 3) + ", predicted decrease " +
           io::to_text(100 * c.predicted, 3) + " %, actual decrease " +
           io::to_text(100 * c.actual, 3) + " %";
  return out + (c.accepted ? "" : ", design rejected");
}

std::string corrected_text(const CorrectedMotion& c) {
  return "J of the crisp outlines on the design mesh of the case is " + io::to_text(c.after, 6) +
         " after the corrected cycles and " + io::to_text(c.before, 6) + " before them" +
         (c.improves() ? "" : ". The designs before the corrected cycles are kept");
}

}  // namespace flexmorph::cases
