#include "cases/output/report.h"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "cases/output/headline.h"
#include "cases/output/page/html.h"
#include "cases/output/page/page_data.h"
#include "cases/output/plots/plots.h"
#include "cases/output/report_tables.h"
#include "cases/results/run_json.h"
#include "cases/results/warnings.h"
#include "io/files.h"

namespace flexmorph::cases {
namespace {

constexpr size_t kShapes = 4;  // number of pictures of a plate in space

/// Returns the text with a full stop at its end.
std::string sentence(const std::string& text) { return text.ends_with('.') ? text : text + "."; }

Box frame_of(const Grid& g) { return {{g.x0, g.y0}, {g.x0 + g.width, g.y0 + g.height}}; }

/// Returns the grid of the design of a body.
const Grid& grid_of(const Scene& scene, const std::string& body) {
  size_t i = 0;
  while (scene.designs[i].body != body) ++i;
  return scene.designs[i].grid;
}

/// The page of a run: sections, and the data of the plots in them.
class RunPage {
 public:
  RunPage(const Scene& scene, const RunResult& result, RunFolder& folder)
      : scene_(scene), result_(result), folder_(folder) {}

  Page page() {
    Page out;
    out.title = scene_.title;
    const std::string& status = result_.info.status;
    out.status = status + (result_.info.message.empty() ? "" : ": " + result_.info.message);
    out.good = status == "done" || is_running();
    out.open = status == "done" && has_unfinished();
    if (out.open) out.status = "done, design unfinished";
    out.refreshes = is_running();
    out.facts = headline(scene_, result_, folder_);
    if (result_.motions.motion)
      for (const std::string& each : result_.motions.motion->remarks)
        out.notes.push_back("Note: " + sentence(each));
    for (const std::string& each : notes_of(result_)) out.notes.push_back("Note: " + each);
    for (const Warning& each : result_.warnings) out.warnings.push_back(each.words);
    out.sections = {design_section(), mechanism_section(), iterations_section()};
    const DesignResult& design = result_.design;
    out.sections.push_back(results_section(scene_, design));
    out.sections.push_back(comparison_section(result_));
    out.sections.push_back(loads_section(result_, folder_));
    if (!design.static_loads.empty() && plots())
      data_["static_loads"] = static_loads_data(design.problems.front().grid, design.static_loads);
    out.sections.push_back(plots_section());
    out.sections.push_back(motion_section(result_));
    out.sections.push_back(heat_section(scene_));
    out.sections.push_back(cycles_section(scene_, design));
    out.sections.push_back(corrections_section(design, folder_));
    out.sections.push_back(certificate_section(design, folder_));
    out.sections.push_back(settings_section(scene_));
    out.sections.push_back(case_section(folder_));
    out.sections.push_back(run_section(result_));
    out.sections.push_back(files_section(folder_));
    out.sections.push_back(expect_section(scene_, result_));
    out.data = data_.dump();
    return out;
  }

 private:
  bool plots() const { return scene_.output.plots; }
  bool is_running() const { return result_.info.status == "running"; }
  bool has_unfinished() const {
    return std::ranges::any_of(result_.design.outcomes, [](const mmc::BodyOutcome& o) {
      return o.verdict.kind == optim::Verdict::Kind::unfinished;
    });
  }
  /// Writes a picture to plots/, once the run has ended.
  void keep(const std::string& name, const std::string& svg) {
    if (!is_running()) folder_.write_text("plots/" + name + ".svg", svg);
  }

  /// Returns a picture as HTML, after writing it to plots/; nothing for an empty picture.
  std::string picture(const std::string& name, const std::string& svg) {
    if (!plots() || svg.empty()) return "";
    keep(name, svg);
    return figure(svg);
  }
  /// Returns a plot as HTML with its heading, after writing its picture to plots/.
  std::string plot(const std::string& name, const std::string& heading, const io::Figure& curves) {
    if (!plots() || curves.panels.empty()) return "";
    const std::string svg = io::plot_svg(curves);
    keep(name, svg);
    data_["plots"][name] = figure_data(curves);
    return "<h3>" + explained(heading) + "</h3>\n" + figure(svg, name);
  }

  PageSection design_section() {
    PageSection out{"design", "Design", ""};
    const std::vector<RunFolder::DesignPictures>& all = folder_.design_pictures();
    for (const RunFolder::DesignPictures& p : all) {
      if (p.result.empty()) continue;
      if (all.size() > 1) out.html += "<h3>" + escaped(p.body) + "</h3>\n";
      out.html += "<div class=\"design\">" + figure(p.result) + "</div>\n";
      data_["designs"][p.body] = outline_data(p.outline, frame_of(grid_of(scene_, p.body)));
    }
    const std::string unit = scene_.output.unit.name;
    if (!out.html.empty())
      out.html += paragraph(
          (result_.info.status.find("not usable") == std::string::npos
               ? std::string()
               : "This design is not usable; a warning at the top of the page says why. ") +
          (has_unfinished() ? "The optimization is not finished: more iterations may improve this "
                              "design. "
                            : "") +
          "The picture is the part for the shop: the union of the loaded components with fillets. "
          "Its outline for cutting is in the .dxf file, and its solid for CAD programs in the "
          ".step file (see Files below). The unit of length is mm" +
          (unit == "mm" ? "." : " in .step files, and " + unit + " in .dxf and .stl files."));
    for (const VerifiedOutline& v : result_.design.outlines)
      if (const std::string svg = plots() ? stress_plot(v) : ""; !svg.empty())
        out.html +=
            "<h3>" + explained("Von Mises stress of " + v.body + " under " + shown_load(v)) +
            "</h3>\n" +
            paragraph("The colours end at the stress that at most 0.5 % of the area exceeds.") +
            picture("stress_" + v.body, svg);
    return out;
  }

  /// Returns the name of the load whose stresses are shown: the one with the largest compliance.
  std::string shown_load(const VerifiedOutline& v) const {
    const std::vector<double>& all = v.verification->compliances;
    const auto index = std::max_element(all.begin(), all.end()) - all.begin();
    return load_name(result_, folder_, v.body, static_cast<size_t>(index));
  }

  PageSection mechanism_section() {
    PageSection out{
        "motion", result_.path ? "Deformation along the path of equilibria" : "Mechanism in motion",
        ""};
    const MotionResults& motions = result_.motions;
    if (!(motions.motion || result_.path) || !plots()) return out;
    const Animation& animation =
        motions.motion ? motions.motion->animation : result_.path->animation;
    const bool moves = animation.time.size() > 1;
    if (moves) {
      data_["motion"] = animation_data(animation);
      if (motions.uniform && !motions.uniform->animation.time.empty())
        data_["uniform"] = animation_data(motions.uniform->animation);
      out.html = "<div id=\"motion-view\" class=\"plot\">";
    }
    const std::string shapes = motions.motion ? snapshot_plot(*motions.motion) : "";
    if (!shapes.empty()) {
      keep("mechanism", shapes);
      out.html += "<div class=\"static wide\">" + shapes.substr(shapes.find("<svg")) + "</div>";
    }
    if (moves) out.html += "</div>\n";
    return out;
  }

  PageSection iterations_section() {
    PageSection out{"iterations", "Iterations", ""};
    for (const RunFolder::History& h : folder_.histories()) {
      if (plots()) {
        data_["iterations"].push_back(history_data(h, frame_of(grid_of(scene_, h.body))));
        // The design is the best iteration, which need not be the last one.
        for (const mmc::BodyOutcome& o : result_.design.outcomes)
          if (const auto found =
                  std::ranges::find(h.compliance.rbegin(), h.compliance.rend(), o.compliance);
              o.body == h.body && found != h.compliance.rend())
            data_["iterations"].back()["design"] = h.compliance.rend() - found - 1;
      }
      out.html += plot("convergence_" + h.body, "Convergence of " + h.body, convergence_plot(h));
    }
    for (const RunFolder::DesignPictures& p : folder_.design_pictures())
      if (!p.start.empty())
        out.html += "<details><summary>Initial design of " + escaped(p.body) +
                    "</summary><div class=\"design\">" + figure(p.start) + "</div></details>\n";
    if (!out.html.empty())
      out.html =
          (folder_.histories().empty()
               ? std::string()
               : paragraph("The pictures show the components of each iteration, without fillets "
                           "and with components that carry no load. The objective and the KKT "
                           "residual jump where a stage begins, because every stage has its own "
                           "formulation.")) +
          "<div id=\"iterations-view\" class=\"interactive scripted\"></div>\n" + out.html;
    return out;
  }

  std::string motion_plots(const MotionRecord& motion) {
    const MotionResults& motions = result_.motions;
    const auto has = [&](ColumnGroup group) { return !motion.table.of_group(group).empty(); };
    std::string out;
    if (has(ColumnGroup::deflection))
      out += plot("deflection",
                  motions.verified ? "Tip deflection on the mesh of the case" : "Tip deflection",
                  deflection_plot(motion, motions.uniform));
    if (has(ColumnGroup::observed))
      out += plot("observed", "Motion of observed points", observed_plot(motion));
    if (has(ColumnGroup::measured))
      out += plot("measured", "Measured quantities", measured_plot(motion));
    if (scene_.is_mechanism()) {
      out += plot("inputs", "Inputs", inputs_plot(scene_));
      if (scene_.trajectory)
        out += plot("error_" + scene_.trajectory->body,
                    "Trajectory error of " + scene_.trajectory->body,
                    error_plot(scene_, *motions.assessed(), motions.assessed_uniform()));
    }
    out += plot("joint_forces", "Joint forces", joint_forces_plot(scene_, motion));
    return out + plot("energies", "Energies of the motion", energy_plot(scene_, motion));
  }

  PageSection plots_section() {
    PageSection out{"plots", "Plots", ""};
    const MotionResults& motions = result_.motions;
    if (motions.motion && motions.motion->table.n_rows() > 0)
      out.html += motion_plots(*motions.motion);
    if (result_.path) out.html += plot("path", "Path of equilibria", path_plot(*result_.path));
    if (const auto shapes = folder_.shapes(kShapes); !shapes.empty())
      out.html +=
          picture("shapes",
                  io::surfaces_svg("Deformed shapes, light colours: large strain energy", shapes));
    if (motions.verified)
      out.html += plot("deflection_verified",
                       "Tip deflection on " +
                           (scene_.verify ? scene_.verify->words() : std::string("the finer mesh")),
                       deflection_plot(*motions.verified, motions.verified_uniform));
    return out;
  }

  const Scene& scene_;
  const RunResult& result_;
  RunFolder& folder_;
  nlohmann::ordered_json data_ = nlohmann::ordered_json::object();
};

}  // namespace

void write_report(const Scene& scene, const RunResult& result, RunFolder& folder) {
  // The status "done" is written last, so that a run with this status has all its files.
  const std::string& status = result.info.status;
  const bool done = status.starts_with("done");
  if (!done) folder.write_text("run.json", run_json(scene, result));
  if (status == "running") return;
  const Page page = RunPage(scene, result, folder).page();
  folder.write_text("report.html", page_html(page));
  if (done) folder.write_text("run.json", run_json(scene, result));
}

void write_live_report(const Scene& scene, const RunResult& result, RunFolder& folder) {
  // Not stored at once (io::Sync), because the next page replaces it soon.
  io::write_file(folder.file("report.html"), page_html(RunPage(scene, result, folder).page()));
}

}  // namespace flexmorph::cases
