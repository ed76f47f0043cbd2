#include "cases/results/summary.h"

#include <cmath>

#include "io/files.h"

namespace flexmorph::cases {
namespace {

/// Returns a message on the mass of all designs, or on their volume fractions if they have no
/// density.
std::string mass_text(const DesignResult& design) {
  const double mass = mass_of(design);
  if (mass > 0) return "mass " + io::to_text(mass, 4) + " kg";
  std::string volumes;
  for (const mmc::BodyOutcome& outcome : design.outcomes)
    volumes +=
        (volumes.empty() ? "volume fraction " : " and ") + io::to_text(outcome.crisp.volume, 4);
  return volumes;
}

/// Returns a message that compares the designs with uniform material.
std::string gain_text(const RunResult& result) {
  const std::optional<Gain> gain = gain_of(result);
  if (!gain) return "";
  return gain->quantity + " " + io::to_text(std::abs(100 * gain->change()), 3) +
         (gain->change() < 0 ? " % below" : " % above") + " uniform material of equal mass";
}

std::string verdict_text(const DesignResult& design) {
  std::string out;
  for (const mmc::BodyOutcome& outcome : design.outcomes)
    out += (out.empty() ? "" : ", ") +
           (design.outcomes.size() > 1 ? "'" + outcome.body + "' " : std::string()) +
           optim::to_string(outcome.verdict.kind);
  return out;
}

}  // namespace

namespace {

/// Returns the statistics of a column in the motions by which designs are assessed; nothing if a
/// motion is missing or does not have the column.
std::optional<PointVariation> column_variation(const MotionResults& motions,
                                               const std::string& column, const std::string& name) {
  const auto of = [&](const std::optional<MotionRecord>& motion) -> std::optional<Variation> {
    const std::vector<double>* values = motion ? motion->table.find(column) : nullptr;
    if (!values || values->size() < 2) return {};
    return variation_of(motion->time(), *values);
  };
  const std::optional<Variation> designed = of(motions.assessed()),
                                 uniform = of(motions.assessed_uniform());
  if (!designed || !uniform) return {};
  return PointVariation{name, *designed, *uniform};
}

}  // namespace

double mass_of(const DesignResult& design) {
  double out = 0;
  for (const mmc::BodyProblem& problem : design.problems)
    for (const mmc::BodyOutcome& outcome : design.outcomes)
      if (outcome.body == problem.body) out += mmc::part_mass_of(problem, outcome.crisp.volume);
  return out;
}

std::optional<Gain> gain_of(const RunResult& result) {
  const std::optional<MotionRecord>&motion = result.motions.assessed(),
        &uniform = result.motions.assessed_uniform();
  if (motion && uniform && !result.design.outcomes.empty())
    return Gain{"time integral of the strain energy", motion->strain_integral(),
                uniform->strain_integral(), "J s"};
  Gain out{"compliance"};
  for (const mmc::BodyOutcome& outcome : result.design.outcomes) {
    out.designed += outcome.crisp.compliance;
    out.uniform += outcome.uniform_compliance;
  }
  if (!(out.uniform > 0)) return {};
  return out;
}

std::optional<PointVariation> tip_variation(const MotionResults& motions, const std::string& body) {
  return column_variation(motions, body + kDeflectionEnding, "");
}

std::vector<PointVariation> point_variations(const MotionResults& motions,
                                             const std::string& body) {
  std::vector<PointVariation> out;
  if (!motions.assessed()) return out;
  const Series& table = motions.assessed()->table;
  for (const size_t c : table.of_group(ColumnGroup::across)) {
    const std::string& column = table.columns[c].name;
    if (!column.starts_with(body + ".")) continue;
    const size_t begin = body.size() + 1;
    const std::string name = column.substr(begin, column.size() - begin - kAcrossEnding.size());
    if (const auto found = column_variation(motions, column, name)) out.push_back(*found);
  }
  return out;
}

std::string summary_text(const RunResult& result) {
  std::string out;
  const auto add = [&](const std::string& words) {
    if (!words.empty()) out += words + ", ";
  };
  if (!result.design.outcomes.empty()) {
    add(mass_text(result.design));
    add(gain_text(result));
    add(verdict_text(result.design));
  }
  return out + io::to_text(result.info.seconds_wall, 3) + " s";
}

}  // namespace flexmorph::cases
