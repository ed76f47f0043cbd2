#include "cases/run/report.h"

#include <cmath>

#include "cases/run/expectations.h"
#include "cases/run/plots/measured.h"
#include "cases/run/plots/mechanism.h"
#include "cases/run/plots/run.h"
#include "cases/run/run_warnings.h"
#include "cases/run/version.h"
#include "cases/scene/design/goal.h"
#include "cases/scene/heat/heat.h"
#include "fem/solve/linear_solver.h"
#include "io/files.h"

namespace flexmorph::cases {
namespace {

constexpr size_t kShapes = 4;  // pictures of a plate in space

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
void set_condition(io::Json& out, const std::optional<double>& condition) {
  if (condition && std::isfinite(*condition)) out.set("condition", *condition);
}

io::Json body_results(const RunReport& report, size_t i) {
  const mmc::BodyOutcome& o = report.outcomes[i];
  io::Json out = io::Json::object();
  out.set("body", o.body);
  out.set("compliance", o.compliance).set("volume", o.volume);
  out.set("sharp_compliance", o.sharp.compliance).set("sharp_volume", o.sharp.volume);
  for (const auto& [name, value] : o.further)
    out.set(name, value).set("sharp_" + name, o.sharp.further.at(name));
  out.set("uniform_compliance", o.uniform_compliance);
  out.set("connected", o.sharp.connectivity.connected).set("islands", o.sharp.connectivity.islands);
  const auto width = [&](double Features::*which) {
    const bool there = o.sharp.features && std::isfinite((*o.sharp.features).*which);
    return there ? io::Json((*o.sharp.features).*which) : io::Json();
  };
  out.set("min_feature", width(&Features::solid)).set("min_gap", width(&Features::gap));
  if (o.clean_up) {
    const mmc::CleanUp& c = *o.clean_up;
    io::Json clean = io::Json::object();
    clean.set("min_feature_wanted", c.wanted).set("min_feature_before", c.before);
    clean.set("compliance_before", c.compliance_before);
    clean.set("compliance_cost", c.compliance_after / c.compliance_before - 1);
    clean.set("patches", c.patches).set("dropped", c.dropped).set("rounds", c.rounds);
    clean.set("reached", c.reached());
    out.set("clean_up", std::move(clean));
  }
  out.set("thinnest_component", thinnest(report.problems[i]));
  const auto amplitude = [&](const std::optional<MotionRecord>& motion) {
    if (!motion) return io::Json();
    const auto found = std::find(motion->bodies.begin(), motion->bodies.end(), o.body);
    return io::Json(motion->amplitude.at(static_cast<size_t>(found - motion->bodies.begin())));
  };
  const bool finer = report.verified.has_value();
  out.set("dynamic_amplitude", amplitude(finer ? report.verified : report.motion));
  out.set("uniform_dynamic_amplitude",
          amplitude(finer ? report.verified_uniform : report.uniform_motion));
  out.set("scene_mesh_amplitude", amplitude(report.motion));
  out.set("scene_mesh_uniform_amplitude", amplitude(report.uniform_motion));
  out.set("cycles", report.cycles).set("iterations", o.iterations);
  out.set("state_solves", o.evaluations).set("kkt", o.kkt);
  out.set("factorizations", o.factorizations).set("worst_compliance", o.worst_compliance);
  set_condition(out, o.condition);
  io::Json active = io::Json::array();  // loads within 1 % of the worst, from 1
  for (size_t l = 0; l < o.load_compliances.size(); ++l)
    if (o.load_compliances[l] >= 0.99 * o.worst_compliance) active.push(static_cast<int>(l + 1));
  out.set("active_loads", std::move(active));
  out.set("loads", o.n_loads).set("right_hand_sides", o.n_right_hand_sides);
  out.set("components", report.problems[i].design.n_components());
  out.set("component_changes", static_cast<int>(o.events.size())).set("stop", o.stop);
  return out;
}

/// Last values of columns, by their names.
io::Json last_values(const std::vector<Column>& columns) {
  io::Json out = io::Json::object();
  for (const Column& column : columns)
    if (!column.values.empty()) out.set(column.name, column.values.back());
  return out;
}

io::Json path_results(const PathRecord& path) {
  io::Json out = io::Json::object();
  out.set("equilibria", static_cast<int>(path.factor.size()));
  if (!path.factor.empty()) out.set("load_factor", path.factor.back());
  if (!path.strain.empty()) out.set("strain_energy", path.strain.back());
  out.set("completed", path.result.completed).set("rejected_steps", path.result.rejected);
  out.set("newton_iterations", path.result.iterations);
  set_condition(out, path.result.condition);
  out.set("observed", last_values(path.observed));
  if (!path.measured.empty()) out.set("measured", last_values(path.measured));
  return out;
}

/// How far the trajectory's body was from its path at worst.
io::Json trajectory_errors(const Scene& scene, const RunReport& report) {
  const std::string& body = scene.trajectory->body;
  io::Json out = io::Json::object();
  out.set("body", body);
  const auto add = [&](const std::string& prefix, const MotionRecord& motion) {
    for (const char* quantity : {"delta_x", "delta_y", "delta_angle"}) {
      const LargestError error = largest_error(motion, body, quantity);
      out.set(prefix + quantity, error.size).set(prefix + quantity + "_time", error.time);
    }
  };
  add("", *report.motion);
  if (report.uniform_motion) add("uniform_", *report.uniform_motion);
  return out;
}

io::Json motion_results(const Scene& scene, const RunReport& report) {
  const MotionRecord& motion = *report.motion;
  const fem::MotionResult& r = motion.result;
  io::Json out = io::Json::object();
  out.set("steps", r.counts.steps).set("newton_iterations", r.counts.newton);
  out.set("factorizations", r.counts.factorizations).set("rejected_steps", r.counts.rejected);
  if (r.counts.evaluations > 0)
    out.set("evaluations", r.counts.evaluations).set("partitions", r.counts.partitions);
  if (scene.time.tolerance)
    out.set("inaccurate_steps", r.counts.inaccurate)
        .set("smallest_step", r.smallest_step)
        .set("largest_step", r.largest_step);
  out.set("energy_defect", r.energy_defect);
  if (!motion.written.empty()) out.set("balance", last_values(motion.written));
  out.set("constraint_drift", r.constraint_drift);
  out.set("velocity_drift", r.velocity_drift).set("smallest_area_ratio", r.smallest_area_ratio);
  set_condition(out, r.condition);
  io::Json events = io::Json::array();
  for (const fem::MeshEvent& e : r.events) {
    io::Json event = io::Json::object();
    event.set("time", e.time).set("body", e.body);
    event.set("change", e.change == fem::MeshChange::insertion ? "insertion" : "removal");
    event.set("kinetic_jump", e.after.kinetic - e.before.kinetic);
    event.set("strain_jump", e.after.strain - e.before.strain);
    event.set("momentum_jump", (e.momentum_after - e.momentum_before).norm());
    event.set("tip_jump", e.tip_jump);
    events.push(std::move(event));
  }
  out.set("events", std::move(events));
  if (!motion.observed.empty()) out.set("observed", last_values(motion.observed));
  if (!motion.measured.empty()) out.set("measured", last_values(motion.measured));
  if (scene.trajectory) out.set("platform_error", trajectory_errors(scene, report));
  return out;
}

io::Json expectations(const Scene& scene, const RunReport& report) {
  io::Json out = io::Json::object();
  for (const Expected& expected : judge_expectations(scene, report)) {
    io::Json entry = io::Json::object();
    entry.set("found", expected.found ? io::Json(*expected.found) : io::Json());
    entry.set("holds", expected.holds);
    out.set(expected.name, std::move(entry));
  }
  return out;
}

io::Json cycle_results(const mmc::CycleVerdict& v) {
  io::Json out = io::Json::object();
  out.set("cycle", v.cycle).set("objective", v.objective);
  io::Json bodies = io::Json::array();
  for (const mmc::BodyVerdict& b : v.bodies) {
    io::Json body = io::Json::object();
    body.set("body", b.body).set("compliance", b.compliance);
    body.set("sharp_compliance", b.sharp_compliance).set("design_change", b.design_change);
    bodies.push(std::move(body));
  }
  out.set("bodies", std::move(bodies));
  out.set("strain_energy_integral", v.strain_energy_integral).set("best", v.best);
  return out;
}

io::Json heat_results(const Scene& scene) {
  io::Json out = io::Json::array();
  for (const Body& body : scene.bodies) {
    if (!body.heat) continue;
    io::Json hot = io::Json::object();
    hot.set("body", body.name).set("temperature", temperature_words(*body.heat));
    hot.set("expansion", body.heat->expansion);
    hot.set("thermal_volume", volume_name(body.heat->volume)).set("force", body.heat->force);
    out.push(std::move(hot));
  }
  return out;
}

/// What bodies with one budget take of it, if there are such.
std::optional<io::Json> shared_mass(const RunReport& report) {
  double used = 0, allowed = 0;
  for (size_t i = 0; i < report.outcomes.size(); ++i) {
    const mmc::BodyProblem& p = report.problems[i];
    if (!p.shares_mass) continue;
    used += mmc::full_mass_of(p) * report.outcomes[i].volume;
    allowed += mmc::full_mass_of(p) * mmc::allowed_volume(p.goal).value_or(1);
  }
  if (allowed == 0) return {};
  io::Json out = io::Json::object();
  out.set("used", used).set("allowed", allowed);
  return out;
}

std::string run_json(const Scene& scene, const RunReport& report) {
  io::Json out = io::Json::object();
  out.set("case", scene.name).set("title", scene.title).set("version", kVersion);
  io::Json libraries = io::Json::object();
  for (const auto& [name, version] : library_versions()) libraries.set(name, version);
  out.set("libraries", std::move(libraries)).set("blas_kernel", fem::blas_kernel());
  out.set("threads", report.threads).set("status", report.status);
  if (!report.message.empty()) out.set("message", report.message);
  out.set("seconds_wall", report.seconds_wall).set("seconds_cpu", report.seconds_cpu);
  out.set("peak_memory_bytes", report.peak_memory_bytes);
  io::Json warnings = io::Json::array();
  for (const std::string& words : warnings_of(scene, report)) warnings.push(words);
  out.set("warnings", std::move(warnings));
  io::Json results = io::Json::array();
  for (size_t i = 0; i < report.outcomes.size(); ++i) results.push(body_results(report, i));
  out.set("results", std::move(results));
  if (std::optional<io::Json> shared = shared_mass(report))
    out.set("shared_mass", std::move(*shared));
  if (!report.verdicts.empty()) {
    io::Json cycles = io::Json::array();
    for (const mmc::CycleVerdict& v : report.verdicts) cycles.push(cycle_results(v));
    out.set("cycles", std::move(cycles));
  }
  if (scene.has_heat()) out.set("heat", heat_results(scene));
  if (report.motion) out.set("motion", motion_results(scene, report));
  if (report.path) out.set("static", path_results(*report.path));
  if (!scene.expect.empty()) out.set("expect", expectations(scene, report));
  return out.text();
}

io::ReportSection results_section(const Scene& scene, const RunReport& report) {
  io::ReportSection out;
  out.heading = "Results";
  out.rows.push_back({"body", "compliance [J]", "volume", "sharp compliance [J]", "sharp volume",
                      "uniform compliance [J]", "sharp / uniform", "connected", "iterations",
                      "state solves", "stopped"});
  for (const mmc::BodyOutcome& o : report.outcomes)
    out.rows.push_back({o.body, io::to_text(o.compliance, 6), io::to_text(o.volume, 5),
                        io::to_text(o.sharp.compliance, 6), io::to_text(o.sharp.volume, 5),
                        io::to_text(o.uniform_compliance, 6),
                        io::to_text(o.sharp.compliance / o.uniform_compliance, 4),
                        o.sharp.connectivity.connected ? "yes" : "no", io::to_text(o.iterations),
                        io::to_text(o.evaluations), o.stop});
  for (const mmc::ResponseRow* row : further_rows(scene)) {
    const std::string name = mmc::key_of(*row);
    const std::string words = std::string(row->words).append(" [").append(row->unit).append("]");
    out.rows[0].insert(out.rows[0].end(), {words, "sharp " + words});
    for (size_t i = 0; i < report.outcomes.size(); ++i)
      for (const mmc::Figures* figures :
           {&report.outcomes[i].further, &report.outcomes[i].sharp.further})
        out.rows[i + 1].push_back(figures->contains(name) ? io::to_text(figures->at(name), 6) : "");
  }
  return out;
}

/// Expectations that were missed come before everything else.
io::ReportSection expect_section(const Scene& scene, const RunReport& report) {
  io::ReportSection out;
  out.heading = "Expected";
  out.rows.push_back({"", "number, what was found and what was expected"});
  for (const bool holds : {false, true})
    for (const Expected& expected : judge_expectations(scene, report))
      if (expected.holds == holds) out.rows.push_back({holds ? "met" : "MISSED", expected.words});
  return out;
}

io::ReportSection heat_section(const Scene& scene) {
  io::ReportSection out;
  out.heading = "Heat";
  out.rows.push_back({"body", "temperature", "expansion [1/K]", "thermal volume", "thermal force"});
  for (const Body& body : scene.bodies)
    if (body.heat)
      out.rows.push_back({body.name, temperature_words(*body.heat),
                          io::to_text(body.heat->expansion, 6), volume_name(body.heat->volume),
                          body.heat->force ? "yes" : "no"});
  return out;
}

io::ReportSection design_section(const RunFolder::DesignPictures& pictures) {
  std::vector<std::string> all;
  if (!pictures.start.empty()) all.push_back(pictures.start);
  if (!pictures.result.empty()) all.push_back(pictures.result);
  io::ReportSection out;
  out.heading = "Components of " + pictures.body;
  out.words = all.size() > 1 ? "At the start and in the end." : "";
  out.pictures = std::move(all);
  return out;
}

/// Cycles beside each other: did the motion get better, and not only the loads' compliance?
io::ReportSection cycles_section(const RunReport& report) {
  io::ReportSection out;
  out.heading = "Cycles";
  out.rows.push_back({"cycle", "compliance of all [J]", "strain energy over time [J s]", "best"});
  std::vector<std::string>& header = out.rows.front();
  for (const mmc::BodyVerdict& b : report.verdicts.front().bodies)
    for (const char* what : {": compliance [J]", ": sharp compliance [J]", ": change of design"})
      header.push_back(b.body + what);
  for (const mmc::CycleVerdict& v : report.verdicts) {
    std::vector<std::string>& row = out.rows.emplace_back();
    row = {io::to_text(v.cycle), io::to_text(v.objective, 6),
           io::to_text(v.strain_energy_integral, 6), v.best ? "yes" : ""};
    for (const mmc::BodyVerdict& b : v.bodies)
      for (const double value : {b.compliance, b.sharp_compliance, b.design_change})
        row.push_back(io::to_text(value, 5));
  }
  return out;
}

}  // namespace

void write_report(const Scene& scene, const RunReport& report, RunFolder& folder) {
  folder.write_text("run.json", run_json(scene, report));
  if (report.status == "running") return;
  std::vector<io::ReportSection> sections;
  io::ReportSection head;
  head.heading = "Run";
  head.words = "Status: " + report.status + (report.message.empty() ? "" : " - " + report.message);
  sections.push_back(head);
  if (!scene.expect.empty() && report.status == "done")
    sections.push_back(expect_section(scene, report));
  if (scene.has_heat()) sections.push_back(heat_section(scene));
  if (!report.outcomes.empty()) sections.push_back(results_section(scene, report));
  if (!report.verdicts.empty()) sections.push_back(cycles_section(report));
  const auto add = [&](const std::string& name, const std::string& heading, std::string svg) {
    if (!scene.output.plots || svg.empty()) return;
    folder.write_text("plots/" + name + ".svg", svg);
    io::ReportSection section;
    section.heading = heading;
    section.pictures.push_back(std::move(svg));
    sections.push_back(std::move(section));
  };
  for (const RunFolder::DesignPictures& p : folder.design_pictures())
    sections.push_back(design_section(p));
  for (const RunFolder::History& h : folder.histories())
    add("convergence_" + h.body, "Convergence of " + h.body, convergence_plot(h));
  if (report.motion) {
    if (!report.motion->deflection.empty())
      add("deflection", "Tip deflection", deflection_plot(*report.motion, report.uniform_motion));
    if (!report.motion->observed.empty())
      add("observed", "Observed motion", observed_plot(*report.motion));
    if (!report.motion->measured.empty())
      add("measured", "Measured quantities", measured_plot(*report.motion));
    if (scene.is_mechanism()) {
      add("inputs", "Inputs", inputs_plot(scene));
      add("mechanism", "Mechanism in motion", moments_plot(*report.motion));
      if (scene.trajectory)
        add("error_" + scene.trajectory->body, "Error of " + scene.trajectory->body,
            error_plot(scene, *report.motion, report.uniform_motion));
    }
    add("joint_forces", "Joint forces", joint_forces_plot(scene, *report.motion));
    add("energies", "Energies of the motion", energy_plot(scene, *report.motion));
  }
  if (report.path) add("path", "Path of equilibria", path_plot(*report.path));
  if (const auto shapes = folder.shapes(kShapes); !shapes.empty())
    add("shapes", "Deformed shapes",
        io::surfaces_svg("Deformed shapes, light: strain energy", shapes));
  if (report.verified)
    add("deflection_verified", "Tip deflection on the finer mesh",
        deflection_plot(*report.verified, report.verified_uniform));
  folder.write_text("report.html", io::report_html(scene.title, sections));
}

}  // namespace flexmorph::cases
