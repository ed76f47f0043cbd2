#include "cases/results/warnings.h"

#include <algorithm>
#include <cmath>
#include <span>

#include "cases/assembly/build.h"
#include "cases/assembly/static_conditions.h"
#include "cases/results/parts/part_checks.h"
#include "io/files.h"
#include "optim/mmc/cycles/usability.h"

namespace flexmorph::cases {
namespace {

using Warnings = std::vector<Warning>;

// Thresholds of warnings: the energy change by the time integration, the error of the energy
// balance (both relative to the largest energy), the strain energy change by a mesh change
// (relative to the largest strain energy), and the difference of crisp and body-fitted compliance.
constexpr double kLargestLoss = 0.01;
constexpr double kLargestEnergyError = 0.1;
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
    const double found = mmc::crisp_value(*limit.row, p.goal, o.crisp);
    if (!(limit.excess(found) > mmc::kLimitTolerance)) continue;
    out.push_back(
        {"The " + std::string(limit.row->words) + " of body '" + o.body + "' is " +
             io::to_text(found, 4) +
             (limit.at_least ? ", below the required value " : ", above the allowed value ") +
             io::to_text(limit.value, 4) + "." +
             (o.iterations > 0 ? " The optimizer found no design that satisfies this limit." : "") +
             (limit.wants_material() ? " The value of the full design is " +
                                           io::to_text(o.full.at(mmc::key_of(*limit.row)), 4) + "."
                                     : std::string()),
         true});
  }
}

/// Tells whether the error of the energy balance is so large that the motion is not reliable.
bool misses_energy(const Scene& scene, const MotionRecord& motion) {
  return motion.result.energy_error > kLargestEnergyError &&
         largest_size(motion.table.at(kEnergyErrorColumn)) > stress_round_off(scene);
}

/// Tells whether a design has to satisfy the limits of the case, because it was optimized, is a
/// part, or is given by the case. The default initial layout of components need not satisfy them.
bool is_verified(const Scene& scene, const mmc::BodyOutcome& o) {
  return o.iterations > 0 || o.of_part ||
         std::any_of(scene.designs.begin(), scene.designs.end(),
                     [&](const BodyDesign& d) { return d.body == o.body && !d.start.empty(); });
}

/// Adds a warning if the compliance of a design is larger than that of uniform material of the same
/// volume. An optimized design is not usable then.
void add_worse(const mmc::BodyProblem& p, const mmc::BodyOutcome& o, Warnings& out) {
  if (!mmc::worse_than_uniform(p, o)) return;
  out.push_back({"The crisp compliance of body '" + o.body + "' is " +
                     io::to_text(o.crisp.compliance, 4) +
                     " J. The design is worse than uniform material of equal volume, which has " +
                     io::to_text(o.uniform_compliance, 4) + " J.",
                 o.iterations > 0});
}

/// Adds warnings about loads of a static plate that act on void. On the cells, such a load deforms
/// the soft void material; in the verification of the outline, the force is distributed over the
/// material that remains in the region of the load.
void add_loads_on_void(const Scene& scene, const mmc::BodyProblem& p, const mmc::BodyOutcome& o,
                       Warnings& out) {
  for (const LoadOnVoid& load : loads_on_void(scene, p, o.crisp.fractions))
    out.push_back({"In body '" + o.body + "', " + io::to_text(100 * load.part, 3) + " % of load '" +
                       load.name +
                       "' acts on void, which cannot carry it. Add a [[design.solid]] at the "
                       "location of the load.",
                   load.part > kLargestPartOnVoid});
}

/// Adds warnings about the verification of an outline. A part that does not carry its loads is not
/// usable.
void add_verification(const VerifiedOutline& outline, const mmc::BodyOutcome& outcome,
                      Warnings& out) {
  if (!outline.verification) {
    out.push_back(
        {"The outline of body '" + outline.body + "' was not verified: " + outline.why_not + "."});
    return;
  }
  const verification::OutlineVerification& j = *outline.verification;
  if (!std::isfinite(j.compliance))
    out.push_back({"The body-fitted compliance of body '" + outline.body +
                       "' is infinite, because load '" + j.unsupported_load +
                       "' acts on material without a support, or where there is no material.",
                   outcome.of_part});
  else if (!j.converged)
    out.push_back({"The body-fitted compliance of body '" + outline.body +
                   "' has an estimated error of " + io::to_text(100 * j.error, 2) +
                   " %, because the mesh reached its largest allowed size."});
  const double apart = outcome.crisp.compliance / j.compliance - 1;
  if (std::isfinite(j.compliance) && std::abs(apart) > kCellsApart)
    out.push_back({"The compliance of body '" + outline.body + "' on the design mesh is " +
                   io::to_text(100 * std::abs(apart), 2) + " % " + (apart < 0 ? "below" : "above") +
                   " its body-fitted compliance."});
  if (j.n_omitted_regions > 0)
    out.push_back({"The outline of body '" + outline.body + "' has connected regions without a " +
                   "support: " + std::to_string(j.n_omitted_regions) + " of " +
                   std::to_string(j.n_connected_regions) + "."});
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
std::string length_scale_text(const mmc::BodyOutcome& o) {
  const MinimumWidths& wanted = o.length_scale->wanted;
  std::vector<std::string> out;
  const auto add = [&](const std::string& what, double found, double asked) {
    if (found < asked)
      out.push_back("the smallest " + what + " is " + io::to_text(found, 4) + " m instead of " +
                    io::to_text(asked, 4) + " m");
  };
  if (o.crisp.features) {
    add("feature", o.crisp.features->solid, wanted.solid);
    add("gap", o.crisp.features->gap, wanted.gap);
  } else {
    out.push_back("the outlines cannot be united");
  }
  if (o.crisp.connectivity.islands > 0)
    out.push_back("there are " + std::to_string(o.crisp.connectivity.islands + 1) +
                  " connected regions");
  return "The design of body '" + o.body +
         "' does not satisfy the minimum length scale: " + list_of(out) + "." +
         (o.iterations > 0 ? " More iterations may help." : "");
}

void add_designs(const Scene& scene, const DesignResult& design, Warnings& out) {
  if (!design.outcomes.empty())
    for (const mmc::BodyProblem& p : design.problems)
      for (std::string& words : missing_material(scene, p)) out.push_back({std::move(words), true});
  for (const mmc::BodyOutcome& o : design.outcomes) {
    if (const std::string loads = list_of(o.crisp.connectivity.loose_loads); !loads.empty())
      out.push_back(
          {"In body '" + o.body + "', no material connects " + loads + " to a support.", true});
    else if (const std::string unused = list_of(o.crisp.connectivity.unused_supports);
             !unused.empty())
      out.push_back({"In body '" + o.body + "', no material connects " + unused +
                     " to a load. The design does not use this support."});
    if (!o.reaches_length_scale()) out.push_back({length_scale_text(o)});
    if (o.crisp.compliance > 1.15 * o.compliance)
      out.push_back({"The crisp compliance of body '" + o.body + "' is " +
                     io::to_text(o.crisp.compliance / o.compliance, 3) +
                     " times its smoothed compliance. Partly filled cells bridge gaps in the "
                     "smoothed design."});
    if (o.compliance > kHangingMass * o.crisp.compliance)
      out.push_back(
          {"The smoothed compliance of body '" + o.body + "' is " +
           io::to_text(o.compliance / o.crisp.compliance, 2) +
           " times its crisp compliance, because heavy edges of the material are supported by void "
           "of very low stiffness. Increase design.alpha."});
  }
  for (const mmc::BodyProblem& p : design.problems)
    for (const mmc::BodyOutcome& o : design.outcomes)
      if (o.body == p.body && is_verified(scene, o)) {
        if (scene.domain) add_loads_on_void(scene, p, o, out);
        add_limits(p, o, out);
        add_worse(p, o, out);
      }
  for (const VerifiedOutline& outline : design.outlines) {
    for (const mmc::BodyOutcome& o : design.outcomes)
      if (o.body == outline.body) add_verification(outline, o, out);
    for (std::string& words : narrow_text(outline)) out.push_back({std::move(words)});
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
      out.push_back({"The design loads of body '" + d.body + "' differ by " +
                     io::to_text(100 * d.loads, 2) +
                     " % of the energy from the loads of the motion with the final design. " +
                     (scene.cycle.max_cycles > std::max(1, static_cast<int>(design.verdicts.size()))
                          ? "No further cycle reduced this difference and improved the design."
                          : "Increase cycle.max_cycles to reduce this difference.")});
    if (d.geometric > kLargest && !scene.verifies_on_cells())
      out.push_back({"The static strain energy of body '" + d.body +
                     "' on the design mesh differs by " + io::to_text(100 * d.geometric, 2) +
                     " % from the strain energy of the motion. The coarse elements of the motion "
                     "may be too stiff where the design has thin bars or gaps, or the deflections "
                     "are large. Set [verify] cells = 1 to simulate the motion on the design "
                     "mesh."});
  }
}

/// Adds warnings about designs whose tip or observed points vibrate more than with uniform
/// material.
void add_variations(const Scene& scene, const RunResult& result, Warnings& out) {
  const MotionResults& motions = result.motions;
  for (const mmc::BodyOutcome& o : result.design.outcomes) {
    if (!is_verified(scene, o)) continue;
    std::vector<PointVariation> points = point_variations(motions, o.body);
    if (const auto tip = tip_variation(motions, o.body)) points.insert(points.begin(), *tip);
    for (const PointVariation& point : points) {
      const double rms = point.rms_ratio(), range = point.peak_to_peak_ratio();
      if (point.moves() && std::max(rms, range) > PointVariation::kLargestRatio)
        out.push_back(
            {"The " + (point.name.empty() ? "tip" : "observed point '" + point.name + "'") +
             " of body '" + o.body +
             "' vibrates more than with uniform material of equal mass. The ratio of the root mean "
             "squares about the mean is " +
             io::to_text(rms, 3) + ", the ratio of the peak-to-peak values is " +
             io::to_text(range, 3) + "."});
    }
  }
}

/// Returns the energy that the time integration has added to the motion, relative to the largest
/// energy, at the time of the largest error of the energy balance; negative if energy was removed.
double integrated_part(const MotionRecord& motion) {
  const std::vector<double>& energy_error = motion.table.at(kEnergyErrorColumn);
  if (!(largest_size(energy_error) > 0)) return 0;
  const auto [lowest, highest] = std::minmax_element(energy_error.begin(), energy_error.end());
  return -*lowest > *highest ? -motion.result.energy_error : motion.result.energy_error;
}

/// Returns a message on bodies whose temperature jumps during the motion; empty if there are none.
std::string jump_text(const Scene& scene) {
  std::string jumps;
  for (const Body& body : scene.bodies)
    if (body.heat && body.heat->profile == "step" && body.heat->start < scene.time.end)
      jumps += (jumps.empty() ? "" : ", ") + ("'" + body.name + "' at t = ") +
               io::to_text(body.heat->start, 4) + " s";
  if (jumps.empty()) return "";
  return "A temperature jump (" + jumps +
         ") adds energy between two time steps, and the computed powers do not contain this "
         "energy. The accuracy of the motion depends only on its time step. A gradual "
         "body.heat.profile, such as \"quartic\", avoids this error.";
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
  out.push_back(
      {std::to_string(number) + " of " + std::to_string(motion.result.events.size()) +
       " mesh changes alter the strain energy of " + subject + " by more than " +
       io::to_text(100 * kLargestMove, 2) + " % of its largest value, " + io::to_text(largest, 4) +
       " J. The largest change is " + io::to_text(moved(*worst), 4) +
       " J at t = " + io::to_text(worst->time, 4) + " s in body '" + worst->body +
       "'. Use more elements, or body.flow.mesh = \"uniform\" if the elements are not the "
       "cells of a design."});
}

void add_motion(const Scene& scene, const MotionRecord& motion, Warnings& out) {
  const std::string jumps = jump_text(scene);
  for (const fem::Conditioning& c : motion.result.near_singular) out.push_back({fem::describe(c)});
  if (motion.result.alternation)
    out.push_back({alternation_text(*motion.result.alternation)});
  else if (damps_no_multipliers(scene))
    out.push_back({undamped_text(scene)});
  // The explicit integrator shortens steps to satisfy its tolerance, which needs no warning.
  if (const fem::CutSteps& cut = motion.result.cut;
      cut.number > 0 && scene.time.integrator != "minimal_coordinates")
    out.push_back(
        {"Some time steps of " + io::to_text(scene.time.step, 3) +
         " s were too long for Newton's method or for closed loops of rigid bodies, which "
         "must stay on their branch. From t = " +
         io::to_text(cut.since, 4) + " s on, " + std::to_string(cut.number) +
         " steps were shortened; the shortest step is " + io::to_text(cut.shortest, 2) + " s."});
  if (const fem::EnergyGain& gain = motion.result.energy_gain; gain.time > 0)
    out.push_back({"No drive supplies energy, but the energy of the motion has grown by " +
                       io::to_text(100 * gain.part, 3) +
                       " % of its largest value. The growth exceeds 10 % from t = " +
                       io::to_text(gain.time, 4) +
                       " s on, and later results are not reliable. Use a smaller time.step, or "
                       "time.integrator = \"energy_momentum\", which conserves the energy.",
                   true});
  else if (misses_energy(scene, motion))
    out.push_back(
        {"The error of the energy balance is " + io::to_text(100 * motion.result.energy_error, 3) +
         " % of the largest energy. " +
         (jumps.empty() ? "This motion is not reliable. Use a smaller time.step." : jumps)});
  else if (const double part = integrated_part(motion);
           std::abs(part) > kLargestLoss && jumps.empty() &&
           largest_size(motion.table.at(kEnergyErrorColumn)) > stress_round_off(scene))
    out.push_back({std::string("The time integration ") + (part > 0 ? "adds " : "dissipates ") +
                   io::to_text(100 * std::abs(part), 2) +
                   " % of the largest energy. A smaller time.step reduces this error."});
}

}  // namespace

Warnings warnings_of(const Scene& scene, const RunResult& result) {
  Warnings out;
  const DesignResult& design = result.design;
  add_designs(scene, design, out);
  if (design.corrected && !design.corrected->improves())
    out.push_back(
        {"The corrected cycles did not reduce J on the design mesh of the case, so the "
         "designs before them are kept. J is " +
         io::to_text(design.corrected->after, 5) + " after the corrected cycles and " +
         io::to_text(design.corrected->before, 5) +
         " before them. Set cycle.cell to the cell size of the design to compute the "
         "corrections on the design mesh."});
  add_load_differences(scene, design, out);
  add_variations(scene, result, out);
  if (result.motions.motion) {
    add_motion(scene, *result.motions.motion, out);
    add_mesh_changes(*result.motions.motion, "the motion", out);
  }
  if (result.motions.verified)
    add_mesh_changes(*result.motions.verified, "the motion on the design mesh", out);
  if (scene.file)
    for (const std::string& former : scene.file->former_names()) out.push_back({former});
  for (const std::string& note : scene.notes) out.push_back({note});
  if (!result.info.lost_frames.empty()) out.push_back({result.info.lost_frames});
  if (!result.info.missing_exports.empty()) out.push_back({result.info.missing_exports});
  return out;
}

std::vector<std::string> notes_of(const RunResult& result) {
  std::vector<std::string> out;
  for (const mmc::BodyOutcome& o : result.design.outcomes)
    if (o.length_scale && o.crisp.given_width)
      out.push_back("In body '" + o.body + "', solid regions or borders of the domain make the " +
                    "material " + io::to_text(*o.crisp.given_width, 3) +
                    " m wide, which is less than min_feature = " +
                    io::to_text(o.length_scale->wanted.solid, 3) +
                    " m. No design can change this width, therefore min_feature does not apply "
                    "there.");
  return out;
}

bool damps_no_multipliers(const Scene& scene) {
  return !scene.joints.empty() && scene.time.integrator == "generalized_alpha" &&
         scene.time.rho_inf > 0.98;
}

std::string undamped_text(const Scene& scene) {
  return "time.rho_inf = " + io::to_text(scene.time.rho_inf, 3) +
         " adds very little numerical damping. Joint forces may alternate from step to step and "
         "grow. Set time.rho_inf = 0.9 to damp them.";
}

std::string alternation_text(const fem::Alternation& found) {
  return "From t = " + io::to_text(found.time, 4) + " s on, the force of joint '" + found.joint +
         "' alternates from step to step by up to " + io::to_text(100 * found.part, 2) +
         " % of its largest value. These joint forces are not valid results. Set time.rho_inf = "
         "0.9 to damp the alternation.";
}

bool usable(const Warnings& warnings) {
  return std::none_of(warnings.begin(), warnings.end(),
                      [](const Warning& each) { return each.unusable; });
}

std::string done_text(const Warnings& warnings) {
  return usable(warnings) ? "done" : "done, not usable";
}

std::string counted(size_t n, const std::string& one, const std::string& many) {
  return n == 0 ? "" : ", " + std::to_string(n) + " " + (n == 1 ? one : many);
}

}  // namespace flexmorph::cases
