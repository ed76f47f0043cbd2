#include "optim/verdict.h"

#include <cmath>
#include <cstdio>

#include "optim/search.h"

namespace flexmorph::optim {
namespace {

std::string percent(double part) {
  char text[32];
  std::snprintf(text, sizeof text, "%.2g %%", 100 * part);
  return text;
}

}  // namespace

std::string plateau_text() {
  return "the objective fell by less than " + percent(Verdict::kPlateau) + " over " +
         std::to_string(Verdict::kPlateauRows) + " iterations";
}

std::string to_string(Verdict::Kind kind) {
  switch (kind) {
    case Verdict::Kind::evaluated:
      return "evaluated";
    case Verdict::Kind::unfinished:
      return "unfinished";
    case Verdict::Kind::stagnated:
      return "stagnated";
    case Verdict::Kind::converged:
      return "converged";
  }
  return "";
}

std::string text_of(const Verdict& verdict) {
  const std::string residual = "KKT residual " + scientific(verdict.kkt);
  std::string out = to_string(verdict.kind);
  switch (verdict.kind) {
    case Verdict::Kind::evaluated:
      return out + ": the design was not optimized, " + residual;
    case Verdict::Kind::converged:
      return out + ": " + residual;
    case Verdict::Kind::stagnated:
      return out + ": " + plateau_text() + ", " + residual;
    case Verdict::Kind::unfinished:
      break;
  }
  const std::string rows = std::to_string(Verdict::kImprovementRows) + " iterations";
  return out +
         (std::isnan(verdict.improvement)
              ? ": fewer than " + rows + " have a usable design, "
              : ": the objective fell by " + percent(verdict.improvement) + " over the last " +
                    rows + ", ") +
         residual;
}

}  // namespace flexmorph::optim
