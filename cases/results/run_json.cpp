#include "cases/results/run_json.h"

#include <cmath>
#include <nlohmann/json.hpp>

#include "cases/output/plots/measured.h"
#include "cases/output/plots/mechanism.h"
#include "cases/results/expectations.h"
#include "cases/results/limit_points.h"
#include "cases/results/warnings.h"
#include "cases/scene/design/goal.h"
#include "cases/scene/heat/heat.h"
#include "cases/scene/version.h"
#include "fem/solve/linear_solver.h"
#include "io/json.h"

namespace flexmorph::cases {
namespace {

using Json = nlohmann::ordered_json;

/// Thinnest half-thickness of any component anywhere along its axis [m].
double thinnest(const mmc::BodyProblem& problem) {
  double out = problem.grid.width;
  for (const Component& c : problem.design.components())
    for (int k = 0; k <= 200; ++k)
      out = std::min(
          out,
          profile(c, c.half_length * (k / 100.0 - 1), problem.stages.back().min_half_thickness).g);
  return out;
}

/// Where it was asked for, and the matrix is not singular to working precision.
void set_condition(Json& out, const std::optional<double>& condition) {
  if (condition && std::isfinite(*condition)) out["condition"] = *condition;
}

/// Numbers that JSON has none for: "infinite".
Json finite_or_words(double value) { return std::isfinite(value) ? Json(value) : Json("infinite"); }

Json clean_up_results(const mmc::CleanUp& c) {
  Json out = Json::object();
  out["min_feature_wanted"] = c.wanted.solid;
  out["min_feature_before"] = finite_or_words(c.before.solid);
  out["min_gap_wanted"] = c.wanted.gap;
  out["min_gap_before"] = finite_or_words(c.before.gap);
  out["pieces_before"] = c.pieces_before;
  out["pieces"] = c.pieces_after;
  out["compliance_before"] = c.compliance_before;
  out["compliance_cost"] = c.compliance_after / c.compliance_before - 1;
  out["patches"] = c.patches;
  out["dropped"] = c.dropped;
  out["idle"] = c.idle;
  out["stubs"] = c.stubs;
  out["joined"] = c.joined;
  out["born"] = c.born;
  out["rounds"] = c.rounds;
  out["torn_gaps"] = c.torn;
  out["reached"] = c.reached();
  out["given_up"] = c.given_up;
  return out;
}

/// What the column `scaled_objective` of history.csv holds: the objective as optimizers see it.
std::string objective_words(const mmc::BodyProblem& p) {
  const mmc::ResponseRow& row = *p.goal.objective;
  const std::string of = std::string(row.words).append(" [").append(row.unit).append("]");
  if (p.shares_mass)
    return "natural logarithm of the " + of + ", summed over bodies that share mass";
  return row.full ? of + ", divided by that of the full plate" : "natural logarithm of the " + of;
}

Json judged_results(const JudgedBody& judged, double sharp_compliance) {
  Json out = Json::object();
  if (!judged.verdict) {
    out["not_judged"] = judged.why_not;
    return out;
  }
  const verification::OutlineVerification& j = *judged.verdict;
  out["compliance"] = finite_or_words(j.compliance);
  out["volume"] = judged.volume;
  out["islands"] = j.n_pieces - 1;
  out["held_by_nothing"] = j.n_omitted_pieces;
  out["triangles"] = static_cast<int>(j.mesh.triangles.size());
  out["seconds"] = j.seconds;
  if (!std::isfinite(j.compliance)) {
    out["loose_load"] = j.unsupported_load;
    return out;
  }
  out["error"] = j.error;
  out["converged"] = j.converged;
  out["cells_over_this"] = sharp_compliance / j.compliance - 1;
  out["meshes"] = j.meshes;
  out["largest_stress"] = j.largest_stress;
  out["largest_stress_at"] = {j.largest_at.x(), j.largest_at.y()};
  out["largest_stress_load"] = j.largest_load + 1;
  if (!j.mesh_loads.empty()) {
    Json exported = Json::object();  // the first load of design.inp
    exported["load"] = j.mesh_loads.front().load + 1;
    exported["compliance"] = j.mesh_loads.front().compliance;
    exported["largest_stress"] = j.shown_stress.value;
    exported["largest_stress_at"] = {j.shown_stress.at.x(), j.shown_stress.at.y()};
    out["exported"] = std::move(exported);
  }
  return out;
}

Json energy_results(const EnergyComparison& e) {
  Json out = Json::object();
  out["loads_compared"] = e.compared;
  out["loads_apart"] = e.apart;
  out["worst_static_over_motion"] = e.ratio;
  out["worst_time"] = e.time;
  return out;
}

Json body_results(const RunReport& report, size_t i) {
  const mmc::BodyOutcome& o = report.outcomes[i];
  Json out = Json::object();
  out["body"] = o.body;
  out["compliance"] = o.compliance;
  out["volume"] = o.volume;
  out["sharp_compliance"] = o.sharp.compliance;
  out["sharp_volume"] = o.sharp.volume;
  for (const auto& [name, value] : o.further) {
    out[name] = value;
    out["sharp_" + name] = o.sharp.further.at(name);
  }
  if (i < report.judged.size())
    out["body_fitted"] = judged_results(report.judged[i], o.sharp.compliance);
  out["uniform_compliance"] = o.uniform_compliance;
  out["connected"] = o.sharp.connectivity.connected;
  out["islands"] = o.sharp.connectivity.islands;
  const auto width = [&](double Features::*which) {
    const bool there = o.sharp.features && std::isfinite((*o.sharp.features).*which);
    return there ? Json((*o.sharp.features).*which) : Json();
  };
  out["min_feature"] = width(&Features::solid);
  out["min_gap"] = width(&Features::gap);
  if (o.clean_up) out["clean_up"] = clean_up_results(*o.clean_up);
  out["thinnest_component"] = thinnest(report.problems[i]);
  const auto amplitude = [&](const std::optional<MotionRecord>& motion) {
    if (!motion) return Json();
    const auto found = std::find(motion->bodies.begin(), motion->bodies.end(), o.body);
    if (found == motion->bodies.end()) return Json();  // a link between two pins has no tip
    return Json(motion->amplitude.at(static_cast<size_t>(found - motion->bodies.begin())));
  };
  out["dynamic_amplitude"] = amplitude(report.judging());
  out["uniform_dynamic_amplitude"] = amplitude(report.judging_uniform());
  out["scene_mesh_amplitude"] = amplitude(report.motion);
  out["scene_mesh_uniform_amplitude"] = amplitude(report.uniform_motion);
  for (const EnergyComparison& e : report.energies)
    if (e.body == o.body) out["energies"] = energy_results(e);
  out["scaled_objective"] = objective_words(report.problems[i]);
  out["cycles"] = report.cycles;
  out["iterations"] = o.iterations;
  out["start"] = o.start;
  out["state_solves"] = o.evaluations;
  out["kkt"] = o.kkt;
  out["factorizations"] = o.factorizations;
  out["worst_compliance"] = o.worst_compliance;
  set_condition(out, o.condition);
  Json active = Json::array();  // loads within 1 % of the worst, from 1
  for (size_t l = 0; l < o.load_compliances.size(); ++l)
    if (o.load_compliances[l] >= 0.99 * o.worst_compliance)
      active.push_back(static_cast<int>(l + 1));
  out["active_loads"] = std::move(active);
  out["loads"] = o.n_loads;
  out["right_hand_sides"] = o.n_right_hand_sides;
  out["components"] = report.problems[i].design.n_components();
  out["component_changes"] = static_cast<int>(o.events.size());
  out["stop"] = o.stop;
  return out;
}

/// Last values of columns, by their names.
Json last_values(const std::vector<Column>& columns) {
  Json out = Json::object();
  for (const Column& column : columns)
    if (!column.values.empty()) out[column.name] = column.values.back();
  return out;
}

Json path_results(const PathRecord& path) {
  Json out = Json::object();
  out["equilibria"] = static_cast<int>(path.factor.size());
  if (!path.factor.empty()) out["load_factor"] = path.factor.back();
  if (!path.strain.empty()) out["strain_energy"] = path.strain.back();
  int number = 0;
  for (const double limit : limit_loads(path.arc, path.factor))
    out["limit_load_" + std::to_string(++number)] = limit;
  out["completed"] = path.result.completed;
  out["rejected_steps"] = path.result.rejected;
  out["newton_iterations"] = path.result.iterations;
  set_condition(out, path.result.condition);
  out["observed"] = last_values(path.observed);
  if (!path.measured.empty()) out["measured"] = last_values(path.measured);
  return out;
}

/// How far the trajectory's body was from its path at worst.
Json trajectory_errors(const Scene& scene, const RunReport& report) {
  const std::string& body = scene.trajectory->body;
  Json out = Json::object();
  out["body"] = body;
  const auto add = [&](const std::string& prefix, const MotionRecord& motion) {
    for (const char* quantity : {"delta_x", "delta_y", "delta_angle"}) {
      const LargestError error = largest_error(motion, body, quantity);
      out[prefix + quantity] = error.size;
      out[prefix + quantity + "_time"] = error.time;
    }
  };
  add("", *report.judging());
  if (report.judging_uniform()) add("uniform_", *report.judging_uniform());
  if (report.verified) add("scene_mesh_", *report.motion);
  return out;
}

Json motion_results(const Scene& scene, const RunReport& report) {
  const MotionRecord& motion = *report.motion;
  const fem::MotionResult& r = motion.result;
  Json out = Json::object();
  // Of final designs: what judges them, and what is like it.
  if (!report.outcomes.empty()) {
    out["judged_on"] = scene.verify && report.verified ? scene.verify->words() : "the scene's mesh";
    out["strain_energy_integral"] = report.judging()->strain_integral;
    if (report.judging_uniform())
      out["uniform_strain_energy_integral"] = report.judging_uniform()->strain_integral;
    if (report.verified) out["scene_mesh_strain_energy_integral"] = motion.strain_integral;
  }
  out["steps"] = r.counts.steps;
  out["newton_iterations"] = r.counts.newton;
  out["factorizations"] = r.counts.factorizations;
  out["rejected_steps"] = r.counts.rejected;
  if (r.counts.evaluations > 0) {
    out["evaluations"] = r.counts.evaluations;
    out["partitions"] = r.counts.partitions;
  }
  if (scene.time.tolerance) {
    out["inaccurate_steps"] = r.counts.inaccurate;
    out["smallest_step"] = r.smallest_step;
  }
  out["largest_step"] = r.largest_step;
  out["energy_defect"] = r.energy_defect;
  if (!motion.written.empty()) out["balance"] = last_values(motion.written);
  out["constraint_drift"] = r.constraint_drift;
  out["velocity_drift"] = r.velocity_drift;
  out["smallest_area_ratio"] = r.smallest_area_ratio;
  set_condition(out, r.condition);
  Json events = Json::array();
  for (const fem::MeshEvent& e : r.events) {
    Json event = Json::object();
    event["time"] = e.time;
    event["body"] = e.body;
    event["change"] = e.change == fem::MeshChange::insertion ? "insertion" : "removal";
    event["kinetic_jump"] = e.after.kinetic - e.before.kinetic;
    event["strain_jump"] = e.after.strain - e.before.strain;
    event["momentum_jump"] = (e.momentum_after - e.momentum_before).norm();
    event["tip_jump"] = e.tip_jump;
    events.push_back(std::move(event));
  }
  out["events"] = std::move(events);
  if (!motion.observed.empty()) out["observed"] = last_values(motion.observed);
  if (!motion.measured.empty()) out["measured"] = last_values(motion.measured);
  if (scene.trajectory) out["platform_error"] = trajectory_errors(scene, report);
  return out;
}

Json expectations(const Scene& scene, const RunReport& report) {
  Json out = Json::object();
  for (const Expected& expected : judge_expectations(scene, report)) {
    Json entry = Json::object();
    entry["found"] = expected.found ? Json(*expected.found) : Json();
    entry["holds"] = expected.holds;
    out[expected.name] = std::move(entry);
  }
  return out;
}

Json cycle_results(const mmc::CycleVerdict& v) {
  Json out = Json::object();
  out["cycle"] = v.cycle;
  out["objective"] = v.objective;
  Json bodies = Json::array();
  for (const mmc::BodyVerdict& b : v.bodies) {
    Json body = Json::object();
    body["body"] = b.body;
    body["compliance"] = b.compliance;
    body["sharp_compliance"] = b.sharp_compliance;
    body["design_change"] = b.design_change;
    bodies.push_back(std::move(body));
  }
  out["bodies"] = std::move(bodies);
  out["strain_energy_integral"] = v.strain_energy_integral;
  out["best"] = v.best;
  return out;
}

Json corrected_results(const mmc::CorrectedCycle& c) {
  Json out = Json::object();
  out["cycle"] = c.cycle;
  out["objective"] = c.value;
  out["kkt"] = c.kkt;
  out["angle"] = c.angle;
  out["radius"] = c.radius;
  out["predicted"] = c.predicted;
  out["actual"] = std::isfinite(c.actual) ? Json(c.actual) : Json();
  out["accepted"] = c.accepted;
  out["motions"] = c.motions;
  out["seconds"] = c.seconds;
  return out;
}

Json certificate_results(const mmc::MotionCertificate& c) {
  Json out = Json::object();
  out["objective"] = c.objective;
  out["value"] = c.value;
  out["sharp_value"] = c.sharp_value;
  out["kkt"] = c.kkt;
  out["angle"] = c.angle;
  out["left"] = c.left;
  out["move_limit"] = c.move_limit;
  out["seconds"] = c.seconds;
  return out;
}

Json heat_results(const Scene& scene) {
  Json out = Json::array();
  for (const Body& body : scene.bodies) {
    if (!body.heat) continue;
    Json hot = Json::object();
    hot["body"] = body.name;
    hot["temperature"] = temperature_words(*body.heat);
    hot["expansion"] = body.heat->expansion;
    hot["thermal_volume"] = volume_name(body.heat->volume);
    hot["force"] = body.heat->force;
    out.push_back(std::move(hot));
  }
  return out;
}

/// What bodies with one budget take of it, if there are such.
std::optional<Json> shared_mass(const RunReport& report) {
  double used = 0, allowed = 0;
  for (size_t i = 0; i < report.outcomes.size(); ++i) {
    const mmc::BodyProblem& p = report.problems[i];
    if (!p.shares_mass) continue;
    used += mmc::full_mass_of(p) * report.outcomes[i].volume;
    allowed += mmc::full_mass_of(p) * mmc::allowed_volume(p.goal).value_or(1);
  }
  if (allowed == 0) return {};
  Json out = Json::object();
  out["used"] = used;
  out["allowed"] = allowed;
  return out;
}

Json failure_results(const Failure& f) {
  Json out = Json::object();
  if (!f.phase.empty()) out["phase"] = f.phase;
  if (!f.body.empty()) out["body"] = f.body;
  const auto set = [&](const char* key, const auto& value) {
    if (value) out[key] = *value;
  };
  set("time", f.time);
  set("load_factor", f.load_factor);
  set("step", f.step);
  set("cycle", f.cycle);
  set("iteration", f.iteration);
  out["kind"] = f.kind;
  out["cause"] = f.cause;
  return out;
}

}  // namespace

std::string certificate_json(const mmc::MotionCertificate& certificate) {
  return certificate_results(certificate).dump();
}

std::string run_json(const Scene& scene, const RunReport& report) {
  Json out = Json::object();
  out["case"] = scene.name;
  out["title"] = scene.title;
  out["version"] = kVersion;
  Json libraries = Json::object();
  for (const auto& [name, version] : library_versions()) libraries[name] = version;
  out["libraries"] = std::move(libraries);
  out["blas_kernel"] = fem::blas_kernel();
  out["threads"] = report.threads;
  out["status"] = report.status;
  if (!report.message.empty()) out["message"] = report.message;
  if (report.failure) out["failure"] = failure_results(*report.failure);
  out["seconds_wall"] = report.seconds_wall;
  out["seconds_cpu"] = report.seconds_cpu;
  if (!report.phases.empty()) {
    Json phases = Json::object();
    for (const auto& [name, seconds] : report.phases) phases["seconds_" + name] = seconds;
    out["seconds_by_phase"] = std::move(phases);
  }
  out["peak_memory_bytes"] = static_cast<long long>(report.peak_memory_bytes);
  Json warnings = Json::array();
  for (const Warning& each : warnings_of(scene, report)) warnings.push_back(each.words);
  out["warnings"] = std::move(warnings);
  if (report.motion && !report.motion->remarks.empty()) out["remarks"] = report.motion->remarks;
  Json results = Json::array();
  for (size_t i = 0; i < report.outcomes.size(); ++i) results.push_back(body_results(report, i));
  out["results"] = std::move(results);
  if (!report.outcomes.empty()) out["drawing_unit"] = scene.output.unit.name;
  if (std::optional<Json> shared = shared_mass(report)) out["shared_mass"] = std::move(*shared);
  if (!report.verdicts.empty()) {
    Json cycles = Json::array();
    for (const mmc::CycleVerdict& v : report.verdicts) cycles.push_back(cycle_results(v));
    out["cycles"] = std::move(cycles);
  }
  if (!report.corrections.empty()) {
    Json cycles = Json::array();
    for (const mmc::CorrectedCycle& c : report.corrections) cycles.push_back(corrected_results(c));
    out["corrected_cycles"] = std::move(cycles);
  }
  if (report.corrected) {
    Json corrected = Json::object();
    corrected["sharp_before"] = report.corrected->before;
    corrected["sharp_after"] = report.corrected->after;
    corrected["kept"] = report.corrected->pays();
    out["corrected"] = std::move(corrected);
  }
  if (report.certificate) out["certificate"] = certificate_results(*report.certificate);
  if (scene.has_heat()) out["heat"] = heat_results(scene);
  if (report.motion) out["motion"] = motion_results(scene, report);
  if (report.path) out["static"] = path_results(*report.path);
  if (!scene.expect.empty()) out["expect"] = expectations(scene, report);
  return io::json_text(out);
}

}  // namespace flexmorph::cases
