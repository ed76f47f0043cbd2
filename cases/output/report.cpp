#include "cases/output/report.h"

#include <array>

#include "cases/output/plots/plots.h"
#include "cases/results/correction_messages.h"
#include "cases/results/run_json.h"
#include "cases/results/schema.h"
#include "cases/scene/design/goal.h"
#include "cases/scene/heat/heat.h"
#include "io/case_files/case_parser.h"
#include "io/files.h"

namespace flexmorph::cases {
namespace {

constexpr size_t kShapes = 4;  // number of pictures of a plate in space

/// Returns the body-fitted compliance, its estimated error and the volume of a body; empty texts if
/// its outline was not verified.
std::array<std::string, 3> outline_cells(const DesignResult& design, const std::string& body) {
  for (const VerifiedOutline& o : design.outlines)
    if (o.body == body && o.verification)
      return {io::to_text(o.verification->compliance, 6),
              io::to_text(100 * o.verification->error, 2) + " %", io::to_text(o.volume, 5)};
  return {};
}

/// Transposes a table, because there are many numbers of few bodies.
std::vector<std::vector<std::string>> turned(const std::vector<std::vector<std::string>>& rows) {
  std::vector<std::vector<std::string>> out(rows.front().size());
  for (size_t k = 0; k < out.size(); ++k)
    for (const std::vector<std::string>& row : rows) out[k].push_back(row[k]);
  return out;
}

/// Returns the text with a full stop at its end.
std::string sentence(const std::string& text) { return text.ends_with('.') ? text : text + "."; }

io::ReportSection results_section(const Scene& scene, const DesignResult& design) {
  io::ReportSection out;
  out.heading = "Results";
  out.rows.push_back({"body", "compliance [J]", "volume fraction", "crisp compliance [J]",
                      "crisp volume fraction", "body-fitted compliance [J]",
                      "estimated error of the body-fitted compliance",
                      "body-fitted volume fraction", "compliance of uniform material [J]",
                      "crisp compliance / compliance of uniform material", "connected",
                      "iterations", "state solves", "verdict", "reason to stop"});
  for (const VerifiedOutline& v : design.outlines)
    for (const mmc::BodyOutcome& o : design.outcomes)
      if (o.body == v.body)
        out.words += (out.words.empty() ? "" : " ") + sentence(outline_text(v, o.crisp.compliance));
  for (const mmc::BodyOutcome& o : design.outcomes) {
    const std::array<std::string, 3> outline = outline_cells(design, o.body);
    out.rows.push_back({o.body, io::to_text(o.compliance, 6), io::to_text(o.volume, 5),
                        io::to_text(o.crisp.compliance, 6), io::to_text(o.crisp.volume, 5),
                        outline[0], outline[1], outline[2], io::to_text(o.uniform_compliance, 6),
                        io::to_text(o.crisp.compliance / o.uniform_compliance, 4),
                        o.crisp.connectivity.connected ? "yes" : "no", io::to_text(o.iterations),
                        io::to_text(o.evaluations),
                        o.of_part ? optim::to_string(o.verdict.kind) : optim::text_of(o.verdict),
                        o.stop});
  }
  for (const mmc::ResponseRow* row : further_rows(scene)) {
    const std::string name = mmc::key_of(*row);
    const std::string words = std::string(row->words).append(" [").append(row->unit).append("]");
    out.rows[0].insert(out.rows[0].end(), {words, "crisp " + words});
    for (size_t i = 0; i < design.outcomes.size(); ++i)
      for (const mmc::Figures* figures :
           {&design.outcomes[i].further, &design.outcomes[i].crisp.further})
        out.rows[i + 1].push_back(figures->contains(name) ? io::to_text(figures->at(name), 6) : "");
  }
  out.rows = turned(out.rows);
  return out;
}

/// Returns the comparison of a given part with the design and with uniform material.
io::ReportSection comparison_section(const PartComparison& comparison) {
  io::ReportSection out;
  out.heading = "Comparison of part, design and uniform material";
  for (const std::string& each : comparison.notes)
    out.words += (out.words.empty() ? "Note: " : " Note: ") + sentence(each);
  out.rows = comparison_rows(comparison);
  return out;
}

/// Returns the section about the load cases of a static plate.
io::ReportSection loads_section(const DesignResult& design) {
  io::ReportSection out;
  out.heading = "Load cases";
  std::vector<std::string>& header = out.rows.emplace_back();
  for (const ResultQuantity<StaticLoad>& q : static_load_quantities()) {
    const std::string unit = q.unit;
    header.push_back(q.name + (unit.empty() ? unit : " [" + unit + "]"));
  }
  for (const StaticLoad& load : design.static_loads) {
    std::vector<std::string>& row = out.rows.emplace_back();
    for (const ResultQuantity<StaticLoad>& q : static_load_quantities()) {
      const Value value = q.value(load);
      const double* number = std::get_if<double>(&value);
      row.push_back(number ? io::to_text(*number, 5) : text_of(value));
    }
  }
  return out;
}

/// Returns the section about expected results; expectations that are not met come first.
io::ReportSection expect_section(const std::vector<Expected>& expectations) {
  io::ReportSection out;
  out.heading = "Expected results";
  out.rows.push_back({"", "result: name = computed value: expected value"});
  for (const bool holds : {false, true})
    for (const Expected& expected : expectations)
      if (expected.holds == holds) out.rows.push_back({holds ? "met" : "NOT MET", expected.words});
  return out;
}

io::ReportSection heat_section(const Scene& scene) {
  io::ReportSection out;
  out.heading = "Heated bodies";
  out.rows.push_back(
      {"body", "temperature", "thermal expansion [1/K]", "thermal volume", "thermal force"});
  for (const Body& body : scene.bodies)
    if (body.heat)
      out.rows.push_back({body.name, temperature_text(*body.heat),
                          io::to_text(body.heat->expansion, 6), volume_name(body.heat->volume),
                          body.heat->force ? "yes" : "no"});
  return out;
}

io::ReportSection design_section(const RunFolder::DesignPictures& pictures, const Output& output) {
  std::vector<std::string> all;
  if (!pictures.start.empty()) all.push_back(pictures.start);
  if (!pictures.result.empty()) all.push_back(pictures.result);
  io::ReportSection out;
  out.heading = "Design of " + pictures.body;
  out.words = all.size() > 1
                  ? "The first picture shows the initial design, the second picture shows the "
                    "final design. "
                  : "";
  if (!pictures.result.empty())
    out.words +=
        std::string("The unit of length of its .dxf and .stl files is ") + output.unit.name + ".";
  out.pictures = std::move(all);
  return out;
}

std::string measure_title(const Cycle& cycle) {
  switch (cycle.compare_by) {
    case CycleMeasure::strain_energy:
      return "time integral of the strain energy [J s]";
    case CycleMeasure::rms:
      return "root mean square of the deflection [m]";
    case CycleMeasure::peak_to_peak:
      return "peak-to-peak value of the deflection [m]";
    default:
      return "absolute mean value of the deflection [m]";
  }
}

/// Returns the comparison of the cycles, which shows whether the motion itself improved and not
/// only the compliance under the equivalent static loads.
io::ReportSection cycles_section(const Scene& scene, const DesignResult& design) {
  io::ReportSection out;
  out.heading = "Cycles";
  out.words =
      "The cycles are compared by the motion on " +
      (scene.verifies_on_cells() ? scene.verify->words() : std::string("the mesh of the case")) +
      ".";
  out.rows.push_back({"cycle", "sum of the compliances [J]", measure_title(scene.cycle), "best"});
  std::vector<std::string>& header = out.rows.front();
  for (const mmc::BodyVerdict& b : design.verdicts.front().bodies)
    for (const char* what : {": compliance [J]", ": crisp compliance [J]", ": design change"})
      header.push_back(b.body + what);
  for (const mmc::CycleVerdict& v : design.verdicts) {
    std::vector<std::string>& row = out.rows.emplace_back();
    row = {io::to_text(v.cycle), io::to_text(v.objective, 6), io::to_text(v.measure, 6),
           v.best ? "yes" : ""};
    for (const mmc::BodyVerdict& b : v.bodies)
      for (const double value : {b.compliance, b.crisp_compliance, b.design_change})
        row.push_back(io::to_text(value, 5));
  }
  return out;
}

/// Adds a drawing of every designed body from the run folder.
void add_drawings(const DesignResult& design, const RunFolder& folder, const std::string& name,
                  io::ReportSection& out) {
  for (const mmc::BodyProblem& problem : design.problems)
    out.pictures.push_back(io::read_text(folder.path() + "/" + name +
                                         (design.problems.size() > 1 ? "_" + problem.body : "") +
                                         ".svg"));
}

/// Returns the section about corrected cycles.
io::ReportSection corrections_section(const DesignResult& design, const RunFolder& folder) {
  io::ReportSection out;
  out.heading = "Corrected cycles";
  if (design.corrected) out.words = sentence(corrected_text(*design.corrected));
  if (design.corrected && design.corrected->improves()) {
    out.words +=
        " The designs for the equivalent static loads are shown first, followed by the corrected "
        "designs.";
    add_drawings(design, folder, "design_esl", out);
    add_drawings(design, folder, "design", out);
  }
  out.rows.push_back({"cycle", "objective J", "KKT residual", "trust region radius",
                      "predicted decrease", "actual decrease", "accepted", "motions",
                      "CPU time [s]"});
  for (const mmc::CorrectedCycle& c : design.corrections)
    out.rows.push_back({io::to_text(c.cycle), io::to_text(c.value, 6), io::to_text(c.kkt, 3),
                        io::to_text(c.radius, 3), io::to_text(c.predicted, 3),
                        io::to_text(c.actual, 3), c.accepted ? "yes" : "", io::to_text(c.motions),
                        io::to_text(c.seconds, 4)});
  return out;
}

io::ReportSection certificate_section(const DesignResult& design, const RunFolder& folder) {
  io::ReportSection out;
  out.heading = "Optimality certificate";
  out.words =
      sentence(certificate_text(*design.certificate)) +
      " The arrows show in which direction a component has to move so that the objective of the "
      "motion decreases.";
  add_drawings(design, folder, "certificate", out);
  return out;
}

/// The sections of the report in their order; pictures are written to plots/, too.
class Sections {
 public:
  Sections(bool plots, RunFolder& folder) : plots_(plots), folder_(folder) {}

  void add(io::ReportSection section) { all_.push_back(std::move(section)); }
  /// Adds a picture, unless it is empty or the case has `output.plots = false`.
  void add_plot(const std::string& name, const std::string& heading, std::string svg) {
    if (!plots_ || svg.empty()) return;
    folder_.write_text("plots/" + name + ".svg", svg);
    io::ReportSection section;
    section.heading = heading;
    section.pictures.push_back(std::move(svg));
    add(std::move(section));
  }
  const std::vector<io::ReportSection>& all() const { return all_; }

 private:
  bool plots_;
  RunFolder& folder_;
  std::vector<io::ReportSection> all_;
};

io::ReportSection head_section(const RunResult& result) {
  io::ReportSection out;
  out.heading = "Run";
  out.words = sentence("Status: " + result.info.status +
                       (result.info.message.empty() ? "" : ": " + result.info.message));
  if (result.motions.motion)
    for (const std::string& each : result.motions.motion->remarks)
      out.words += " Note: " + sentence(each);
  for (const Warning& each : result.warnings) out.warnings.push_back(each.words);
  return out;
}

void add_tables(const Scene& scene, const RunResult& result, const RunFolder& folder,
                Sections& out) {
  const DesignResult& design = result.design;
  out.add(head_section(result));
  if (!scene.expect.empty() && result.info.status.starts_with("done"))
    out.add(expect_section(result.expectations));
  if (scene.has_heat()) out.add(heat_section(scene));
  if (result.comparison) out.add(comparison_section(*result.comparison));
  if (!design.outcomes.empty()) out.add(results_section(scene, design));
  if (!design.static_loads.empty()) out.add(loads_section(design));
  if (!design.verdicts.empty()) out.add(cycles_section(scene, design));
  if (!design.corrections.empty()) out.add(corrections_section(design, folder));
  if (design.certificate) out.add(certificate_section(design, folder));
}

void add_design_pictures(const Scene& scene, const DesignResult& design, const RunFolder& folder,
                         Sections& out) {
  for (const RunFolder::DesignPictures& p : folder.design_pictures())
    out.add(design_section(p, scene.output));
  for (const VerifiedOutline& v : design.outlines)
    if (scene.output.plots)
      out.add_plot("stress_" + v.body, "Von Mises stress of " + v.body, stress_plot(v));
  for (const RunFolder::History& h : folder.histories())
    out.add_plot("convergence_" + h.body, "Convergence of " + h.body, convergence_plot(h));
}

void add_motion_pictures(const Scene& scene, const MotionResults& motions, Sections& out) {
  const MotionRecord& motion = *motions.motion;
  const auto has = [&](ColumnGroup group) { return !motion.table.of_group(group).empty(); };
  if (has(ColumnGroup::deflection))
    out.add_plot("deflection", "Tip deflection", deflection_plot(motion, motions.uniform));
  if (has(ColumnGroup::observed))
    out.add_plot("observed", "Motion of observed points", observed_plot(motion));
  if (has(ColumnGroup::measured))
    out.add_plot("measured", "Measured quantities", measured_plot(motion));
  if (scene.is_mechanism()) {
    out.add_plot("inputs", "Inputs", inputs_plot(scene));
    out.add_plot("mechanism", "Snapshots of the mechanism", snapshot_plot(motion));
    if (scene.trajectory)
      out.add_plot("error_" + scene.trajectory->body,
                   "Trajectory error of " + scene.trajectory->body,
                   error_plot(scene, *motions.assessed(), motions.assessed_uniform()));
  }
  out.add_plot("joint_forces", "Joint forces", joint_forces_plot(scene, motion));
  out.add_plot("energies", "Energies of the motion", energy_plot(scene, motion));
}

}  // namespace

void write_report(const Scene& scene, const RunResult& result, RunFolder& folder) {
  // The status "done" is written last, so that a run with this status has all its files.
  const std::string& status = result.info.status;
  const bool done = status.starts_with("done");
  if (!done) folder.write_text("run.json", run_json(scene, result));
  if (status == "running") return;
  Sections sections(scene.output.plots, folder);
  add_tables(scene, result, folder, sections);
  add_design_pictures(scene, result.design, folder, sections);
  if (result.motions.motion) add_motion_pictures(scene, result.motions, sections);
  if (result.path) sections.add_plot("path", "Path of equilibria", path_plot(*result.path));
  if (const auto shapes = folder.shapes(kShapes); !shapes.empty())
    sections.add_plot(
        "shapes", "Deformed shapes",
        io::surfaces_svg("Deformed shapes, light colours: large strain energy", shapes));
  if (result.motions.verified)
    sections.add_plot("deflection_verified",
                      "Tip deflection of the verification on " +
                          (scene.verify ? scene.verify->words() : std::string("the finer mesh")),
                      deflection_plot(*result.motions.verified, result.motions.verified_uniform));
  folder.write_text("report.html", io::report_html(scene.title, sections.all()));
  if (done) folder.write_text("run.json", run_json(scene, result));
}

}  // namespace flexmorph::cases
