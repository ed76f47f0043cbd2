#include "cases/compare.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "cases/run.h"
#include "cases/scene.h"
#include "cases/statistics.h"
#include "io/plots.h"
#include "io/tables.h"
#include "optim/optimizer.h"

namespace flexmorph::cases {
namespace {

using Rows = std::vector<std::vector<std::string>>;

/// Runs in the order [optimizer][start].
struct Comparison {
  std::vector<std::string> optimizers;
  int starts = 0;
  std::vector<double> max_volume;  // of every designed body; 0 where volume is minimized
  std::vector<Variant> variants;
};

Comparison plan(CompareOptions& options) {
  StudyOptions& study = options.study;
  const io::CaseFile file(find_case(study.case_name), study.overrides);
  const Scene scene = read_scene(file);
  if (scene.designs.empty())
    throw Error::input("case '" + scene.name + "' has no [[design]]: there is nothing to compare");
  Comparison out;
  out.starts = options.starts;
  out.optimizers = options.optimizers.empty() ? optim::optimizer_names() : options.optimizers;
  for (const BodyDesign& d : scene.designs)
    out.max_volume.push_back(d.goal.minimize == mmc::Goal::Minimize::compliance ? d.goal.max_volume
                                                                                : 0);
  if (study.directory.empty()) study.directory = "runs/compare_" + scene.name;
  const int budget = options.budget > 0 ? options.budget : scene.optimizer.max_iterations + 1;
  // Pictures of every iteration of every run are more than anybody looks at; --set brings them
  // back.
  study.overrides.insert(study.overrides.begin(), "output.vtk=false");
  for (const std::string& optimizer : out.optimizers)
    for (int start = 1; start <= options.starts; ++start) {
      Variant v;
      v.name = optimizer + "_" + std::to_string(start);
      v.overrides = {"optimizer.name=" + optimizer,
                     "optimizer.max_iterations=" + std::to_string(budget),
                     "optimizer.max_solves=" + std::to_string(budget)};
      for (size_t d = 0; start > 1 && d < scene.designs.size(); ++d) {
        const std::string key = "design." + std::to_string(d);
        v.overrides.push_back(key + ".jitter=" + io::to_text(options.jitter));
        v.overrides.push_back(key + ".seed=" + std::to_string(start - 1));
      }
      out.variants.push_back(std::move(v));
    }
  return out;
}

/// What designs are ranked by: sharp compliance at the volume allowed, because volumes differ a
/// little; the sharp volume where that is minimized. Bodies are multiplied.
double figure_of(const VariantResult& run, const Comparison& plan) {
  double out = 1;
  for (size_t b = 0; b < run.bodies.size(); ++b) {
    const BodyResult& r = run.bodies[b];
    out *= plan.max_volume[b] > 0 ? r.sharp_compliance * r.sharp_volume / plan.max_volume[b]
                                  : r.sharp_volume;
  }
  return run.bodies.empty() ? std::nan("") : out;
}

void write_runs(const Comparison& plan, std::span<const VariantResult> runs,
                const std::string& path) {
  const std::vector<std::string> columns = {"run",          "optimizer",    "start",
                                            "status",       "body",         "figure",
                                            "compliance",   "volume",       "sharp_compliance",
                                            "sharp_volume", "violation",    "kkt",
                                            "connected",    "min_feature",  "iterations",
                                            "state_solves", "gradients",    "factorizations",
                                            "seconds_cpu",  "seconds_wall", "seconds_design",
                                            "peaks",        "disconnected", "stop"};
  io::CsvWriter csv(path, columns);
  for (size_t k = 0; k < runs.size(); ++k) {
    const VariantResult& run = runs[k];
    const auto starts = static_cast<size_t>(plan.starts);
    const int start = static_cast<int>(k % starts) + 1;
    for (const BodyResult& r : run.bodies) {
      io::Cell feature;
      if (r.min_feature) feature = *r.min_feature;
      csv.row({run.name,
               plan.optimizers[k / starts],
               start,
               run.status,
               r.body,
               figure_of(run, plan),
               r.compliance,
               r.volume,
               r.sharp_compliance,
               r.sharp_volume,
               r.violation,
               r.kkt,
               r.connected,
               feature,
               r.iterations,
               r.solves,
               r.solves,  // one solve gives values and gradients
               r.factorizations,
               run.seconds_cpu,
               run.seconds_wall,
               r.history_seconds.empty() ? 0.0 : r.history_seconds.back(),
               r.peaks,
               r.disconnected,
               r.stop});
    }
    if (run.bodies.empty()) {
      std::vector<io::Cell> row(columns.size());
      row[0] = run.name;
      row[1] = plan.optimizers[k / starts];
      row[2] = start;
      row[3] = run.status;
      row.back() = run.message;
      csv.row(row);
    }
  }
}

/// The runs of one optimizer that are done.
std::vector<const VariantResult*> runs_of(const Comparison& plan,
                                          std::span<const VariantResult> runs, size_t optimizer) {
  std::vector<const VariantResult*> out;
  for (int s = 0; s < plan.starts; ++s) {
    const VariantResult& run =
        runs[optimizer * static_cast<size_t>(plan.starts) + static_cast<size_t>(s)];
    if (run.done() && !run.bodies.empty()) out.push_back(&run);
  }
  return out;
}

template <class Get>
std::vector<double> values_of(const std::vector<const VariantResult*>& runs, const Get& get) {
  std::vector<double> out;
  for (const VariantResult* run : runs) out.push_back(get(*run));
  return out;
}

/// A row per optimizer: medians over the starts, and the range of what they are ranked by.
Rows summary(const Comparison& plan, std::span<const VariantResult> runs) {
  Rows rows = {{"optimizer", "done", "figure: median", "range", "over best", "sharp compliance",
                "compliance", "kkt", "solves", "factorizations", "CPU s", "peaks", "connected",
                "smallest feature"}};
  double best = INFINITY;
  const auto figure = [&](const VariantResult& r) { return figure_of(r, plan); };
  for (size_t o = 0; o < plan.optimizers.size(); ++o) {
    const auto done = runs_of(plan, runs, o);
    if (!done.empty()) best = std::min(best, median(values_of(done, figure)));
  }
  for (size_t o = 0; o < plan.optimizers.size(); ++o) {
    const auto done = runs_of(plan, runs, o);
    std::vector<std::string> row = {plan.optimizers[o], io::to_text(static_cast<int>(done.size())) +
                                                            "/" + io::to_text(plan.starts)};
    if (done.empty()) {
      row.resize(rows.front().size());
      rows.push_back(row);
      continue;
    }
    const auto of_first = [&](auto member) {
      return median(values_of(done, [&](const VariantResult& r) {
        return static_cast<double>(r.bodies.front().*member);
      }));
    };
    const std::vector<double> figures = values_of(done, figure);
    const auto [least, most] = std::minmax_element(figures.begin(), figures.end());
    int connected = 0;
    double feature = INFINITY;
    for (const VariantResult* run : done) {
      bool all = true;
      for (const BodyResult& b : run->bodies) {
        all = all && b.connected;
        feature = std::min(feature, b.min_feature.value_or(INFINITY));
      }
      connected += all ? 1 : 0;
    }
    const double middle = median(figures);
    row.insert(
        row.end(),
        {io::to_text(middle, 5), io::to_text(*least, 5) + " .. " + io::to_text(*most, 5),
         io::to_text(100 * (middle / best - 1), 2) + " %",
         io::to_text(of_first(&BodyResult::sharp_compliance), 5),
         io::to_text(of_first(&BodyResult::compliance), 5),
         io::to_text(of_first(&BodyResult::kkt), 2), io::to_text(of_first(&BodyResult::solves), 4),
         io::to_text(of_first(&BodyResult::factorizations), 4),
         io::to_text(median(values_of(done, [](const VariantResult& r) { return r.seconds_cpu; })),
                     3),
         io::to_text(of_first(&BodyResult::peaks), 3),
         io::to_text(connected) + "/" + io::to_text(static_cast<int>(done.size())),
         io::to_text(feature, 3)});
    rows.push_back(row);
  }
  return rows;
}

/// Compliance of the first body over solves or over seconds: the first start bold, the others thin.
io::Panel convergence(const Comparison& plan, std::span<const VariantResult> runs, bool over_time) {
  io::Panel panel;
  panel.title = over_time ? "Convergence over time" : "Convergence over state solves";
  panel.x.label = over_time ? "CPU time of the design iterations [s]" : "state solves";
  panel.y = {"compliance [J]", true, {}, {}};
  std::vector<double> ends;
  for (size_t o = 0; o < plan.optimizers.size(); ++o) {
    bool named = false;
    for (const VariantResult* run : runs_of(plan, runs, o)) {
      const BodyResult& b = run->bodies.front();
      io::Curve curve{named ? "" : plan.optimizers[o],
                      over_time ? b.history_seconds : b.history_solves, b.history_compliance};
      curve.color = o;
      curve.thin = named;
      named = true;
      panel.curves.push_back(curve);
      if (!b.history_compliance.empty()) ends.push_back(b.history_compliance.back());
    }
  }
  if (!ends.empty()) panel.y.upper = 2.5 * median(ends);
  return panel;
}

/// Only designs of the finest band compare.
Progress progress_of(const VariantResult& run) {
  Progress out;
  if (!run.done() || run.bodies.empty()) return out;
  const BodyResult& b = run.bodies.front();
  for (size_t i = 0; i < b.history_solves.size(); ++i)
    if (b.history_band[i] == b.history_band.back() && b.history_violation[i] <= 1e-4) {
      out.solves.push_back(b.history_solves[i]);
      out.values.push_back(b.history_compliance[i]);
    }
  return out;
}

io::Panel profile_panel(const Comparison& plan, std::span<const VariantResult> runs,
                        double tolerance) {
  io::Panel panel;
  panel.title = "Data profile: share of the starts within " + io::to_text(100 * tolerance, 2) +
                " % of the best compliance found from them";
  panel.x.label = "state solves";
  panel.y = {"share of the starts", false, 0.0, 1.05};
  std::vector<std::vector<Progress>> all(plan.optimizers.size());
  double last = 1;
  for (size_t k = 0; k < runs.size(); ++k) {
    all[k / static_cast<size_t>(plan.starts)].push_back(progress_of(runs[k]));
    if (!runs[k].bodies.empty()) last = std::max(last, double(runs[k].bodies.front().solves));
  }
  const auto solved = data_profile(all, tolerance);
  for (size_t o = 0; o < solved.size(); ++o) {
    io::Curve curve{plan.optimizers[o], {0}, {0}};
    double share = 0;
    for (const double solves : solved[o]) {
      curve.x.insert(curve.x.end(), {solves, solves});
      curve.y.push_back(share);
      share += 1.0 / plan.starts;
      curve.y.push_back(share);
    }
    curve.x.push_back(last);
    curve.y.push_back(share);
    curve.color = o;
    panel.curves.push_back(curve);
  }
  return panel;
}

void write_all(const CompareOptions& options, const Comparison& plan,
               std::span<const VariantResult> runs) {
  const std::string stem = options.study.directory + "/compare";
  write_runs(plan, runs, stem + ".csv");
  std::string text = "# " + options.study.case_name + "\n\n" +
                     io::markdown_table(summary(plan, runs)) +
                     "\nFigure: sharp compliance x sharp volume / volume allowed (the sharp volume "
                     "where that is minimized). One state solve gives values and gradients.\n\n";
  Rows rows = {{"run", "status", "figure", "sharp compliance", "sharp volume", "violation", "kkt",
                "solves", "CPU s", "peaks", "stopped"}};
  for (const VariantResult& run : runs) {
    if (run.bodies.empty()) {
      rows.push_back({run.name, run.status, "", "", "", "", "", "", "", "", run.message});
      continue;
    }
    const BodyResult& b = run.bodies.front();
    rows.push_back({run.name, run.status, io::to_text(figure_of(run, plan), 5),
                    io::to_text(b.sharp_compliance, 5), io::to_text(b.sharp_volume, 5),
                    io::to_text(b.violation, 2), io::to_text(b.kkt, 2), io::to_text(b.solves),
                    io::to_text(run.seconds_cpu, 3), io::to_text(b.peaks), b.stop});
  }
  io::write_file(stem + ".md", text + io::markdown_table(rows));
  io::Figure figure;
  figure.title = options.study.case_name + ": optimizers from the same " +
                 std::to_string(plan.starts) + " starts";
  figure.width = 900;
  figure.panels = {convergence(plan, runs, false), convergence(plan, runs, true),
                   profile_panel(plan, runs, 0.05), profile_panel(plan, runs, 0.01)};
  io::write_file(stem + ".svg", io::plot_svg(figure));
}

}  // namespace

int compare_case(const CompareOptions& wanted) {
  CompareOptions options = wanted;
  const Comparison comparison = plan(options);
  check_variants(options.study, comparison.variants);
  const int code = run_variants(
      options.study, comparison.variants,
      [&](std::span<const VariantResult> runs) { write_all(options, comparison, runs); });
  const std::vector<VariantResult> runs = read_results(options.study, comparison.variants);
  std::fputs(io::aligned_table(summary(comparison, runs)).c_str(), stdout);
  std::printf("%s/compare.md, .csv, .svg\n", options.study.directory.c_str());
  return code;
}

}  // namespace flexmorph::cases
