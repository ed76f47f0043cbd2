#include "cases/study/compare_report.h"

#include <algorithm>
#include <cmath>

#include "cases/study/rows.h"
#include "cases/study/statistics.h"
#include "cases/study/study_page.h"
#include "io/files.h"
#include "io/tables.h"

namespace flexmorph::cases {
namespace {

using Rows = std::vector<std::vector<std::string>>;

/// Returns the ranking figure of a run. For several bodies it is the geometric mean, so that no
/// body dominates.
double mean_figure(const VariantResult& run, const Comparison& plan) {
  double logs = 0;
  for (size_t b = 0; b < run.bodies.size(); ++b)
    logs += std::log(figure_of(run.bodies[b], plan.table.goal(0, b)));
  return run.bodies.empty() ? std::nan("")
                            : std::exp(logs / static_cast<double>(run.bodies.size()));
}

bool connected(const VariantResult& run) {
  return std::all_of(run.bodies.begin(), run.bodies.end(),
                     [](const BodyResult& b) { return b.connected; });
}

template <class Get>
std::vector<double> values_of(const Comparison& plan, std::span<const VariantResult> runs,
                              size_t optimizer, const Get& get) {
  std::vector<double> out;
  for (const auto& [run, start] : runs_of(plan, runs, optimizer))
    out.push_back(static_cast<double>(get(*run)));
  return out;
}

/// Returns an accessor of a member of the result of the first body.
auto of_first(auto member) {
  return [member](const VariantResult& run) { return run.bodies.front().*member; };
}

/// Returns for each optimizer the number of starts from which it has the best ranking figure.
std::vector<int> wins(const Comparison& plan, std::span<const VariantResult> runs) {
  std::vector<int> out(plan.optimizers.size(), 0);
  for (size_t s = 0; s < static_cast<size_t>(plan.starts); ++s) {
    double best = INFINITY;
    std::optional<size_t> winner;
    for (size_t o = 0; o < out.size(); ++o) {
      const VariantResult& run = runs[o * static_cast<size_t>(plan.starts) + s];
      const double figure = run.done() ? mean_figure(run, plan) : std::nan("");
      if (!(figure < best)) continue;
      best = figure;
      winner = o;
    }
    if (winner) ++out[*winner];
  }
  return out;
}

/// Returns the row of an optimizer in the summary.
/// @param o     index of the optimizer
/// @param best  ranking figures of the optimizer with the best median
/// @param won   number of starts from which the optimizer has the best ranking figure
std::vector<std::string> summary_row(const Comparison& plan, std::span<const VariantResult> runs,
                                     size_t o, const std::vector<double>& best, int won) {
  const auto done = runs_of(plan, runs, o);
  const std::string starts = std::string("/").append(io::to_text(plan.starts));
  const auto met = std::count_if(done.begin(), done.end(),
                                 [](const auto& each) { return !each.first->unfinished(); });
  std::vector<std::string> row = {plan.optimizers[o],
                                  io::to_text(static_cast<int>(done.size())) + starts,
                                  io::to_text(static_cast<int>(met)) + starts};
  if (done.empty()) return row;
  const auto middle = [&](auto member, int digits) {
    return io::to_text(median(values_of(plan, runs, o, of_first(member))), digits);
  };
  const auto figures =
      values_of(plan, runs, o, [&](const VariantResult& r) { return mean_figure(r, plan); });
  const auto [least, most] = std::minmax_element(figures.begin(), figures.end());
  const auto joined = values_of(plan, runs, o, connected);
  const int whole = static_cast<int>(std::count(joined.begin(), joined.end(), 1.0));
  const double share = median(values_of(plan, runs, o, [](const VariantResult& r) {
    const BodyResult& b = r.bodies.front();
    return b.history_seconds.empty() ? 0.0 : b.seconds_optimizer / b.history_seconds.back();
  }));
  double feature = INFINITY;
  for (const auto& [run, start] : done)
    for (const BodyResult& b : run->bodies)
      feature = std::min(feature, b.min_feature.value_or(INFINITY));
  const double over = 100 * (median(figures) / median(best) - 1);
  const bool leads = over <= 0;
  const auto cpu = values_of(plan, runs, o, [](const VariantResult& r) { return r.seconds_cpu; });
  const std::vector<std::string> rest = {io::to_text(median(figures), 5),
                                         io::to_text(*least, 5) + " .. " + io::to_text(*most, 5),
                                         io::to_text(over, 2) + " %",
                                         leads                            ? "best"
                                         : distinguishable(figures, best) ? "yes"
                                                                          : "no",
                                         io::to_text(won) + starts,
                                         middle(&BodyResult::body_fitted, 5),
                                         middle(&BodyResult::crisp_compliance, 5),
                                         middle(&BodyResult::compliance, 5),
                                         middle(&BodyResult::kkt, 2),
                                         middle(&BodyResult::solves, 5),
                                         middle(&BodyResult::factorizations, 5),
                                         io::to_text(median(cpu), 3),
                                         io::to_text(100 * share, 2) + " %",
                                         middle(&BodyResult::peaks, 3),
                                         io::to_text(whole) + "/" + io::to_text(int(done.size())),
                                         std::isfinite(feature) ? io::to_text(feature, 3) : "-"};
  row.insert(row.end(), rest.begin(), rest.end());
  return row;
}

}  // namespace

std::vector<std::pair<const VariantResult*, int>> runs_of(const Comparison& plan,
                                                          std::span<const VariantResult> runs,
                                                          size_t optimizer) {
  std::vector<std::pair<const VariantResult*, int>> out;
  for (int s = 0; s < plan.starts; ++s) {
    const VariantResult& run =
        runs[optimizer * static_cast<size_t>(plan.starts) + static_cast<size_t>(s)];
    if (run.done() && !run.bodies.empty()) out.emplace_back(&run, s);
  }
  return out;
}

std::vector<std::vector<std::string>> summary_of(const Comparison& plan,
                                                 std::span<const VariantResult> runs) {
  Rows rows = {{"optimizer", "done", "finished", "figure (median)", "figure (range)", "above best",
                "distinguishable", "best starts", "body-fitted compliance", "crisp compliance",
                "compliance", "KKT residual", "state solves", "factorizations", "CPU [s]",
                "CPU of optimizer", "peaks", "connected", "smallest feature [m]"}};
  std::vector<double> best;
  for (size_t o = 0; o < plan.optimizers.size(); ++o) {
    const auto figures =
        values_of(plan, runs, o, [&](const VariantResult& r) { return mean_figure(r, plan); });
    if (!figures.empty() && (best.empty() || median(figures) < median(best))) best = figures;
  }
  const std::vector<int> won = wins(plan, runs);
  for (size_t o = 0; o < plan.optimizers.size(); ++o) {
    rows.push_back(summary_row(plan, runs, o, best, won[o]));
    rows.back().resize(rows.front().size());
  }
  return rows;
}

void write_comparison(const Comparison& plan, std::span<const VariantResult> runs,
                      const std::string& directory) {
  const std::string stem = directory + "/compare";
  write_results(plan.table, runs, stem + ".csv");
  const std::string note =
      "The numbers are medians over the starts. The figure ranks the designs: it is "
      "body-fitted compliance x volume / allowed volume. If the outline was not verified, the "
      "compliance and the volume of the crisp design are used. If the objective is not a "
      "compliance, the figure is the objective of the crisp design. Two optimizers are "
      "distinguishable if neither median lies within the range of the other; otherwise the "
      "results of the starts scatter too much for a verdict. One state solve gives values and "
      "gradients. A peak exceeds its neighbours by more than 2 % of the best compliance so "
      "far.";
  const Rows summary = summary_of(plan, runs), rows = result_rows(plan.table, runs);
  io::write_file(stem + ".md", "# " + plan.case_name + "\n\n" + io::markdown_table(summary) + "\n" +
                                   note + "\n\n" + io::markdown_table(rows) +
                                   convergence_note(runs) + rows_note(runs));
  const io::Figure figure = comparison_figure(plan, runs);
  io::write_file(stem + ".svg", io::plot_svg(figure));
  StudyPage page;
  page.title = plan.case_name + ": comparison of optimizers";
  page.notes = {note, rows_note(runs)};
  page.summary = summary;
  page.rows = rows;
  page.plots = {{"comparison", figure}};
  write_study_page(page, runs, stem + ".html");
}

}  // namespace flexmorph::cases
