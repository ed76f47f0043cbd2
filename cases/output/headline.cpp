#include "cases/output/headline.h"

#include <algorithm>
#include <cmath>

#include "cases/results/schema.h"
#include "cases/results/summary.h"
#include "io/files.h"

namespace flexmorph::cases {
namespace {

/// Returns the number with its unit, with four significant digits.
std::string with_unit(double value, const char* unit) { return io::to_text(value, 4) + " " + unit; }

/// Returns a length or a stress with four significant digits and the prefix of the unit for which
/// the number is between 1 and 1000: "2.947 MPa", "1.341 mm".
std::string with_prefix(double value, const std::string& unit) {
  struct Prefix {
    const char* letter;
    double size;
  };
  static constexpr Prefix kPrefixes[] = {{"G", 1e9}, {"M", 1e6},  {"k", 1e3},
                                         {"", 1},    {"m", 1e-3}, {"µ", 1e-6}};
  for (const Prefix& p : kPrefixes)
    if (std::abs(value) >= p.size) return io::to_text(value / p.size, 4) + " " + p.letter + unit;
  return io::to_text(value, 4) + " " + unit;
}

/// Returns the sentence of a quantity of the result schema.
template <class Source>
std::string meaning_of(std::span<const ResultQuantity<Source>> table, std::string_view name) {
  for (const ResultQuantity<Source>& q : table)
    if (q.name == name) return q.meaning;
  return "";
}

std::string verdict_of(const DesignResult& design) {
  std::string out;
  for (const mmc::BodyOutcome& outcome : design.outcomes) {
    const std::string word = optim::to_string(outcome.verdict.kind);
    if (out.find(word) == std::string::npos) out += (out.empty() ? "" : ", ") + word;
  }
  return out;
}

/// Returns the outcome whose optimization is the farthest from its end.
const mmc::BodyOutcome& least_finished(const DesignResult& design) {
  return *std::min_element(design.outcomes.begin(), design.outcomes.end(),
                           [](const mmc::BodyOutcome& a, const mmc::BodyOutcome& b) {
                             return a.verdict.kind < b.verdict.kind;
                           });
}

/// Returns sentences that explain the verdict on a design: its state, the reason why the optimizer
/// stopped, and the number of cycles.
std::string verdict_note(const Scene& scene, const RunResult& result) {
  using Kind = optim::Verdict::Kind;
  const mmc::BodyOutcome& o = least_finished(result.design);
  const std::string subject =
      result.design.outcomes.size() > 1 ? "The design of '" + o.body + "' " : "The design ";
  if (o.verdict.kind == Kind::evaluated) return subject + "was evaluated; nothing was optimized.";
  std::string out;
  if (o.verdict.kind != Kind::unfinished)
    out = subject + "is finished: " + optim::text_of(o.verdict) + ".";
  else if (o.stop.starts_with("interrupted"))
    out = subject + "is not finished: " + o.stop + ".";
  else
    out = subject + "is not finished. The optimizer stopped for this reason: " + o.stop + ".";
  if (scene.domain || scene.cycle.max_cycles == 1) return out;
  const std::string cycles = io::to_text(result.design.cycles);
  return out + (result.info.status.starts_with("done")
                    ? " It is the best of " + cycles + (cycles == "1" ? " cycle." : " cycles.")
                    : " This is cycle " + cycles + " of at most " +
                          io::to_text(scene.cycle.max_cycles) + ".");
}

PageFact gain_fact(const Gain& gain) {
  const double percent = 100 * std::abs(gain.change());
  const bool less = gain.change() < 0;
  return {less ? "Gain" : "Loss", io::to_text(percent, 3) + (less ? " % less" : " % more"),
          gain.quantity + ": " + io::to_text(gain.designed, 4) + " " + gain.unit +
              ", uniform material " + io::to_text(gain.uniform, 4) + " " + gain.unit,
          "Change of the " + gain.quantity +
              " from uniform material of equal mass to the design; less is better."};
}

/// Returns the largest displacement of all designs under one load.
std::optional<PageFact> displacement_fact(const RunResult& result, const RunFolder& folder) {
  std::optional<PageFact> out;
  double largest = 0;
  for (const VerifiedOutline& outline : result.design.outlines) {
    if (!outline.verification) continue;
    const std::vector<double>& all = outline.verification->largest_displacements;
    for (size_t l = 0; l < all.size(); ++l)
      if (all[l] > largest) {
        largest = all[l];
        out = {"Largest displacement", with_prefix(all[l], "m"),
               outline.body + ": " + load_name(result, folder, outline.body, l),
               "Largest displacement of the exported outline under one of its static loads."};
      }
  }
  return out;
}

std::optional<PageFact> stress_fact(const RunResult& result, const RunFolder& folder) {
  std::optional<PageFact> out;
  double largest = 0;
  for (const VerifiedOutline& outline : result.design.outlines) {
    if (!outline.verification || !(outline.verification->largest_stress > largest)) continue;
    const verification::OutlineVerification& v = *outline.verification;
    largest = v.largest_stress;
    out = {"Largest stress", with_prefix(v.largest_stress, "Pa"),
           outline.body + " at (" + io::to_text(v.largest_at.x(), 3) + ", " +
               io::to_text(v.largest_at.y(), 3) + ") m: " +
               load_name(result, folder, outline.body, static_cast<size_t>(v.largest_load)),
           meaning_of(outline_quantities(), "largest_stress")};
  }
  return out;
}

void add_motion_facts(const MotionRecord& motion, std::vector<PageFact>& out) {
  out.push_back({"Time span", with_unit(motion.time().back(), "s"),
                 io::to_text(motion.result.counts.steps) + " time steps", ""});
  for (const size_t c : motion.table.of_group(ColumnGroup::deflection))
    out.push_back({"Largest deflection", with_unit(largest_size(motion.table.values[c]), "m"),
                   motion.table.columns[c].name, motion.table.columns[c].meaning});
  out.push_back({"Largest strain energy",
                 with_unit(largest_size(motion.table.at(kStrainColumn)), "J"), "", ""});
  out.push_back({"Energy error", io::to_text(motion.result.energy_error, 3), "",
                 meaning_of(motion_quantities(), "energy_error")});
}

}  // namespace

std::string load_name(const RunResult& result, const RunFolder& folder, const std::string& body,
                      size_t load) {
  for (const RunFolder::LoadSets& sets : folder.load_sets())
    if (sets.body == body && load < sets.time.size())
      return "load " + io::to_text(static_cast<int>(load) + 1) +
             ", t = " + io::to_text(sets.time[load], 4) + " s";
  if (load < result.design.static_loads.size())
    return "load '" + result.design.static_loads[load].name + "'";
  return "load " + io::to_text(static_cast<int>(load) + 1);
}

std::vector<PageFact> headline(const Scene& scene, const RunResult& result,
                               const RunFolder& folder) {
  std::vector<PageFact> out;
  const DesignResult& design = result.design;
  if (!design.outcomes.empty()) {
    out.push_back({"Verdict", verdict_of(design), verdict_note(scene, result),
                   meaning_of(design_quantities(), "verdict")});
    if (const double mass = mass_of(design); mass > 0)
      out.push_back({"Mass", with_unit(mass, "kg"),
                     design.outcomes.size() > 1 ? "of all designed bodies"
                                                : "of '" + design.outcomes.front().body + "'",
                     "Mass of the crisp designs, without point masses and pins."});
    else
      out.push_back({"Volume fraction", io::to_text(design.outcomes.front().crisp.volume, 4), "",
                     meaning_of(design_quantities(), "crisp_volume")});
    if (const std::optional<Gain> gain = gain_of(result)) out.push_back(gain_fact(*gain));
    if (const auto fact = displacement_fact(result, folder)) out.push_back(*fact);
    if (const auto fact = stress_fact(result, folder)) out.push_back(*fact);
  } else if (result.motions.motion && result.motions.motion->table.n_rows() > 0) {
    add_motion_facts(*result.motions.motion, out);
  } else if (result.path && result.path->table.n_rows() > 0 && scene.statics) {
    for (const ResultQuantity<PathRecord>& q : path_quantities())
      if (const std::string name = q.name; name == "load_factor" || name == "strain_energy")
        out.push_back({name == "load_factor" ? "Load factor" : "Strain energy",
                       io::to_text(std::get<double>(q.value(*result.path)), 4) +
                           (std::string(q.unit) == "-" ? "" : std::string(" ") + q.unit),
                       "", q.meaning});
  }
  out.push_back({"Time", io::to_text(result.info.seconds_wall, 3) + " s",
                 io::to_text(result.info.seconds_cpu, 3) + " s CPU time", ""});
  return out;
}

}  // namespace flexmorph::cases
