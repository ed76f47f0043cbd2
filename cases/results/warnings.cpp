#include "cases/results/warnings.h"

#include <algorithm>
#include <cmath>
#include <span>

#include "cases/assembly/build.h"
#include "cases/assembly/static_conditions.h"
#include "cases/results/part_checks.h"
#include "io/files.h"
#include "optim/mmc/cycles/usability.h"

namespace flexmorph::cases {
namespace {

using Warnings = std::vector<Warning>;

// Thresholds of warnings: the energy change by the time integration, the error of the energy
// balance (both relative to the largest energy), the strain energy change by a mesh change
// (relative to the largest strain energy), and the difference of crisp and body-fitted compliance.
constexpr double kLargestLoss = 0.01;
constexpr double kLargestDefect = 0.1;
constexpr double kLargestMove = 0.05;
constexpr double kCellsApart = 0.02;
// Threshold of the ratio of the compliances of the regularized and the crisp design. The ratio is
// about 2 for the start of a design; at 10 the heavy, soft edges of the design dominate.
constexpr double kHangingMass = 10;

/// Largest fraction of a force that may act on void in a usable design [-].
constexpr double kLargestPartOnVoid = 0.05;

/// Adds warnings about the limits that the crisp design violates. Limits that several bodies share
/// are skipped.
void add_limits(const mmc::BodyProblem& p, const mmc::BodyOutcome& o, Warnings& out) {
  for (const mmc::Limit& limit : p.goal.limits) {
    if (!mmc::binds_body(limit, p)) continue;
    const double found = mmc::crisp_value(*limit.row, p.goal, o.sharp);
    if (!(limit.excess(found) > mmc::kLimitTolerance)) continue;
    out.push_back(
        {"body '" + o.body + "': the " + std::string(limit.row->words) + " " +
             io::to_text(found, 4) +
             (limit.at_least ? " is below what is wanted, " : " is above what is allowed, ") +
             io::to_text(limit.value, 4) +
             (o.iterations > 0 ? ": no design that was found keeps to it" : "") +
             (limit.wants_material()
                  ? "; the full design has " + io::to_text(o.full.at(mmc::key_of(*limit.row)), 4)
                  : std::string()),
         true});
  }
}

/// Tells whether the error of the energy balance is so large that the motion is not reliable.
bool misses_energy(const Scene& scene, const MotionRecord& motion) {
  return motion.result.energy_defect > kLargestDefect &&
         largest_size(motion.table.at(kDefectColumn)) > stress_round_off(scene);
}

/// Tells whether a design has to satisfy the limits of the case, because it was optimized, is a
/// part, or is given by the case. The default initial layout of components need not satisfy them.
bool is_judged(const Scene& scene, const mmc::BodyOutcome& o) {
  return o.iterations > 0 || o.of_part ||
         std::any_of(scene.designs.begin(), scene.designs.end(),
                     [&](const BodyDesign& d) { return d.body == o.body && !d.start.empty(); });
}

/// Adds a warning if the compliance of a design is larger than that of uniform material of the same
/// volume. An optimized design is not usable then.
void add_worse(const mmc::BodyProblem& p, const mmc::BodyOutcome& o, Warnings& out) {
  if (!mmc::worse_than_uniform(p, o)) return;
  out.push_back({"body '" + o.body + "': the sharp compliance " +
                     io::to_text(o.sharp.compliance, 4) + " J is above that of uniform material, " +
                     io::to_text(o.uniform_compliance, 4) + " J: the design is worse than none",
                 o.iterations > 0});
}

/// Adds warnings about loads of a static plate that act on void. On the cells, such a load deforms
/// the soft void material; in the verification of the outline, the force is distributed over the
/// material that remains in the region of the load.
void add_loads_on_void(const Scene& scene, const mmc::BodyProblem& p, const mmc::BodyOutcome& o,
                       Warnings& out) {
  for (const LoadOnVoid& load : loads_on_void(scene, p, o.sharp.fractions))
    out.push_back({"body '" + o.body + "': " + io::to_text(100 * load.part, 3) + " % of load '" +
                       load.name +
                       "' acts on void, which carries nothing; a [[design.solid]] at the place of "
                       "the load carries it",
                   load.part > kLargestPartOnVoid});
}

/// Adds warnings about the verification of an outline. A part that does not carry its loads is not
/// usable.
void add_verification(const VerifiedOutline& outline, const mmc::BodyOutcome& outcome,
                      Warnings& out) {
  const double sharp = outcome.sharp.compliance;
  if (!outline.verification) {
    out.push_back({"body '" + outline.body + "': no body-fitted compliance: " + outline.why_not});
    return;
  }
  const verification::OutlineVerification& j = *outline.verification;
  if (!std::isfinite(j.compliance))
    out.push_back(
        {"body '" + outline.body + "': load '" + j.unsupported_load +
             "' acts on material that nothing holds, or on none: the body-fitted compliance "
             "is infinite",
         outcome.of_part});
  else if (!j.converged)
    out.push_back({"body '" + outline.body +
                   "': the body-fitted compliance has an error of about " +
                   io::to_text(100 * j.error, 2) + " %: its mesh reached its largest size"});
  const double apart = sharp / j.compliance - 1;
  if (std::isfinite(j.compliance) && std::abs(apart) > kCellsApart)
    out.push_back({"body '" + outline.body + "': the cells of the design say a compliance " +
                   io::to_text(100 * std::abs(apart), 2) + " % " + (apart < 0 ? "below" : "above") +
                   " the body-fitted one"});
  if (j.n_omitted_pieces > 0)
    out.push_back({"body '" + outline.body + "': " + std::to_string(j.n_omitted_pieces) + " of " +
                   std::to_string(j.n_pieces) + " pieces are held by nothing"});
}

/// Returns the names as a list, each name once, separated by commas.
std::string list_of(std::vector<std::string> names) {
  std::string out;
  for (size_t k = 0; k < names.size(); ++k)
    if (std::find(names.begin(), names.begin() + static_cast<std::ptrdiff_t>(k), names[k]) ==
        names.begin() + static_cast<std::ptrdiff_t>(k))
      out += (out.empty() ? "" : ", ") + names[k];
  return out;
}

/// Returns a message on widths that are smaller than required, and on separate regions.
std::string length_scale_words(const mmc::BodyOutcome& o) {
  const Widths& wanted = o.length_scale->wanted;
  std::vector<std::string> out;
  const auto add = [&](const std::string& what, double found, double asked) {
    if (found < asked)
      out.push_back("its smallest " + what + " is " + io::to_text(found, 4) + " m where " +
                    io::to_text(asked, 4) + " m was asked for");
  };
  if (o.sharp.features) {
    add("feature", o.sharp.features->solid, wanted.solid);
    add("gap", o.sharp.features->gap, wanted.gap);
  } else {
    out.push_back("its outlines cannot be united");
  }
  if (o.sharp.connectivity.islands > 0)
    out.push_back("it has " + std::to_string(o.sharp.connectivity.islands + 1) + " pieces");
  return "body '" + o.body + "': " + list_of(out) +
         (o.iterations > 0 ? "; more iterations may help" : "");
}

void add_designs(const Scene& scene, const DesignResult& design, Warnings& out) {
  if (!design.outcomes.empty())
    for (const mmc::BodyProblem& p : design.problems)
      for (std::string& words : missing_material(scene, p)) out.push_back({std::move(words), true});
  for (const mmc::BodyOutcome& o : design.outcomes) {
    if (const std::string loads = list_of(o.sharp.connectivity.loose_loads); !loads.empty())
      out.push_back({"body '" + o.body + "': no material joins " + loads + " to a support", true});
    else if (const std::string unused = list_of(o.sharp.connectivity.unused_supports);
             !unused.empty())
      out.push_back({"body '" + o.body + "': the design does not use " + unused +
                     ": no material joins it to a load"});
    if (!o.reaches_length_scale()) out.push_back({length_scale_words(o)});
    if (o.sharp.compliance > 1.15 * o.compliance)
      out.push_back({"body '" + o.body +
                     "': the sharp compliance is far above the blurred one: gaps are bridged"});
    if (o.compliance > kHangingMass * o.sharp.compliance)
      out.push_back(
          {"body '" + o.body + "': the compliance is " +
           io::to_text(o.compliance / o.sharp.compliance, 2) +
           " times the sharp one: edges of material hang on void of hardly any stiffness; "
           "a larger design.alpha helps"});
  }
  for (const mmc::BodyProblem& p : design.problems)
    for (const mmc::BodyOutcome& o : design.outcomes)
      if (o.body == p.body) {
        if (!is_judged(scene, o)) continue;
        if (scene.domain) add_loads_on_void(scene, p, o, out);
        add_limits(p, o, out);
        add_worse(p, o, out);
      }
  for (const VerifiedOutline& outline : design.outlines) {
    for (const mmc::BodyOutcome& o : design.outcomes)
      if (o.body == outline.body) add_verification(outline, o, out);
    for (std::string& words : narrow_words(outline)) out.push_back({std::move(words)});
  }
}

/// Adds warnings about designs whose loads differ from the loads of the motion with the designs. It
/// also adds warnings about designs whose cells are not resolved by the elements of the motion, if
/// the designs are not assessed by a motion on cells.
void add_load_differences(const Scene& scene, const DesignResult& design, Warnings& out) {
  constexpr double kLargest = mmc::LoadDifference::kLargest;
  const double allowed = std::max(kLargest, scene.cycle.load_difference);
  for (const mmc::LoadDifference& d : design.load_differences) {
    if (d.loads > allowed)
      out.push_back({"body '" + d.body + "': the loads that it was designed for are " +
                     io::to_text(100 * d.loads, 2) +
                     " % of the energy off those of the motion with it: " +
                     (scene.cycle.max_cycles > static_cast<int>(design.verdicts.size())
                          ? "no cycle brings them closer and is better"
                          : "more cycles (cycle.max_cycles) bring them closer")});
    if (d.geometric > kLargest && !scene.judges_on_cells())
      out.push_back({"body '" + d.body + "': static energies of its cells are " +
                     io::to_text(100 * d.geometric, 2) +
                     " % off the strain energies of its motion: elements of the motion bridge what "
                     "is cut or thin, or deflections are large; [verify] cells = 1 moves the cells "
                     "themselves"});
  }
}

/// Adds warnings about designs whose tip or observed points vibrate more than with uniform
/// material.
void add_variations(const Scene& scene, const RunResult& result, Warnings& out) {
  const MotionResults& motions = result.motions;
  for (const mmc::BodyOutcome& o : result.design.outcomes) {
    if (!is_judged(scene, o)) continue;
    std::vector<PointVariation> points = point_variations(motions, o.body);
    if (const auto tip = tip_variation(motions, o.body)) points.insert(points.begin(), *tip);
    for (const PointVariation& point : points) {
      const double rms = point.rms_ratio(), range = point.peak_to_peak_ratio();
      if (point.moves() && std::max(rms, range) > PointVariation::kLargestRatio)
        out.push_back({"body '" + o.body + "': its " +
                       (point.name.empty() ? "tip" : "observed point '" + point.name + "'") +
                       " vibrates more than with uniform material of this mass: " +
                       io::to_text(rms, 3) + " times in root mean square about the mean, " +
                       io::to_text(range, 3) + " times peak to peak"});
    }
  }
}

/// Returns the energy that the time integration has added to the motion, relative to the largest
/// energy, at the time of the largest error of the energy balance; negative if energy was removed.
double integrated_part(const MotionRecord& motion) {
  const std::vector<double>& defect = motion.table.at(kDefectColumn);
  if (!(largest_size(defect) > 0)) return 0;
  const auto [lowest, highest] = std::minmax_element(defect.begin(), defect.end());
  return -*lowest > *highest ? -motion.result.energy_defect : motion.result.energy_defect;
}

/// Returns a message on bodies whose temperature jumps during the motion; empty if there are none.
std::string jump_words(const Scene& scene) {
  std::string jumps;
  for (const Body& body : scene.bodies)
    if (body.heat && body.heat->profile == "step" && body.heat->start < scene.time.end)
      jumps += (jumps.empty() ? "" : ", ") + ("'" + body.name + "' at t = ") +
               io::to_text(body.heat->start, 4) + " s";
  if (jumps.empty()) return "";
  return "a temperature that jumps (" + jumps +
         ") brings energy in between two steps, where no power shows, and that is missed here; the "
         "motion is as good as its step. A body.heat.profile that takes time, as \"quartic\", has "
         "a power";
}

/// Adds a warning if mesh changes alter the strain energy, because the motion after them is then
/// partly a response to the mesh changes.
/// @param subject  name of the motion in the message
void add_mesh_changes(const MotionRecord& motion, const std::string& subject, Warnings& out) {
  double largest = largest_size(motion.table.at(kStrainColumn));
  for (const fem::MeshEvent& event : motion.result.events)
    largest = std::max(largest, std::abs(event.before.strain));
  const auto moved = [](const fem::MeshEvent& e) {
    return std::abs(e.after.strain - e.before.strain);
  };
  const fem::MeshEvent* worst = nullptr;
  int number = 0;
  for (const fem::MeshEvent& event : motion.result.events) {
    if (!(moved(event) > kLargestMove * largest)) continue;
    ++number;
    if (!worst || moved(event) > moved(*worst)) worst = &event;
  }
  if (!worst) return;
  out.push_back({std::to_string(number) + " of " + std::to_string(motion.result.events.size()) +
                 " changes of the mesh move more than " + io::to_text(100 * kLargestMove, 2) +
                 " % of the largest strain energy of " + subject + ", " + io::to_text(largest, 4) +
                 " J; the worst, at t = " + io::to_text(worst->time, 4) + " s in body '" +
                 worst->body + "', " + io::to_text(moved(*worst), 4) +
                 " J: more elements, or body.flow.mesh = \"even\" where elements are no cells"});
}

void add_motion(const Scene& scene, const MotionRecord& motion, Warnings& out) {
  const std::string jumps = jump_words(scene);
  for (const fem::Conditioning& c : motion.result.near_singular) out.push_back({fem::describe(c)});
  if (motion.result.alternation)
    out.push_back({alternation_words(*motion.result.alternation)});
  else if (damps_no_multipliers(scene))
    out.push_back({undamped_words(scene)});
  // The explicit integrator shortens steps to satisfy its tolerance, which needs no warning.
  if (const fem::CutSteps& cut = motion.result.cut;
      cut.number > 0 && scene.time.integrator != "minimal_coordinates")
    out.push_back({"Newton's method did not solve all steps of " + io::to_text(scene.time.step, 3) +
                   " s: from t = " + io::to_text(cut.since, 4) + " s on " +
                   std::to_string(cut.number) + " steps were cut, down to " +
                   io::to_text(cut.shortest, 2) + " s"});
  if (const fem::EnergyGain& gain = motion.result.energy_gain; gain.time > 0)
    out.push_back({"no drive brings energy in, but the energy of the motion has grown by " +
                       io::to_text(100 * gain.part, 3) +
                       " % of the largest, by more than 10 % from " +
                       "t = " + io::to_text(gain.time, 4) +
                       " s on: do not trust what comes after; a smaller time.step helps, "
                       "time.integrator = \"energy_momentum\" keeps the energy",
                   true});
  else if (misses_energy(scene, motion))
    out.push_back(
        {"the balance of energy is missed by " + io::to_text(100 * motion.result.energy_defect, 3) +
         " % of the largest energy: " +
         (jumps.empty() ? "do not trust this motion; a smaller time.step helps" : jumps)});
  else if (const double part = integrated_part(motion);
           std::abs(part) > kLargestLoss && jumps.empty() &&
           largest_size(motion.table.at(kDefectColumn)) > stress_round_off(scene))
    out.push_back({std::string("the time integration ") + (part > 0 ? "adds " : "dissipates ") +
                   io::to_text(100 * std::abs(part), 2) +
                   " % of the largest energy: a smaller time.step " +
                   (part > 0 ? "adds less" : "dissipates less")});
}

}  // namespace

Warnings warnings_of(const Scene& scene, const RunResult& result) {
  Warnings out;
  const DesignResult& design = result.design;
  add_designs(scene, design, out);
  if (design.corrected && !design.corrected->improves())
    out.push_back({"corrected cycles did not pay on the cells of the case and were taken back: J " +
                   io::to_text(design.corrected->after, 5) + " instead of " +
                   io::to_text(design.corrected->before, 5) +
                   "; cycle.cell of the design itself sees what it sees"});
  add_load_differences(scene, design, out);
  add_variations(scene, result, out);
  if (result.motions.motion) {
    add_motion(scene, *result.motions.motion, out);
    add_mesh_changes(*result.motions.motion, "the motion", out);
  }
  if (result.motions.verified)
    add_mesh_changes(*result.motions.verified, "the motion on cells", out);
  if (!result.info.lost_frames.empty()) out.push_back({result.info.lost_frames});
  if (!result.info.missing_exports.empty()) out.push_back({result.info.missing_exports});
  return out;
}

bool damps_no_multipliers(const Scene& scene) {
  return !scene.joints.empty() && scene.time.integrator == "generalized_alpha" &&
         scene.time.rho_inf > 0.98;
}

std::string undamped_words(const Scene& scene) {
  return "rho_inf = " + io::to_text(scene.time.rho_inf, 3) +
         " hardly damps multipliers: joint forces may alternate from step to step and "
         "grow; time.rho_inf = 0.9 damps them";
}

std::string alternation_words(const fem::Alternation& found) {
  return "from t = " + io::to_text(found.time, 4) + " s on the force of joint '" + found.joint +
         "' alternates from step to step, by " + io::to_text(100 * found.part, 2) +
         " % of its largest: these forces are no results; time.rho_inf = 0.9 damps them";
}

bool usable(const Warnings& warnings) {
  return std::none_of(warnings.begin(), warnings.end(),
                      [](const Warning& each) { return each.unusable; });
}

std::string done_words(const Warnings& warnings) {
  return usable(warnings) ? "done" : "done, not usable";
}

std::string counted(size_t n, const std::string& one, const std::string& many) {
  return n == 0 ? "" : ", " + std::to_string(n) + " " + (n == 1 ? one : many);
}

}  // namespace flexmorph::cases
