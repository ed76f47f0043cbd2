#include <algorithm>

#include "cases/study/compare_report.h"
#include "cases/study/statistics.h"
#include "io/files.h"
#include "io/plots.h"

namespace flexmorph::cases {
namespace {

constexpr double kFeasible = 1e-4;  // largest relative violation of a feasible row

/// Returns a panel with the compliance of the first body. A solid line shows the best feasible
/// design so far; it is thick for the first completed run of an optimizer and thin for its other
/// runs. A dashed line shows every design of the first completed run.
io::Panel convergence(const Comparison& plan, std::span<const VariantResult> runs, bool over_time) {
  io::Panel panel;
  panel.title = over_time ? "Convergence over time" : "Convergence over state solves";
  panel.title += ": best feasible design of the stage so far; dashed: all designs";
  panel.x.label = over_time ? "CPU time of the design iterations [s]" : "state solves";
  panel.y = {"compliance [J]", true, {}, {}};
  std::vector<double> ends;
  for (size_t o = 0; o < plan.optimizers.size(); ++o) {
    bool first = true;
    for (const auto& [run, start] : runs_of(plan, runs, o)) {
      const BodyResult& b = run->bodies.front();
      io::Curve best{
          first ? plan.optimizers[o] : "", over_time ? b.history_seconds : b.history_solves,
          best_so_far(b.history_compliance, b.history_violation, b.history_stage, kFeasible)};
      best.color = o;
      best.thin = !first;
      io::Curve actual{"", best.x, b.history_compliance};
      actual.color = o;
      actual.thin = actual.dashed = true;
      if (first) panel.curves.push_back(actual);
      panel.curves.push_back(best);
      first = false;
      ends.push_back(b.compliance);
    }
  }
  // The range of the axis covers the final designs, because the compliances of the first designs
  // are larger by orders of magnitude.
  if (!ends.empty()) {
    panel.y.lower = 0.9 * *std::min_element(ends.begin(), ends.end());
    panel.y.upper = 3 * median(ends);
  }
  return panel;
}

/// Returns the last stage that any run reached.
int last_stage(std::span<const VariantResult> runs) {
  int last = 0;
  for (const VariantResult& run : runs)
    if (!run.bodies.empty() && !run.bodies.front().history_stage.empty())
      last = std::max(last, run.bodies.front().history_stage.back());
  return last;
}

/// Returns the feasible designs of one stage. Designs of different stages cannot be compared,
/// because the problem differs between stages.
SolveHistory progress_of(const VariantResult& run, int stage) {
  SolveHistory out;
  if (!run.done() || run.bodies.empty()) return out;
  const BodyResult& b = run.bodies.front();
  for (size_t i = 0; i < b.history_solves.size(); ++i)
    if (b.history_stage[i] == stage && b.history_violation[i] <= kFeasible) {
      out.solves.push_back(b.history_solves[i]);
      out.values.push_back(b.history_compliance[i]);
    }
  return out;
}

io::Panel profile_panel(const Comparison& plan, std::span<const VariantResult> runs,
                        double tolerance) {
  io::Panel panel;
  panel.title = "Data profile: fraction of the starts within " + io::to_text(100 * tolerance, 2) +
                " % of the best compliance from that start";
  panel.x.label = "state solves";
  panel.y = {"fraction of the starts", false, 0.0, 1.05};
  std::vector<std::vector<SolveHistory>> all(plan.optimizers.size());
  const int stage = last_stage(runs);
  double last = 1;
  for (size_t k = 0; k < runs.size(); ++k) {
    all[k / static_cast<size_t>(plan.starts)].push_back(progress_of(runs[k], stage));
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

}  // namespace

io::Figure comparison_figure(const Comparison& plan, std::span<const VariantResult> runs) {
  io::Figure figure;
  figure.title = plan.case_name + ": comparison of optimizers, " + std::to_string(plan.starts) +
                 (plan.starts == 1 ? " start" : " starts");
  figure.width = 900;
  figure.panels = {convergence(plan, runs, false), convergence(plan, runs, true),
                   profile_panel(plan, runs, 0.05), profile_panel(plan, runs, 0.01)};
  return figure;
}

}  // namespace flexmorph::cases
