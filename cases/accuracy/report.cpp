#include "cases/accuracy/report.h"

#include <algorithm>
#include <cmath>

#include "geometry/text.h"
#include "io/plots.h"
#include "io/screen.h"
#include "io/tables.h"

namespace flexmorph::cases {
namespace {

using io::to_text;
using Rows = std::vector<std::vector<std::string>>;

constexpr double kMinError = 1e-12;  // smallest error in plots; smaller ones are rounding

std::string percent(double share) {
  return std::isfinite(share) ? to_text(100 * share, 2) + " %" : "?";
}

/// Returns the indices of the quantities of a subproblem.
std::vector<size_t> quantities_of(const AccuracyStudy& study, Part part) {
  std::vector<size_t> out;
  for (size_t q = 0; q < study.parts.size(); ++q)
    if (study.parts[q] == part) out.push_back(q);
  return out;
}

/// Returns the order of the triple of levels whose finest level is the given one, as text; empty if
/// there is no such triple, "-" if the triple has no order.
std::string order_at(const RefinementSeries& series, size_t level, size_t q) {
  const std::vector<double>& orders = series.limits[q].orders;
  size_t before = 0;
  for (size_t i = 0; i < level; ++i) before += series.levels[i].measured();
  if (!series.levels[level].measured() || before < 2 || before - 2 >= orders.size()) return "";
  return std::isfinite(orders[before - 2]) ? to_text(orders[before - 2], 3) : "-";
}

Rows quantity_rows(const AccuracyStudy& study) {
  Rows rows = {{"quantity", "value", "limit", "uncertainty", "error", "reference", "difference"}};
  for (size_t q = 0; q < study.estimates.size(); ++q) {
    const Estimate& e = study.estimates[q];
    const std::string limit = !e.has_limit                   ? "none"
                              : std::isfinite(e.uncertainty) ? to_text(e.value, 9)
                                                             : "?";
    const std::optional<double>& reference = study.references[q];
    rows.push_back(
        {study.interests[q].words(), to_text(e.own, 9), limit, percent(e.uncertainty),
         percent(std::abs(e.own - e.value) / e.scale),
         reference ? to_text(*reference, 9) + " (" + study.interests[q].source + ")" : "",
         reference ? percent(std::abs(e.value - *reference) / e.scale) : ""});
  }
  return rows;
}

Rows series_rows(const AccuracyStudy& study, const RefinementSeries& series) {
  const std::vector<size_t> quantities = quantities_of(study, series.part);
  Rows rows = {{series.parameter->name}};
  for (const size_t q : quantities) {
    const std::string of = quantities.size() > 1 ? " of " + study.interests[q].words() : "";
    rows[0].insert(rows[0].end(), {study.interests[q].words(), "error" + of, "order" + of});
  }
  rows[0].insert(rows[0].end(), {"unknowns", "CPU [s]", "memory [MB]", "note"});
  for (size_t i = 0; i < series.levels.size(); ++i) {
    const LevelRun& run = series.levels[i];
    if (run.status == "refused") continue;
    const bool measured = run.measured();
    const std::string predicted = measured ? "" : "~";
    std::vector<std::string>& row = rows.emplace_back();
    row.push_back(run.level.name + (run.is_case() ? " *" : ""));
    for (const size_t q : quantities) {
      row.push_back(measured ? to_text(run.values[q], 9) : "");
      row.push_back(std::isfinite(run.errors[q]) ? predicted + to_text(run.errors[q], 2) : "");
      row.push_back(order_at(series, i, q));
    }
    row.push_back(run.unknowns > 0 ? to_text(run.unknowns) : "");
    row.push_back(measured || run.status == "cut"
                      ? predicted + to_text(series.seconds(i), measured ? 3 : 2)
                      : "");
    row.push_back(measured ? to_text(1e-6 * run.memory, 3) : "");
    row.push_back(measured ? "" : run.status + (run.message.empty() ? "" : ": " + run.message));
  }
  return rows;
}

/// Returns a message per quantity, and a message on the levels that were cut by the budget.
std::vector<std::string> series_sentences(const AccuracyStudy& study,
                                          const RefinementSeries& series) {
  const std::string& group = series.parameter->group;
  if (!series.parameter->has_limit)
    return {"errors refer to the limit of " + group +
            ", because this series has no limit of its own"};
  const RefinementSeries* leader = leader_of(study, group, series.part);
  std::vector<std::string> out;
  for (const size_t q : quantities_of(study, series.part)) {
    const ExtrapolatedLimit& limit = series.limits[q];
    out.push_back(study.interests[q].words() + ": " +
                  (limit.converged ? "converged, " : "not converged: ") + limit.sentence);
    if (leader && leader != &series && std::isfinite(limit.value))
      out.back() +=
          "; its limit differs from the limit of " + group + " by " +
          percent(std::abs(limit.value - leader->limits[q].value) / study.estimates[q].scale);
  }
  if (const size_t cut = series.count("cut"); cut > 0)
    out.push_back("not measured because of the budget: " + std::to_string(cut) + " of " +
                  std::to_string(series.levels.size() - series.count("refused")) + " levels");
  return out;
}

Rows recommendation_rows(const AccuracyStudy& study) {
  Rows rows = {{"target error", "settings", "predicted error", "measured error",
                "predicted CPU [s]", "measured CPU [s]", "verdict", "file"}};
  for (const Recommendation& r : study.recommendations) {
    const bool found = !r.names.empty();
    rows.push_back({percent(r.target), joined(r.names, "; "), found ? percent(r.error) : "",
                    r.verified ? percent(r.measured_error) : "", found ? to_text(r.seconds, 3) : "",
                    r.verified ? to_text(r.seconds_cpu, 3) : "", r.sentence, r.file});
  }
  return rows;
}

std::string report_of(const AccuracyStudy& study, bool markdown) {
  const auto table = [&](const Rows& rows) {
    return (markdown ? io::markdown_table(rows)
                     : io::fitted_table(rows, io::screen_width(), "accuracy.md")) +
           "\n";
  };
  const auto heading = [&](const std::string& words) {
    return markdown ? "## " + words + "\n\n" : words + "\n";
  };
  std::string out = (markdown ? "# " : "") + study.title + "\n\n" + table(quantity_rows(study));
  for (const RefinementSeries& series : study.series) {
    const bool twice =
        std::count_if(study.series.begin(), study.series.end(), [&](const RefinementSeries& s) {
          return s.parameter == series.parameter;
        }) > 1;
    out += heading(series.parameter->name + (twice ? " (" + to_string(series.part) + ")" : "")) +
           table(series_rows(study, series));
    for (const std::string& words : series_sentences(study, series))
      out += (markdown ? "- " : "  ") + words + "\n";
    out += "\n";
  }
  for (const auto& [name, why] : study.absent) out += "not refined: " + name + " (" + why + ")\n\n";
  out += heading("Cheapest settings") + table(recommendation_rows(study));
  if (markdown)
    out +=
        "A star marks the unchanged case; `~` marks numbers that the fitted order predicts. The "
        "error of a level is its difference from the limit of its own refinement series, with all "
        "other parameters as in the case. The limit of a quantity is the value of the case plus "
        "the differences to the limits of all refinement series. The column `difference` compares "
        "this limit with the reference. The error of settings is the sum of the errors of all "
        "refined parameters and of the uncertainties of their limits. It does not cover other "
        "parameters.\n";
  return out;
}

io::Curve curve_of(const std::string& name, std::optional<size_t> color, bool dashed) {
  io::Curve out;
  out.name = name;
  out.color = color;
  out.dashed = dashed;
  out.markers = !dashed;
  return out;
}

/// Plots errors of a quantity against CPU time. They are the errors of all parameters together if
/// the limit of the quantity is bounded, else the errors against the limits of the series.
io::Panel times_panel(const AccuracyStudy& study, size_t q) {
  const Estimate& estimate = study.estimates[q];
  const bool whole = estimate.has_limit && std::isfinite(estimate.uncertainty);
  io::Panel out;
  out.title = study.interests[q].words() + ": error over CPU time";
  out.x = {"CPU time [s]", true};
  out.y = {whole ? "total error of all parameters [-]" : "error to the limit of the series [-]",
           true};
  std::vector<std::pair<double, double>> points;
  size_t color = 0;
  for (const RefinementSeries& series : study.series) {
    if (series.part != study.parts[q]) continue;
    io::Curve curve = curve_of(series.parameter->name, color++, false);
    curve.line = series.parameter->has_limit;
    for (const LevelRun& run : series.levels) {
      if (!run.measured()) continue;
      const double error =
          whole ? std::abs(run.values[q] - estimate.value) / estimate.scale : run.errors[q];
      if (!(error > kMinError)) continue;
      curve.x.push_back(run.seconds_cpu);
      curve.y.push_back(error);
      points.emplace_back(run.seconds_cpu, error);
    }
    if (!curve.x.empty()) out.curves.push_back(curve);
  }
  io::Curve front = curve_of("Pareto front", color++, true);
  for (const size_t i : pareto_front(points)) {
    front.x.push_back(points[i].first);
    front.y.push_back(points[i].second);
  }
  if (front.x.size() > 1) out.curves.push_back(front);
  if (whole && estimate.uncertainty > kMinError && !points.empty()) {
    const auto [first, last] = std::minmax_element(points.begin(), points.end());
    io::Curve known = curve_of("uncertainty of the limit", color, true);
    known.x = {first->first, last->first};
    known.y = {estimate.uncertainty, estimate.uncertainty};
    out.curves.push_back(known);
  }
  return out;
}

/// Plots errors against the discretization parameters, with the fitted orders of converged series.
io::Panel parameters_panel(const AccuracyStudy& study, size_t q) {
  io::Panel out;
  out.title = study.interests[q].words() + ": error over the parameters";
  out.x = {"parameter divided by its value in the case", true};
  out.y = {"error to the limit of the series [-]", true};
  size_t color = 0;
  for (const RefinementSeries& series : study.series) {
    if (series.part != study.parts[q]) continue;
    io::Curve curve = curve_of(series.parameter->name, color++, false);
    for (const LevelRun& run : series.levels) {
      if (!run.measured() || !(run.errors[q] > kMinError)) continue;
      curve.x.push_back(run.level.h);
      curve.y.push_back(run.errors[q]);
    }
    if (!series.parameter->has_limit || curve.x.empty()) continue;
    out.curves.push_back(curve);
    const ExtrapolatedLimit& limit = series.limits[q];
    if (!series.leads() || !limit.converged || !std::isfinite(limit.order) || curve.x.size() < 2)
      continue;
    io::Curve fit = curve_of("order " + to_text(limit.order, 3), curve.color, true);
    fit.x = {curve.x.front(), curve.x.back()};
    fit.y = {curve.y.back() * std::pow(fit.x[0] / fit.x[1], limit.order), curve.y.back()};
    out.curves.push_back(fit);
  }
  return out;
}

}  // namespace

std::string accuracy_text(const AccuracyStudy& study) { return report_of(study, false); }
std::string accuracy_markdown(const AccuracyStudy& study) { return report_of(study, true); }

void write_accuracy_csv(const AccuracyStudy& study, const std::string& path) {
  const std::vector<std::string> columns = {"part",
                                            "refinement series",
                                            "level",
                                            "h",
                                            "status",
                                            "quantity",
                                            "value",
                                            "error",
                                            "order",
                                            "limit",
                                            "uncertainty",
                                            "converged",
                                            "unknowns",
                                            "message",
                                            "peak_memory_bytes",
                                            "seconds_cpu"};
  io::CsvWriter csv(path, columns);
  const auto cell = [](double value) {
    return std::isfinite(value) ? io::Cell(value) : io::Cell();
  };
  for (const RefinementSeries& series : study.series)
    for (size_t i = 0; i < series.levels.size(); ++i) {
      const LevelRun& run = series.levels[i];
      const bool measured = run.measured();
      for (const size_t q : quantities_of(study, series.part)) {
        const ExtrapolatedLimit& limit = series.limits[q];
        const std::vector<io::Cell> row = {to_string(series.part),
                                           series.parameter->name,
                                           run.level.name,
                                           run.level.h,
                                           run.status,
                                           study.interests[q].words(),
                                           measured ? cell(run.values[q]) : io::Cell(),
                                           cell(run.errors[q]),
                                           order_at(series, i, q),
                                           cell(limit.value),
                                           cell(limit.uncertainty),
                                           limit.converged,
                                           run.unknowns,
                                           run.message,
                                           measured ? io::Cell(run.memory) : io::Cell(),
                                           measured ? io::Cell(run.seconds_cpu) : io::Cell()};
        csv.row(row);
      }
    }
}

std::string accuracy_svg(const AccuracyStudy& study) {
  io::Figure figure;
  figure.title = study.title;
  figure.panel_height = 360;
  for (size_t q = 0; q < study.interests.size(); ++q) {
    figure.panels.push_back(times_panel(study, q));
    figure.panels.push_back(parameters_panel(study, q));
  }
  return io::plot_svg(figure);
}

std::vector<size_t> pareto_front(const std::vector<std::pair<double, double>>& points) {
  std::vector<size_t> order;
  for (size_t i = 0; i < points.size(); ++i)
    if (std::isfinite(points[i].first) && std::isfinite(points[i].second)) order.push_back(i);
  std::stable_sort(order.begin(), order.end(),
                   [&](size_t a, size_t b) { return points[a] < points[b]; });
  std::vector<size_t> out;
  for (const size_t i : order)
    if (out.empty() || points[i].second < points[out.back()].second) out.push_back(i);
  return out;
}

}  // namespace flexmorph::cases
