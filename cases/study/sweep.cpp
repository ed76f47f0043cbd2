#include "cases/study/sweep.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <optional>

#include "cases/run/run.h"
#include "cases/scene/scene.h"
#include "cases/study/compare_report.h"
#include "cases/study/sweep_motion.h"
#include "io/plots.h"
#include "io/sheet.h"
#include "io/tables.h"

namespace flexmorph::cases {
namespace {

constexpr size_t kMostVariants = 10'000;

std::string last_part(const std::string& key) { return key.substr(key.rfind('.') + 1); }

std::string trimmed(const std::string& text) {
  const size_t first = text.find_first_not_of(" \t"), last = text.find_last_not_of(" \t");
  return first == std::string::npos ? "" : text.substr(first, last - first + 1);
}

/// A value as part of a folder's name: of lists and strings what is in them.
std::string plain(const std::string& value) {
  const size_t first = value.find_first_not_of("[\"' "), last = value.find_last_not_of("]\"' ");
  std::string out;
  for (size_t i = first; i != std::string::npos && i <= last; ++i) {
    const char c = value[i];
    const bool kept = std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '.' || c == '-' ||
                      c == '+' || c == '_';
    out += kept ? c : '_';
  }
  return out;
}

/// A sweep as it was planned.
struct Sweep {
  std::string case_name;
  std::vector<Varied> varied;
  std::vector<Variant> variants;
  std::vector<mmc::Goal> goals;  // of every designed body of every variant: they may be varied
  Motions reference;             // of scenes without a design

  size_t n_bodies() const { return goals.size() / variants.size(); }
  std::string value(size_t variant, size_t key) const {
    return variants[variant].overrides[key].substr(varied[key].key.size() + 1);
  }
  double figure(size_t variant, const BodyResult& result, size_t body) const {
    return figure_of(result, goals.at(variant * n_bodies() + body));
  }
};

/// A row per variant and designed body.
std::vector<std::vector<std::string>> table_of(const Sweep& sweep,
                                               std::span<const VariantResult> runs) {
  std::vector<std::vector<std::string>> rows(1);
  for (const Varied& v : sweep.varied) rows[0].push_back(v.key);
  const bool several = sweep.n_bodies() > 1;
  if (several) rows[0].emplace_back("body");
  for (const char* name :
       {"status", "compliance", "volume", "sharp compliance", "sharp volume",
        "body-fitted compliance", "figure", "sharp/uniform", "connected", "smallest feature",
        "components", "peaks", "kkt", "iterations", "solves", "CPU s", "stopped by"})
    rows[0].emplace_back(name);
  for (size_t k = 0; k < runs.size(); ++k) {
    std::vector<std::string> head;
    for (size_t v = 0; v < sweep.varied.size(); ++v) head.push_back(sweep.value(k, v));
    for (size_t i = 0; i < runs[k].bodies.size(); ++i) {
      const BodyResult& b = runs[k].bodies[i];
      std::vector<std::string>& row = rows.emplace_back(head);
      if (several) row.push_back(b.body);
      row.insert(row.end(),
                 {runs[k].words(), io::to_text(b.compliance, 5), io::to_text(b.volume, 5),
                  io::to_text(b.sharp_compliance, 5), io::to_text(b.sharp_volume, 5),
                  io::to_text(b.body_fitted, 5), io::to_text(sweep.figure(k, b, i), 5),
                  io::to_text(b.sharp_compliance / b.uniform_compliance, 4),
                  b.connected ? "yes" : "no", b.min_feature ? io::to_text(*b.min_feature, 4) : "-",
                  io::to_text(b.components), io::to_text(b.peaks), io::to_text(b.kkt, 2),
                  io::to_text(b.iterations), io::to_text(b.solves),
                  io::to_text(runs[k].seconds_cpu, 3), b.stop.substr(0, b.stop.find(':'))});
    }
    if (!runs[k].bodies.empty()) continue;
    std::vector<std::string>& row = rows.emplace_back(head);
    if (several) row.emplace_back("");
    row.push_back(runs[k].words() + (runs[k].message.empty() ? "" : ": " + runs[k].message));
    row.resize(rows[0].size());
  }
  return rows;
}

void write_csv(const Sweep& sweep, std::span<const VariantResult> runs, const std::string& path) {
  std::vector<std::string> columns = {"variant"};
  for (const Varied& v : sweep.varied) columns.push_back(v.key);
  for (const char* name : {"status",
                           "body",
                           "compliance",
                           "volume",
                           "sharp_compliance",
                           "sharp_volume",
                           "body_fitted",
                           "body_fitted_error",
                           "body_fitted_volume",
                           "figure",
                           "uniform_compliance",
                           "kkt",
                           "connected",
                           "min_feature",
                           "components",
                           "peaks",
                           "disconnected",
                           "iterations",
                           "state_solves",
                           "seconds_cpu",
                           "converged",
                           "stop",
                           "message"})
    columns.emplace_back(name);
  io::CsvWriter csv(path, columns);
  for (size_t k = 0; k < runs.size(); ++k) {
    std::vector<io::Cell> head = {runs[k].name};
    for (size_t v = 0; v < sweep.varied.size(); ++v) head.emplace_back(sweep.value(k, v));
    head.emplace_back(runs[k].status);
    for (size_t i = 0; i < runs[k].bodies.size(); ++i) {
      const BodyResult& b = runs[k].bodies[i];
      std::vector<io::Cell> row = head;
      for (const io::Cell& cell :
           std::initializer_list<io::Cell>{b.body,
                                           b.compliance,
                                           b.volume,
                                           b.sharp_compliance,
                                           b.sharp_volume,
                                           b.body_fitted,
                                           b.body_fitted_error,
                                           b.body_fitted_volume,
                                           sweep.figure(k, b, i),
                                           b.uniform_compliance,
                                           b.kkt,
                                           b.connected,
                                           b.min_feature ? io::Cell(*b.min_feature) : io::Cell(),
                                           b.components,
                                           b.peaks,
                                           b.disconnected,
                                           b.iterations,
                                           b.solves,
                                           runs[k].seconds_cpu,
                                           b.converged(),
                                           b.stop,
                                           runs[k].message})
        row.push_back(cell);
      csv.row(row);
    }
    if (!runs[k].bodies.empty()) continue;
    head.resize(columns.size());
    head.back() = runs[k].message;
    csv.row(head);
  }
}

std::string history_picture(const BodyResult& b, double lowest, double highest) {
  io::Figure figure;
  figure.width = 560;
  figure.panel_height = 300;
  io::Panel panel;
  panel.x.label = "iteration";
  panel.y = {"compliance [J]", true, lowest, highest};
  std::vector<double> iteration(b.history_compliance.size());
  for (size_t i = 0; i < iteration.size(); ++i) iteration[i] = static_cast<double>(i + 1);
  panel.curves.push_back({"blurred", iteration, b.history_compliance});
  // A design that came apart is far above the frame: the legend says so.
  const auto above = std::count_if(b.sharp_history.begin(), b.sharp_history.end(),
                                   [&](double c) { return c > highest; });
  const std::string name = above > 0 ? "sharp (" + std::to_string(above) + " above)" : "sharp";
  panel.curves.push_back({name, b.sharp_iteration, b.sharp_history, false, true});
  figure.panels = {panel};
  return io::plot_svg(figure);
}

/// Smallest and largest compliance, blurred or sharp, of the histories of one body.
std::pair<double, double> range_of(std::span<const VariantResult> runs, size_t body) {
  double lowest = INFINITY, highest = 0;
  for (const VariantResult& run : runs) {
    if (body >= run.bodies.size()) continue;
    const BodyResult& b = run.bodies[body];
    for (const std::vector<double>* history : {&b.history_compliance, &b.sharp_history})
      for (const double c : *history) {
        if (!(c > 0)) continue;
        lowest = std::min(lowest, c);
        highest = std::max(highest, c);
      }
  }
  return {lowest, highest};
}

/// What is varied, and its values.
std::string title_of(const Sweep& sweep, size_t variant) {
  std::string out;
  for (size_t v = 0; v < sweep.varied.size(); ++v)
    out += (v > 0 ? ", " : "") + last_part(sweep.varied[v].key) + " = " + sweep.value(variant, v);
  return out;
}

/// Designs above their histories, those of a body on the same axis: P Figs. 15-22 on one page.
std::string sheet_of(const Sweep& sweep, std::span<const VariantResult> runs) {
  std::vector<io::SheetEntry> entries;
  for (size_t k = 0; k < runs.size(); ++k) {
    const VariantResult& run = runs[k];
    io::SheetEntry entry;
    entry.title = title_of(sweep, k);
    if (!run.done())
      entry.title += " (" + run.status + ")";
    else if (!run.converged())
      entry.title += " (NOT CONVERGED)";
    for (size_t i = 0; i < run.bodies.size(); ++i) {
      const std::string stem = run.bodies.size() > 1 ? "/design_" + run.bodies[i].body : "/design";
      const std::string design = text_of(run.directory + stem + ".svg");
      if (!design.empty()) entry.pictures.push_back(design);
      const auto [lowest, highest] = range_of(runs, i);
      entry.pictures.push_back(
          history_picture(run.bodies[i], 0.9 * lowest, std::min(highest, 30 * lowest)));
    }
    entries.push_back(std::move(entry));
  }
  const size_t last = sweep.varied.back().values.size();
  // Variants that differ in the last key stand side by side, where they fit on a page.
  return io::contact_sheet(sweep.case_name, entries,
                           sweep.varied.size() > 1 && last <= 6 ? static_cast<int>(last) : 4);
}

std::vector<Motions> motions_of(const Sweep& sweep, std::span<const VariantResult> runs) {
  std::vector<Motions> out;
  for (size_t k = 0; k < runs.size(); ++k)
    out.push_back(read_motions(runs[k].directory, title_of(sweep, k)));
  return out;
}

/// The table on the terminal, designs or motions.
std::vector<std::vector<std::string>> summary_of(const Sweep& sweep,
                                                 std::span<const VariantResult> runs) {
  return sweep.goals.empty() ? motion_table(motions_of(sweep, runs), runs) : table_of(sweep, runs);
}

std::optional<double> number_of(const std::string& text) {
  double value = 0;
  const char *first = text.data() + text.starts_with('+'), *last = text.data() + text.size();
  const auto [end, error] = std::from_chars(first, last, value);
  const bool whole = error == std::errc() && end == last;
  return whole && std::isfinite(value) ? std::optional(value) : std::nullopt;
}

/// Ends of the runs against the numbers of the last key, where it has three numbers or more; else
/// empty.
std::string ends_picture(const Sweep& sweep, std::span<const Motions> motions) {
  const size_t last = sweep.varied.size() - 1;
  if (sweep.varied[last].values.size() < 3) return "";
  std::vector<double> numbers;
  std::vector<std::string> curves;
  for (size_t k = 0; k < motions.size(); ++k) {
    const std::optional<double> number = number_of(sweep.value(k, last));
    if (!number) return "";
    numbers.push_back(*number);
    std::string& curve = curves.emplace_back();
    for (size_t v = 0; v < last; ++v)
      curve += (v > 0 ? ", " : "") + last_part(sweep.varied[v].key) + " = " + sweep.value(k, v);
  }
  const io::Figure figure =
      final_figure(sweep.case_name, sweep.varied[last].key, motions, numbers, curves);
  return figure.panels.empty() ? "" : io::plot_svg(figure);
}

void write_motions(const Sweep& sweep, std::span<const VariantResult> runs,
                   const std::string& stem) {
  const std::vector<Motions> motions = motions_of(sweep, runs);
  const std::vector<std::vector<std::string>> rows = motion_table(motions, runs);
  io::CsvWriter csv(stem + ".csv", rows[0]);
  for (size_t r = 1; r < rows.size(); ++r)
    csv.row(std::vector<io::Cell>(rows[r].begin(), rows[r].end()));
  io::write_file(stem + ".md", "# " + sweep.case_name + "\n\n" + io::markdown_table(rows));
  io::write_file(stem + ".svg",
                 io::plot_svg(motion_figure(sweep.case_name, motions, sweep.reference)));
  if (const std::string ends = ends_picture(sweep, motions); !ends.empty())
    io::write_file(stem + "_ends.svg", ends);
}

void write_all(const Sweep& sweep, std::span<const VariantResult> runs,
               const std::string& directory) {
  const std::string stem = directory + "/sweep";
  if (sweep.goals.empty()) return write_motions(sweep, runs, stem);
  write_csv(sweep, runs, stem + ".csv");
  io::write_file(
      stem + ".md",
      "# " + sweep.case_name + "\n\n" + io::markdown_table(table_of(sweep, runs)) +
          "\nFigure: sharp compliance x sharp volume / volume allowed (what is minimized, "
          "of the sharp design, where that is no compliance).\n" +
          convergence_note(runs));
  io::write_file(stem + ".svg", sheet_of(sweep, runs));
}

/// Goals of the designs of all variants. @throws Error (input) when some have more designs than
/// others.
std::vector<mmc::Goal> goals_of(const StudyOptions& study, std::span<const Variant> variants) {
  std::vector<mmc::Goal> out;
  std::optional<size_t> n_designs;
  for (const Variant& v : variants) {
    const Scene scene = read_scene(case_of(study, v));
    for (const BodyDesign& d : scene.designs) out.push_back(d.goal);
    if (scene.designs.size() != n_designs.value_or(scene.designs.size()))
      throw Error::input("sweep: all variants have the same number of [[design]]s, or none");
    n_designs = scene.designs.size();
  }
  return out;
}

}  // namespace

Varied read_varied(const std::string& text) {
  const size_t equal = text.find('=');
  const auto fail = [&](const std::string& what) {
    throw Error::input("--vary " + text + ": " + what + "; KEY=V1,V2,... is wanted");
  };
  if (equal == std::string::npos || equal == 0) fail("there is no key");
  Varied out{trimmed(text.substr(0, equal)), {""}};
  int depth = 0;
  char quote = 0;
  for (const char c : text.substr(equal + 1)) {
    if (quote != 0) {
      if (c == quote) quote = 0;
    } else if (c == '"' || c == '\'') {
      quote = c;
    } else if (c == '[' || c == '{') {
      ++depth;
    } else if (c == ']' || c == '}') {
      --depth;
    }
    if (c == ',' && depth == 0 && quote == 0)
      out.values.emplace_back();
    else
      out.values.back() += c;
  }
  if (depth != 0 || quote != 0) fail("a bracket or a quote is open");
  for (std::string& value : out.values) {
    value = trimmed(value);
    if (value.empty()) fail("a value is empty");
  }
  return out;
}

std::vector<Variant> combinations(const std::vector<Varied>& varied) {
  if (varied.empty()) throw Error::input("sweep: at least one --vary KEY=V1,V2,... is wanted");
  size_t count = 1;
  for (size_t i = 0; i < varied.size(); ++i) {
    count *= varied[i].values.size();
    for (size_t j = 0; j < i; ++j)
      if (varied[j].key == varied[i].key)
        throw Error::input("sweep: --vary " + varied[i].key + " is there twice");
    if (count > kMostVariants)
      throw Error::input("sweep: more than " + std::to_string(kMostVariants) + " variants");
  }
  std::vector<Variant> out;
  for (size_t k = 0; k < count; ++k) {
    Variant v;
    v.overrides.resize(varied.size());
    size_t rest = k;
    for (size_t i = varied.size(); i-- > 0;) {
      const std::string& value = varied[i].values[rest % varied[i].values.size()];
      rest /= varied[i].values.size();
      v.overrides[i] = varied[i].key + "=" + value;
    }
    for (size_t i = 0; i < varied.size(); ++i) {
      const std::string value = v.overrides[i].substr(varied[i].key.size() + 1);
      if (i > 0) v.name += ",";
      v.name.append(last_part(varied[i].key)).append("=").append(plain(value));
    }
    for (const Variant& other : out)
      if (other.name == v.name) throw Error::input("sweep: two variants are called " + v.name);
    out.push_back(std::move(v));
  }
  return out;
}

int sweep_case(const SweepOptions& options) {
  Sweep sweep;
  for (const std::string& text : options.vary) sweep.varied.push_back(read_varied(text));
  sweep.variants = combinations(sweep.varied);
  StudyOptions study = options.study;
  sweep.case_name = study.case_name;
  const int count = static_cast<int>(sweep.variants.size());
  if (options.index < 0 || options.index > count)
    throw Error::input("sweep: --index " + std::to_string(options.index) + ": 1 to " +
                       std::to_string(count));
  if (options.list) {
    for (int k = 0; k < count; ++k) {
      std::printf("%d", k + 1);
      for (const std::string& each : sweep.variants[static_cast<size_t>(k)].overrides)
        std::printf(" %s", each.c_str());
      std::printf("\n");
    }
    return 0;
  }
  if (study.directory.empty())
    study.directory =
        "runs/sweep_" + std::filesystem::path(find_case(study.case_name)).stem().string();
  if (options.index > 0) {
    const Variant& one = sweep.variants[static_cast<size_t>(options.index - 1)];
    check_variants(study, {&one, 1});
    return run_variant(study, one);
  }
  check_variants(study, sweep.variants);
  sweep.goals = goals_of(study, sweep.variants);
  if (!options.reference.empty() && !sweep.goals.empty())
    throw Error::input("sweep: --reference is for scenes without a [[design]]");
  sweep.reference = read_reference(options.reference);
  const StudyOutcome outcome = run_variants(
      study, sweep.variants,
      [&](std::span<const VariantResult> runs) { write_all(sweep, runs, study.directory); });
  std::fputs(io::aligned_table(summary_of(sweep, outcome.results)).c_str(), stdout);
  std::fputs(convergence_note(outcome.results).c_str(), stdout);
  std::printf("%s/sweep.md, .csv, .svg\n", study.directory.c_str());
  return outcome.exit_code;
}

}  // namespace flexmorph::cases
