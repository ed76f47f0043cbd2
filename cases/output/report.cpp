#include "cases/output/report.h"

#include <array>

#include "cases/output/plots/measured.h"
#include "cases/output/plots/mechanism.h"
#include "cases/output/plots/run.h"
#include "cases/output/plots/stress.h"
#include "cases/results/expectations.h"
#include "cases/results/run_json.h"
#include "cases/results/warnings.h"
#include "cases/run/corrections.h"
#include "cases/scene/design/goal.h"
#include "cases/scene/heat/heat.h"
#include "io/case_parser.h"
#include "io/files.h"

namespace flexmorph::cases {
namespace {

constexpr size_t kShapes = 4;  // pictures of a plate in space

/// Body-fitted compliance, its error and the volume of a body, where it was judged.
std::array<std::string, 3> judged_cells(const RunReport& report, const std::string& body) {
  for (const JudgedBody& j : report.judged)
    if (j.body == body && j.verdict)
      return {io::to_text(j.verdict->compliance, 6), io::to_text(100 * j.verdict->error, 2) + " %",
              io::to_text(j.volume, 5)};
  return {};
}

/// Columns as rows: many figures of few bodies.
std::vector<std::vector<std::string>> turned(const std::vector<std::vector<std::string>>& rows) {
  std::vector<std::vector<std::string>> out(rows.front().size());
  for (size_t k = 0; k < out.size(); ++k)
    for (const std::vector<std::string>& row : rows) out[k].push_back(row[k]);
  return out;
}

io::ReportSection results_section(const Scene& scene, const RunReport& report) {
  io::ReportSection out;
  out.heading = "Results";
  out.rows.push_back({"body", "compliance [J]", "volume", "sharp compliance [J]", "sharp volume",
                      "body-fitted compliance [J]", "estimated error", "body-fitted volume",
                      "uniform compliance [J]", "sharp / uniform", "connected", "iterations",
                      "state solves", "stopped"});
  for (const JudgedBody& j : report.judged)
    for (const mmc::BodyOutcome& o : report.outcomes)
      if (o.body == j.body)
        out.words += (out.words.empty() ? "" : " ") + judged_words(j, o.sharp.compliance) + ".";
  for (const mmc::BodyOutcome& o : report.outcomes) {
    const std::array<std::string, 3> judged = judged_cells(report, o.body);
    out.rows.push_back({o.body, io::to_text(o.compliance, 6), io::to_text(o.volume, 5),
                        io::to_text(o.sharp.compliance, 6), io::to_text(o.sharp.volume, 5),
                        judged[0], judged[1], judged[2], io::to_text(o.uniform_compliance, 6),
                        io::to_text(o.sharp.compliance / o.uniform_compliance, 4),
                        o.sharp.connectivity.connected ? "yes" : "no", io::to_text(o.iterations),
                        io::to_text(o.evaluations), o.stop});
  }
  for (const mmc::ResponseRow* row : further_rows(scene)) {
    const std::string name = mmc::key_of(*row);
    const std::string words = std::string(row->words).append(" [").append(row->unit).append("]");
    out.rows[0].insert(out.rows[0].end(), {words, "sharp " + words});
    for (size_t i = 0; i < report.outcomes.size(); ++i)
      for (const mmc::Figures* figures :
           {&report.outcomes[i].further, &report.outcomes[i].sharp.further})
        out.rows[i + 1].push_back(figures->contains(name) ? io::to_text(figures->at(name), 6) : "");
  }
  out.rows = turned(out.rows);
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

io::ReportSection design_section(const RunFolder::DesignPictures& pictures, const Output& output) {
  std::vector<std::string> all;
  if (!pictures.start.empty()) all.push_back(pictures.start);
  if (!pictures.result.empty()) all.push_back(pictures.result);
  io::ReportSection out;
  out.heading = "Components of " + pictures.body;
  out.words = all.size() > 1 ? "At the start and in the end. " : "";
  if (!pictures.result.empty())
    out.words += std::string("Its files .dxf and .stl are in ") + output.unit.name + ".";
  out.pictures = std::move(all);
  return out;
}

/// Cycles beside each other: did the motion get better, and not only the loads' compliance?
io::ReportSection cycles_section(const Scene& scene, const RunReport& report) {
  io::ReportSection out;
  out.heading = "Cycles";
  out.words = "Judged by the motion on " +
              (scene.judges_on_cells() ? scene.verify->words() : std::string("the scene's mesh")) +
              ".";
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

/// A drawing of every designed body in the run folder.
void add_drawings(const RunReport& report, const RunFolder& folder, const std::string& name,
                  io::ReportSection& out) {
  for (const mmc::BodyProblem& problem : report.problems)
    out.pictures.push_back(io::read_text(folder.path() + "/" + name +
                                         (report.problems.size() > 1 ? "_" + problem.body : "") +
                                         ".svg"));
}

/// Cycles of the motion itself.
io::ReportSection corrections_section(const RunReport& report, const RunFolder& folder) {
  io::ReportSection out;
  out.heading = "Cycles of the motion itself";
  if (report.corrected) out.words = corrected_words(*report.corrected) + ".";
  if (report.corrected && report.corrected->pays()) {
    out.words += " First the design for loads, then the corrected one.";
    add_drawings(report, folder, "design_esl", out);
    add_drawings(report, folder, "design", out);
  }
  out.rows.push_back({"cycle", "J", "KKT residual", "trust region", "predicted fall", "actual fall",
                      "taken", "motions", "CPU [s]"});
  for (const mmc::CorrectedCycle& c : report.corrections)
    out.rows.push_back({io::to_text(c.cycle), io::to_text(c.value, 6), io::to_text(c.kkt, 3),
                        io::to_text(c.radius, 3), io::to_text(c.predicted, 3),
                        io::to_text(c.actual, 3), c.accepted ? "yes" : "", io::to_text(c.motions),
                        io::to_text(c.seconds, 4)});
  return out;
}

io::ReportSection certificate_section(const RunReport& report, const RunFolder& folder) {
  io::ReportSection out;
  out.heading = "Certificate of the motion";
  out.words =
      certificate_words(*report.certificate) + ". Arrows: where the motion would move material.";
  add_drawings(report, folder, "certificate", out);
  return out;
}

}  // namespace

std::vector<std::pair<std::string, double>> phases_of(const RunReport& report,
                                                      const RunFolder& folder) {
  std::vector<std::pair<std::string, double>> out = folder.phases();
  if (out.empty()) return out;
  for (auto& [name, seconds] : out)
    if (name == "outlines")
      for (const mmc::BodyOutcome& o : report.outcomes) seconds += o.sharp.seconds_outlines;
  double judge = 0;
  for (const JudgedBody& j : report.judged) judge += j.seconds;
  out.emplace_back("mending", report.seconds_mending);
  out.emplace_back("motion", report.seconds_motion);
  out.emplace_back("judge", judge);
  out.emplace_back("verification", report.seconds_verification);
  return out;
}

void write_report(const Scene& scene, const RunReport& report, RunFolder& folder) {
  // "done" is written last: a run that says so has all its files.
  const bool done = report.status.starts_with("done");
  if (!done) folder.write_text("run.json", run_json(scene, report));
  if (report.status == "running") return;
  std::vector<io::ReportSection> sections;
  io::ReportSection head;
  head.heading = "Run";
  head.words = "Status: " + report.status + (report.message.empty() ? "" : " - " + report.message);
  if (report.motion)
    for (const std::string& each : report.motion->remarks) head.words += ". Note: " + each;
  for (const Warning& each : warnings_of(scene, report)) head.warnings.push_back(each.words);
  sections.push_back(head);
  if (!scene.expect.empty() && report.status.starts_with("done"))
    sections.push_back(expect_section(scene, report));
  if (scene.has_heat()) sections.push_back(heat_section(scene));
  if (!report.outcomes.empty()) sections.push_back(results_section(scene, report));
  if (!report.verdicts.empty()) sections.push_back(cycles_section(scene, report));
  if (!report.corrections.empty()) sections.push_back(corrections_section(report, folder));
  if (report.certificate) sections.push_back(certificate_section(report, folder));
  const auto add = [&](const std::string& name, const std::string& heading, std::string svg) {
    if (!scene.output.plots || svg.empty()) return;
    folder.write_text("plots/" + name + ".svg", svg);
    io::ReportSection section;
    section.heading = heading;
    section.pictures.push_back(std::move(svg));
    sections.push_back(std::move(section));
  };
  for (const RunFolder::DesignPictures& p : folder.design_pictures())
    sections.push_back(design_section(p, scene.output));
  for (const JudgedBody& j : report.judged)
    if (scene.output.plots) add("stress_" + j.body, "Stress of " + j.body, stress_plot(j));
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
            error_plot(scene, *report.judging(), report.judging_uniform()));
    }
    add("joint_forces", "Joint forces", joint_forces_plot(scene, *report.motion));
    add("energies", "Energies of the motion", energy_plot(scene, *report.motion));
  }
  if (report.path) add("path", "Path of equilibria", path_plot(*report.path));
  if (const auto shapes = folder.shapes(kShapes); !shapes.empty())
    add("shapes", "Deformed shapes",
        io::surfaces_svg("Deformed shapes, light: strain energy", shapes));
  if (report.verified)
    add("deflection_verified",
        "Tip deflection on " +
            (scene.verify ? scene.verify->words() : std::string("the finer mesh")),
        deflection_plot(*report.verified, report.verified_uniform));
  folder.write_text("report.html", io::report_html(scene.title, sections));
  if (done) folder.write_text("run.json", run_json(scene, report));
}

}  // namespace flexmorph::cases
