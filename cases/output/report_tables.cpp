#include "cases/output/report_tables.h"

#include <algorithm>

#include "cases/output/headline.h"
#include "cases/output/page/html.h"
#include "cases/results/correction_messages.h"
#include "cases/results/schema.h"
#include "cases/scene/design/goal.h"
#include "cases/scene/heat/heat.h"
#include "io/case_files/case_parser.h"
#include "io/files.h"

namespace flexmorph::cases {
namespace {

/// Returns the text with a full stop at its end.
std::string sentence(const std::string& text) { return text.ends_with('.') ? text : text + "."; }

/// Returns a value for a table: numbers with five significant digits.
std::string cell_of(const Value& value) {
  if (const double* number = std::get_if<double>(&value)) return io::to_text(*number, 5);
  if (const bool* flag = std::get_if<bool>(&value)) return *flag ? "yes" : "no";
  return text_of(value);
}

template <class Source>
HtmlColumn column_of(const ResultQuantity<Source>& q) {
  return {q.name, q.unit, q.meaning};
}

/// Returns a row per quantity with its values for several sources.
template <class Source>
std::vector<QuantityRow> quantity_rows(std::span<const ResultQuantity<Source>> table,
                                       const std::vector<const Source*>& sources) {
  std::vector<QuantityRow> out;
  for (const ResultQuantity<Source>& q : table) {
    QuantityRow& row = out.emplace_back();
    row.quantity = column_of(q);
    for (const Source* source : sources)
      row.values.push_back(source ? cell_of(q.value(*source)) : "");
  }
  return out;
}

/// Returns a table with a row per source and a column per quantity.
template <class Source>
std::string source_table(std::span<const ResultQuantity<Source>> table,
                         std::span<const Source> sources) {
  std::vector<HtmlColumn> columns;
  for (const ResultQuantity<Source>& q : table) columns.push_back(column_of(q));
  std::vector<std::vector<std::string>> rows;
  for (const Source& source : sources) {
    std::vector<std::string>& row = rows.emplace_back();
    for (const ResultQuantity<Source>& q : table) row.push_back(escaped(cell_of(q.value(source))));
  }
  return sortable_table(columns, rows);
}

/// Returns a drawing of every designed body from the run folder.
std::string drawings(const DesignResult& design, const RunFolder& folder, const std::string& name) {
  std::string out;
  for (const mmc::BodyProblem& problem : design.problems)
    out += figure(io::read_text(folder.path() + "/" + name +
                                (design.problems.size() > 1 ? "_" + problem.body : "") + ".svg"));
  return out;
}

std::string measure_name(const Cycle& cycle) {
  switch (cycle.compare_by) {
    case CycleMeasure::strain_energy:
      return "time integral of the strain energy";
    case CycleMeasure::rms:
      return "root mean square of the deflection";
    case CycleMeasure::peak_to_peak:
      return "peak-to-peak value of the deflection";
    default:
      return "absolute mean value of the deflection";
  }
}

}  // namespace

PageSection results_section(const Scene& scene, const DesignResult& design) {
  PageSection out{"results", "Results", ""};
  if (design.outcomes.empty()) return out;
  std::vector<std::string> heads;
  std::vector<const mmc::BodyOutcome*> outcomes;
  std::vector<const VerifiedOutline*> outlines;
  for (const mmc::BodyOutcome& o : design.outcomes) {
    heads.push_back(o.body);
    outcomes.push_back(&o);
    const VerifiedOutline* own = nullptr;
    for (const VerifiedOutline& v : design.outlines)
      if (v.body == o.body) own = &v;
    outlines.push_back(own);
    if (own) out.html += paragraph(sentence(outline_text(*own, o.crisp.compliance)));
  }
  std::vector<QuantityRow> rows = quantity_rows(design_quantities(), outcomes);
  for (const mmc::ResponseRow* response : further_rows(scene)) {
    const std::string name = mmc::key_of(*response);
    const std::string words(response->words), unit(response->unit);
    QuantityRow smoothed{{words, unit, ""}, {}}, crisp{{"crisp " + words, unit, ""}, {}};
    for (const mmc::BodyOutcome& o : design.outcomes) {
      const auto value = [&](const mmc::Figures& figures) {
        return figures.contains(name) ? io::to_text(figures.at(name), 6) : std::string();
      };
      smoothed.values.push_back(value(o.further));
      crisp.values.push_back(value(o.crisp.further));
    }
    rows.push_back(smoothed);
    rows.push_back(crisp);
  }
  out.html += quantity_table(heads, rows);
  std::vector<QuantityRow> verified = quantity_rows(outline_quantities(), outlines);
  if (!verified.empty())
    out.html += "<h3>" + explained("Verification of the outline") + "</h3>\n" +
                quantity_table(heads, verified);
  const bool limited = std::any_of(outcomes.begin(), outcomes.end(),
                                   [](const auto* o) { return o->length_scale.has_value(); });
  for (const mmc::BodyOutcome*& o : outcomes)
    if (!o->length_scale) o = nullptr;
  if (limited)
    out.html += "<h3>" + explained("Length scale") + "</h3>\n" +
                quantity_table(heads, quantity_rows(length_scale_quantities(), outcomes));
  return out;
}

PageSection comparison_section(const RunResult& result) {
  PageSection out{"comparison", "Comparison of part, design and uniform material", ""};
  if (!result.comparison) return out;
  for (const std::string& each : result.comparison->notes)
    out.html += paragraph("Note: " + sentence(each));
  out.html += text_table(comparison_rows(*result.comparison));
  return out;
}

namespace {

/// Returns a button in whose place the page draws the deformed design under a load.
std::string deformed_button(const std::string& body, size_t load, double time) {
  return "<button type=\"button\" class=\"scripted\" data-deformed=\"" + escaped(body) +
         "\" data-load=\"" + std::to_string(load) + "\" data-at=\"" + io::to_text(time) +
         "\">deformed</button>";
}

/// Returns the table of the load cases of a static plate.
std::string load_case_table(const DesignResult& design) {
  std::vector<HtmlColumn> columns;
  for (const auto& q : static_load_quantities()) columns.push_back(column_of(q));
  columns.push_back({"", "", ""});
  std::vector<std::vector<std::string>> rows;
  for (size_t l = 0; l < design.static_loads.size(); ++l) {
    std::vector<std::string>& row = rows.emplace_back();
    for (const auto& q : static_load_quantities())
      row.push_back(escaped(cell_of(q.value(design.static_loads[l]))));
    row.push_back(deformed_button(design.problems.front().body, l, 0));
  }
  return sortable_table(columns, rows);
}

/// Returns the table of the equivalent static loads of one body.
std::string load_set_table(const RunFolder::LoadSets& sets, const RunResult& result) {
  const mmc::BodyOutcome* outcome = nullptr;
  for (const mmc::BodyOutcome& o : result.design.outcomes)
    if (o.body == sets.body) outcome = &o;
  const verification::OutlineVerification* outline = nullptr;
  for (const VerifiedOutline& v : result.design.outlines)
    if (v.body == sets.body && v.verification) outline = &*v.verification;
  const std::vector<HtmlColumn> columns = {
      {"load", "", "Number of the load set."},
      {"time", "s", "Time of the motion whose displacements the load causes."},
      {"compliance", "J", "Work of the load on the static displacements of the crisp design."},
      {"largest displacement", "m", "Largest displacement of the exported outline under the load."},
      {"largest stress", "Pa",
       "Largest von Mises stress of the exported outline, away from supports and loads."},
      {"", "", ""},
      {"", "", ""},
      {"strain energy at the start of the cycle", "J",
       "Strain energy of the body in the motion at this time, with the design that the cycle began "
       "with: in the first cycle the initial bars."},
      {"deviation at the start of the cycle", "%",
       "Strain energy of the static displacements minus that of the motion, relative to the "
       "motion, for the design that the cycle began with. Values above 100 % are usual for initial "
       "bars. The deviation of the final design is load_difference in run.json."}};
  std::vector<std::vector<std::string>> rows;
  for (size_t l = 0; l < sets.time.size(); ++l) {
    const auto number = [](const std::vector<double>& all, size_t i) {
      return i < all.size() ? io::to_text(all[i], 4) : std::string();
    };
    std::vector<std::string>& row = rows.emplace_back();
    row = {io::to_text(static_cast<int>(l) + 1),
           io::to_text(sets.time[l], 5),
           outcome ? number(outcome->load_compliances, l) : "",
           outline ? number(outline->largest_displacements, l) : "",
           outline && l < outline->largest_stresses.size()
               ? io::to_text(outline->largest_stresses[l].value, 4)
               : "",
           "<button type=\"button\" class=\"scripted\" data-time=\"" + io::to_text(sets.time[l]) +
               "\">show</button>",
           deformed_button(sets.body, l, sets.time[l]),
           io::to_text(sets.strain_energy[l], 4),
           l < sets.energy_ratio.size() ? io::to_text(100 * (sets.energy_ratio[l] - 1), 3) : ""};
  }
  return sortable_table(columns, rows);
}

/// Returns a sentence on the load set with the largest compliance.
std::string worst_load(const RunFolder::LoadSets& sets, const RunResult& result,
                       const RunFolder& folder) {
  for (const mmc::BodyOutcome& o : result.design.outcomes) {
    if (o.body != sets.body || o.load_compliances.empty()) continue;
    const auto largest = std::max_element(o.load_compliances.begin(), o.load_compliances.end());
    const auto index = static_cast<size_t>(largest - o.load_compliances.begin());
    std::string out = "The worst load, which has the largest compliance, is " +
                      load_name(result, folder, sets.body, index) + ": " +
                      io::to_text(*largest, 4) + " J.";
    for (const mmc::LoadDifference& d : result.design.load_differences)
      if (d.body == sets.body)
        out += " The loads differ from those of the motion with the final design by " +
               io::to_text(100 * d.loads, 2) + " % of the energy.";
    return paragraph(out);
  }
  return "";
}

}  // namespace

PageSection loads_section(const RunResult& result, const RunFolder& folder) {
  PageSection out{"loads", "Loads", ""};
  if (!result.design.static_loads.empty()) out.html += load_case_table(result.design);
  const std::vector<RunFolder::LoadSets>& all = folder.load_sets();
  if (!all.empty())
    out.html += paragraph(
        "A row per load set. Compliance, displacement and stress are results of the final design. "
        "The last two columns belong to the motion from which the loads were computed, which has "
        "the design of the start of the cycle. The buttons show the mechanism at the time of "
        "the load, and the deformed design.");
  for (const RunFolder::LoadSets& sets : all) {
    if (all.size() > 1) out.html += "<h3>" + escaped(sets.body) + "</h3>\n";
    out.html += worst_load(sets, result, folder) + load_set_table(sets, result);
  }
  return out;
}

PageSection cycles_section(const Scene& scene, const DesignResult& design) {
  PageSection out{"cycles", "Cycles", ""};
  if (design.verdicts.empty()) return out;
  out.html = paragraph(
      "The cycles are compared by the motion on " +
      (scene.verifies_on_cells() ? scene.verify->words() : std::string("the mesh of the case")) +
      ": the smallest " + measure_name(scene.cycle) + " is the best. " + design.cycles_end);
  std::vector<HtmlColumn> columns;
  for (const ResultQuantity<mmc::CycleVerdict>& q : cycle_quantities()) {
    columns.push_back(column_of(q));
    if (std::string_view(q.name) == "measure")
      columns.back().unit = scene.cycle.compare_by == CycleMeasure::strain_energy ? "J s" : "m";
  }
  for (const mmc::BodyVerdict& b : design.verdicts.front().bodies) {
    columns.push_back({b.body + ": compliance", "J", "Compliance of the smoothed design."});
    columns.push_back({b.body + ": crisp compliance", "J", "Compliance of the crisp design."});
    columns.push_back({b.body + ": design change", "-", "Change of the design in the cycle."});
  }
  std::vector<std::vector<std::string>> rows;
  for (const mmc::CycleVerdict& v : design.verdicts) {
    std::vector<std::string>& row = rows.emplace_back();
    for (const ResultQuantity<mmc::CycleVerdict>& q : cycle_quantities())
      row.push_back(cell_of(q.value(v)));
    for (const mmc::BodyVerdict& b : v.bodies)
      for (const double value : {b.compliance, b.crisp_compliance, b.design_change})
        row.push_back(io::to_text(value, 5));
  }
  out.html += sortable_table(columns, rows);
  return out;
}

PageSection corrections_section(const DesignResult& design, const RunFolder& folder) {
  PageSection out{"corrections", "Corrected cycles", ""};
  if (design.corrections.empty()) return out;
  if (design.corrected) out.html += paragraph(sentence(corrected_text(*design.corrected)));
  if (design.corrected && design.corrected->improves())
    out.html += paragraph(
                    "The designs for the equivalent static loads are shown first, followed "
                    "by the corrected designs.") +
                "<div class=\"design\">" + drawings(design, folder, "design_esl") +
                drawings(design, folder, "design") + "</div>";
  out.html += source_table(corrected_cycle_quantities(),
                           std::span<const mmc::CorrectedCycle>(design.corrections));
  return out;
}

PageSection certificate_section(const DesignResult& design, const RunFolder& folder) {
  PageSection out{"certificate", "Optimality certificate", ""};
  if (!design.certificate) return out;
  out.html = paragraph(sentence(certificate_text(*design.certificate)) +
                       " The arrows show in which direction a component has to move so that the "
                       "objective of the motion decreases.") +
             drawings(design, folder, "certificate") +
             quantity_table(
                 {}, quantity_rows(certificate_quantities(), std::vector{&*design.certificate}));
  return out;
}

PageSection motion_section(const RunResult& result) {
  PageSection out{"motion-numbers", result.path ? "Path of equilibria" : "Numbers of the motion",
                  ""};
  if (result.motions.motion && result.motions.motion->table.n_rows() > 0)
    out.html = quantity_table(
        {}, quantity_rows(motion_quantities(), std::vector{&result.motions.motion->result}));
  else if (result.path && result.path->table.n_rows() > 0)
    out.html = quantity_table({}, quantity_rows(path_quantities(), std::vector{&*result.path}));
  return out;
}

PageSection heat_section(const Scene& scene) {
  PageSection out{"heat", "Heated bodies", ""};
  if (!scene.has_heat()) return out;
  std::vector<std::vector<std::string>> rows = {
      {"body", "temperature", "thermal expansion [1/K]", "thermal volume", "thermal force"}};
  for (const Body& body : scene.bodies)
    if (body.heat)
      rows.push_back({body.name, temperature_text(*body.heat), io::to_text(body.heat->expansion, 6),
                      volume_name(body.heat->volume), body.heat->force ? "yes" : "no"});
  out.html = text_table(rows);
  return out;
}

PageSection expect_section(const Scene& scene, const RunResult& result) {
  PageSection out{"expect", "Expected results", ""};
  if (scene.expect.empty() || !result.info.status.starts_with("done")) return out;
  std::vector<std::vector<std::string>> rows = {
      {"", "result: name = computed value: expected value"}};
  for (const bool holds : {false, true})
    for (const Expected& expected : result.expectations)
      if (expected.holds == holds) rows.push_back({holds ? "met" : "NOT MET", expected.words});
  out.html = text_table(rows);
  return out;
}

}  // namespace flexmorph::cases
