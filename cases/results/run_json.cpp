#include "cases/results/run_json.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "cases/results/limit_points.h"
#include "cases/results/schema.h"
#include "cases/scene/design/goal.h"
#include "cases/scene/heat/heat.h"
#include "cases/scene/version.h"
#include "fem/solve/linear_solver.h"
#include "geometry/processor_name.h"
#include "io/json.h"

namespace flexmorph::cases {
namespace {

using Json = nlohmann::ordered_json;

/// Adds the numbers of a table that exist for the source.
template <class Source>
void add(Json& out, std::span<const ResultQuantity<Source>> table, const Source& source) {
  for (const ResultQuantity<Source>& q : table)
    if (const Value value = q.value(source); !std::holds_alternative<std::monostate>(value))
      out[q.name] = json_of(value);
}
template <class Source>
Json object_of(std::span<const ResultQuantity<Source>> table, const Source& source) {
  Json out = Json::object();
  add(out, table, source);
  return out;
}

/// Returns the smallest half-thickness of all components along their axes [m].
double thinnest(const mmc::BodyProblem& problem) {
  double out = problem.grid.width;
  for (const Component& c : problem.design.components())
    for (int k = 0; k <= 200; ++k)
      out = std::min(
          out,
          profile(c, c.half_length * (k / 100.0 - 1), problem.bands.back().min_half_thickness).g);
  return out;
}

/// Returns the meaning of the column `scaled_objective` of history.csv, which is the objective in
/// the form that is passed to optimizers.
std::string objective_text(const mmc::BodyProblem& p) {
  const mmc::ResponseRow& row = *p.goal.objective;
  const std::string of = std::string(row.words).append(" [").append(row.unit).append("]");
  if (p.shares_mass)
    return "natural logarithm of the " + of + ", summed over bodies that share mass";
  return row.full ? of + " divided by its value for the full plate"
                  : "natural logarithm of the " + of;
}

Json outline_results(const VerifiedOutline& outline, double crisp_compliance) {
  Json out = object_of(outline_quantities(), outline);
  if (!outline.verification || !std::isfinite(outline.verification->compliance)) return out;
  const verification::OutlineVerification& v = *outline.verification;
  out["cells_over_this"] = crisp_compliance / v.compliance - 1;
  out["largest_stress_at"] = {v.largest_at.x(), v.largest_at.y()};
  if (!v.mesh_loads.empty()) {
    Json exported = Json::object();  // results of the first load of design.inp
    exported["load"] = v.mesh_loads.front().load + 1;
    exported["compliance"] = v.mesh_loads.front().compliance;
    exported["largest_stress"] = v.shown_stress.value;
    exported["largest_stress_at"] = {v.shown_stress.at.x(), v.shown_stress.at.y()};
    out["exported"] = std::move(exported);
  }
  return out;
}

/// Adds the largest tip deflections of a body; they are null for a body between two pins.
void add_amplitudes(Json& out, const MotionResults& motions, const std::string& body) {
  const auto amplitude = [&](const std::optional<MotionRecord>& motion) {
    const std::optional<double> found = motion ? motion->amplitude(body) : std::nullopt;
    return found ? Json(*found) : Json();
  };
  out["dynamic_amplitude"] = amplitude(motions.assessed());
  out["uniform_dynamic_amplitude"] = amplitude(motions.assessed_uniform());
  out["scene_mesh_amplitude"] = amplitude(motions.motion);
  out["scene_mesh_uniform_amplitude"] = amplitude(motions.uniform);
}

Json body_results(const RunResult& result, size_t i) {
  const DesignResult& design = result.design;
  const mmc::BodyOutcome& o = design.outcomes[i];
  Json out = Json::object();
  out["body"] = o.body;
  add(out, design_quantities(), o);
  for (const auto& [name, value] : o.further) {
    out[name] = value;
    out["crisp_" + name] = o.crisp.further.at(name);
  }
  if (i < design.outlines.size())
    out["body_fitted"] = outline_results(design.outlines[i], o.crisp.compliance);
  if (o.length_scale) out["length_scale"] = object_of(length_scale_quantities(), o);
  if (!o.of_part) out["thinnest_component"] = thinnest(design.problems[i]);
  add_amplitudes(out, result.motions, o.body);
  if (const auto tip = tip_variation(result.motions, o.body))
    out["tip"] = object_of(point_quantities(), *tip);
  for (const PointVariation& point : point_variations(result.motions, o.body))
    out["points"].push_back(object_of(point_quantities(), point));
  for (const StaticLoad& load : design.static_loads)
    out["load_cases"].push_back(object_of(static_load_quantities(), load));
  for (const mmc::LoadDifference& d : design.load_differences)
    if (d.body == o.body) out["load_difference"] = object_of(load_difference_quantities(), d);
  if (!o.of_part) out["scaled_objective"] = objective_text(design.problems[i]);
  out["cycles"] = design.cycles;
  Json active = Json::array();  // numbers (from 1) of loads within 1 % of the largest compliance
  for (size_t l = 0; l < o.load_compliances.size(); ++l)
    if (o.load_compliances[l] >= 0.99 * o.worst_compliance)
      active.push_back(static_cast<int>(l + 1));
  out["active_loads"] = std::move(active);
  if (!o.of_part) out["components"] = design.problems[i].design.n_components();
  return out;
}

/// Returns the last values of the columns of a group, by their names.
Json last_values(const Series& table, ColumnGroup group) {
  Json out = Json::object();
  for (const size_t c : table.of_group(group))
    if (!table.values[c].empty()) out[table.columns[c].name] = table.values[c].back();
  return out;
}

/// Adds the last values of observed points and measured quantities if there are such columns.
void add_last_values(Json& out, const Series& table) {
  if (!table.of_group(ColumnGroup::observed).empty())
    out["observed"] = last_values(table, ColumnGroup::observed);
  if (!table.of_group(ColumnGroup::measured).empty())
    out["measured"] = last_values(table, ColumnGroup::measured);
}

Json path_results(const PathRecord& path) {
  Json out = object_of(path_quantities(), path);
  int number = 0;
  for (const double limit : limit_loads(path.arc, path.table.at(kFactorColumn)))
    out["limit_load_" + std::to_string(++number)] = limit;
  add_last_values(out, path.table);
  return out;
}

/// Returns the largest deviations of a body from its trajectory, and their times.
Json trajectory_errors(const Scene& scene, const MotionResults& motions) {
  const std::string& body = scene.trajectory->body;
  Json out = Json::object();
  out["body"] = body;
  const auto add_errors = [&](const std::string& prefix, const MotionRecord& motion) {
    for (const char* quantity : {"delta_x", "delta_y", "delta_angle"}) {
      const LargestError error = largest_error(motion, body, quantity);
      out[prefix + quantity] = error.size;
      out[prefix + quantity + "_time"] = error.time;
    }
  };
  add_errors("", *motions.assessed());
  if (motions.assessed_uniform()) add_errors("uniform_", *motions.assessed_uniform());
  if (motions.verified) add_errors("scene_mesh_", *motions.motion);
  return out;
}

Json mesh_events(const fem::MotionResult& r) {
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
  return events;
}

Json motion_results(const Scene& scene, const RunResult& result) {
  const MotionResults& motions = result.motions;
  const MotionRecord& motion = *motions.motion;
  Json out = Json::object();
  if (!result.design.outcomes.empty()) {
    out["verified_on"] =
        scene.verify && motions.verified ? scene.verify->words() : "the mesh of the case";
    out["strain_energy_integral"] = motions.assessed()->strain_integral();
    if (motions.assessed_uniform())
      out["uniform_strain_energy_integral"] = motions.assessed_uniform()->strain_integral();
    if (motions.verified) out["scene_mesh_strain_energy_integral"] = motion.strain_integral();
  }
  add(out, motion_quantities(), motion.result);
  if (scene.time.tolerance) {
    out["inaccurate_steps"] = motion.result.counts.inaccurate;
    out["smallest_step"] = motion.result.smallest_step;
  }
  if (!motion.table.of_group(ColumnGroup::term).empty())
    out["balance"] = last_values(motion.table, ColumnGroup::term);
  out["events"] = mesh_events(motion.result);
  add_last_values(out, motion.table);
  if (scene.trajectory) out["platform_error"] = trajectory_errors(scene, motions);
  return out;
}

Json expectations(const std::vector<Expected>& all) {
  Json out = Json::object();
  for (const Expected& expected : all) {
    Json entry = Json::object();
    entry["found"] = expected.found ? Json(*expected.found) : Json();
    entry["holds"] = expected.holds;
    out[expected.name] = std::move(entry);
  }
  return out;
}

Json cycle_results(const mmc::CycleVerdict& v) {
  Json out = object_of(cycle_quantities(), v);
  Json bodies = Json::array();
  for (const mmc::BodyVerdict& b : v.bodies)
    bodies.push_back({{"body", b.body},
                      {"compliance", b.compliance},
                      {"crisp_compliance", b.crisp_compliance},
                      {"design_change", b.design_change}});
  out["bodies"] = std::move(bodies);
  return out;
}

Json heat_results(const Scene& scene) {
  Json out = Json::array();
  for (const Body& body : scene.bodies) {
    if (!body.heat) continue;
    Json hot = Json::object();
    hot["body"] = body.name;
    hot["temperature"] = temperature_text(*body.heat);
    hot["expansion"] = body.heat->expansion;
    hot["thermal_volume"] = volume_name(body.heat->volume);
    hot["force"] = body.heat->force;
    out.push_back(std::move(hot));
  }
  return out;
}

/// Returns the used and the allowed mass of the bodies that share a mass limit; nothing if no
/// bodies share mass.
std::optional<Json> shared_mass(const DesignResult& design) {
  double used = 0, allowed = 0;
  for (size_t i = 0; i < design.outcomes.size(); ++i) {
    const mmc::BodyProblem& p = design.problems[i];
    if (!p.shares_mass) continue;
    used += mmc::full_mass_of(p) * design.outcomes[i].volume;
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
  set("seconds_limit", f.seconds_limit);
  out["cause"] = f.cause;
  return out;
}

/// Returns version, libraries, status and times of a run.
Json info_results(const Scene& scene, const RunResult& result) {
  const RunInfo& info = result.info;
  Json out = Json::object();
  out["case"] = scene.name;
  out["title"] = scene.title;
  out["version"] = kVersion;
  if (*kCommit) out["commit"] = kCommit;
  Json libraries = Json::object();
  for (const auto& [name, version] : library_versions()) libraries[name] = version;
  out["libraries"] = std::move(libraries);
  out["processor"] = processor_name();
  out["blas_kernel"] = fem::blas_kernel();
  out["vectors"] = vector_level_name();
  out["threads"] = info.threads;
  out["status"] = info.status;
  if (!info.message.empty()) out["message"] = info.message;
  if (result.failure) out["failure"] = failure_results(*result.failure);
  out["seconds_wall"] = info.seconds_wall;
  out["seconds_cpu"] = info.seconds_cpu;
  if (!info.phases.empty()) {
    Json phases = Json::object();
    for (const auto& [name, seconds] : info.phases) phases["seconds_" + name] = seconds;
    out["seconds_by_phase"] = std::move(phases);
  }
  out["peak_memory_bytes"] = static_cast<long long>(info.peak_memory_bytes);
  Json warnings = Json::array();
  for (const Warning& each : result.warnings) warnings.push_back(each.words);
  out["warnings"] = std::move(warnings);
  return out;
}

void add_designs(Json& out, const Scene& scene, const RunResult& result) {
  const DesignResult& design = result.design;
  Json results = Json::array();
  for (size_t i = 0; i < design.outcomes.size(); ++i) results.push_back(body_results(result, i));
  out["results"] = std::move(results);
  if (!design.outcomes.empty()) out["drawing_unit"] = scene.output.unit.name;
  if (std::optional<Json> shared = shared_mass(design)) out["shared_mass"] = std::move(*shared);
  for (const mmc::CycleVerdict& v : design.verdicts) out["cycles"].push_back(cycle_results(v));
  for (const mmc::CorrectedCycle& c : design.corrections)
    out["corrected_cycles"].push_back(object_of(corrected_cycle_quantities(), c));
  if (design.corrected)
    out["corrected"] = {{"crisp_before", design.corrected->before},
                        {"crisp_after", design.corrected->after},
                        {"kept", design.corrected->improves()}};
  if (design.certificate)
    out["certificate"] = object_of(certificate_quantities(), *design.certificate);
}

Json comparison_results(const PartComparison& comparison) {
  Json out = Json::object();
  for (const auto& [body, path] : comparison.files) out["parts"][body] = path;
  if (!comparison.design.empty()) out["design"] = comparison.design;
  out["notes"] = comparison.notes;
  Json numbers = Json::array();
  for (const ComparedNumber& n : comparison.numbers) {
    Json& row = numbers.emplace_back(Json::object());
    if (!n.body.empty()) row["body"] = n.body;
    row["name"] = n.name;
    row["unit"] = n.unit;
    if (n.part) row["part"] = *n.part;
    if (n.design) row["design"] = *n.design;
    if (n.uniform) row["uniform"] = *n.uniform;
  }
  out["numbers"] = std::move(numbers);
  return out;
}

}  // namespace

std::string certificate_json(const mmc::OptimalityCertificate& certificate) {
  return object_of(certificate_quantities(), certificate).dump();
}

std::string run_json(const Scene& scene, const RunResult& result) {
  Json out = info_results(scene, result);
  const std::optional<MotionRecord>& motion = result.motions.motion;
  if (motion && !motion->remarks.empty()) out["remarks"] = motion->remarks;
  add_designs(out, scene, result);
  if (scene.has_heat()) out["heat"] = heat_results(scene);
  if (motion) out["motion"] = motion_results(scene, result);
  if (result.path) out["static"] = path_results(*result.path);
  if (result.comparison) out["verify"] = comparison_results(*result.comparison);
  if (!scene.expect.empty()) out["expect"] = expectations(result.expectations);
  return io::json_text(out);
}

}  // namespace flexmorph::cases
