#include "cases/results/correction_messages.h"

#include <numbers>

#include "io/files.h"

namespace flexmorph::cases {
namespace {

double degrees(double angle) { return angle * 180 / std::numbers::pi; }

}  // namespace

namespace {

std::string certified_words(const mmc::CertifiedDesign& d, double move_limit) {
  return io::to_text(d.value, 5) + ", KKT residual " + io::to_text(d.kkt, 3) +
         ", gradients of motion and loads " + io::to_text(degrees(d.angle), 3) +
         " degrees apart, at most " + io::to_text(100 * d.left, 3) + " % left within a move of " +
         io::to_text(move_limit, 3) + ", largest violation of a limit " +
         io::to_text(d.violation, 2);
}

}  // namespace

std::string certificate_words(const mmc::MotionCertificate& c) {
  return c.objective + " of the regularized design " +
         certified_words(c.regularized, c.move_limit) + "; of the crisp design " +
         certified_words(c.crisp, c.move_limit);
}

std::string corrected_words(const mmc::CorrectedCycle& c) {
  std::string out = "cycle " + std::to_string(c.cycle) + " of the motion: J " +
                    io::to_text(c.value, 6) + ", KKT residual " + io::to_text(c.kkt, 3);
  if (c.cycle == 0)
    return out + ", gradients of motion and loads " + io::to_text(degrees(c.angle), 3) +
           " degrees apart";
  if (c.predicted != 0)
    out += ", within " + io::to_text(c.radius, 3) + " predicted " +
           io::to_text(100 * c.predicted, 3) + " % less, found " + io::to_text(100 * c.actual, 3) +
           " %";
  return out + (c.accepted ? "" : ", not taken");
}

std::string corrected_words(const CorrectedMotion& c) {
  return "corrected, J of the outlines on the cells of the case is " + io::to_text(c.after, 6) +
         " instead of " + io::to_text(c.before, 6) +
         (c.improves() ? "" : ": no less, the designs for loads are kept");
}

}  // namespace flexmorph::cases
