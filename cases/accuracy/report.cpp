#include "cases/accuracy/report.h"

#include <algorithm>
#include <cmath>

#include "io/plots.h"
#include "io/tables.h"

namespace flexmorph::cases {
namespace {

using io::to_text;
using Rows = std::vector<std::vector<std::string>>;

constexpr double kLeastError = 1e-12;  // in pictures: less is rounding

std::string percent(double share) {
  return std::isfinite(share) ? to_text(100 * share, 2) + " %" : "?";
}

std::string name_of(const AccuracyStudy& study, const Ladder& ladder) {
  const bool twice = std::count_if(study.ladders.begin(), study.ladders.end(),
                                   [&](const Ladder& l) { return l.knob == ladder.knob; }) > 1;
  return ladder.knob->name + (twice ? " (" + to_string(ladder.part) + ")" : "");
}

/// Quantities of a ladder's part.
std::vector<size_t> quantities_of(const AccuracyStudy& study, const Ladder& ladder) {
  std::vector<size_t> out;
  for (size_t q = 0; q < study.parts.size(); ++q)
    if (study.parts[q] == ladder.part) out.push_back(q);
  return out;
}

/// The order that the triple with this rung as its finest one has.
std::string order_at(const Ladder& ladder, size_t rung, size_t q) {
  if (!ladder.rungs[rung].measured() || ladder.limits[q].orders.empty()) return "";
  size_t place = 0;
  for (size_t i = 0; i < rung; ++i) place += ladder.rungs[i].measured();
  if (place < 2 || place - 2 >= ladder.limits[q].orders.size()) return "";
  const double order = ladder.limits[q].orders[place - 2];
  return std::isfinite(order) ? to_text(order, 3) : "-";
}

Rows quantity_rows(const AccuracyStudy& study) {
  Rows rows = {{"quantity", "value", "limit", "known to", "off by", "reference", "limit off by"}};
  for (size_t q = 0; q < study.truths.size(); ++q) {
    const Truth& t = study.truths[q];
    std::vector<std::string>& row = rows.emplace_back();
    row = {study.interests[q].words(),
           to_text(t.own, 9),
           !t.has_limit                   ? "none"
           : std::isfinite(t.uncertainty) ? to_text(t.value, 9)
                                          : "?",
           percent(t.uncertainty),
           percent(std::abs(t.own - t.value) / t.scale),
           "",
           ""};
    if (!t.reference) continue;
    row[5] = to_text(*t.reference, 9) + " (" + study.interests[q].source + ")";
    row[6] = percent(std::abs(t.value - *t.reference) / t.scale);
  }
  return rows;
}

Rows ladder_rows(const AccuracyStudy& study, const Ladder& ladder) {
  const std::vector<size_t> quantities = quantities_of(study, ladder);
  Rows rows = {{ladder.knob->name}};
  for (const size_t q : quantities) {
    const std::string of = quantities.size() > 1 ? " of " + study.interests[q].words() : "";
    rows[0].insert(rows[0].end(), {study.interests[q].words(), "error" + of, "order" + of});
  }
  for (const char* name : {"unknowns", "CPU s", "wall s", "MB", ""}) rows[0].emplace_back(name);
  for (size_t i = 0; i < ladder.rungs.size(); ++i) {
    const Rung& rung = ladder.rungs[i];
    if (rung.status == "refused") continue;
    std::vector<std::string>& row = rows.emplace_back();
    row.push_back(rung.level.name + (rung.is_own() ? " *" : ""));
    for (const size_t q : quantities) {
      row.push_back(rung.measured() ? to_text(rung.values[q], 9) : "");
      const double error = rung.errors[q];
      row.push_back(
          !std::isfinite(error) ? "" : std::string(rung.measured() ? "" : "~") + to_text(error, 2));
      row.push_back(order_at(ladder, i, q));
    }
    const bool measured = rung.measured();
    row.push_back(rung.unknowns > 0 ? to_text(rung.unknowns) : "");
    row.push_back(
        measured
            ? to_text(rung.seconds_cpu, 3)
            : (rung.predicted_cpu > 0 ? std::string("~") + to_text(rung.predicted_cpu, 2) : ""));
    row.push_back(measured ? to_text(rung.seconds_wall, 3) : "");
    row.push_back(measured ? to_text(1e-6 * rung.memory, 3) : "");
    row.push_back(measured ? "" : rung.status + (rung.message.empty() ? "" : ": " + rung.message));
  }
  return rows;
}

/// One sentence per quantity.
std::vector<std::string> ladder_words(const AccuracyStudy& study, const Ladder& ladder) {
  std::vector<std::string> out;
  if (!ladder.knob->is_ladder)
    return {"errors against the limit of " + ladder.knob->group + "; no limit of its own"};
  for (const size_t q : quantities_of(study, ladder)) {
    const Limit& limit = ladder.limits[q];
    std::string words = study.interests[q].words() + ": " +
                        (limit.converged ? "converged, " : "not converged: ") + limit.sentence;
    if (!ladder.leads()) {
      for (const Ladder& leader : study.ladders)
        if (leader.leads() && leader.knob->group == ladder.knob->group &&
            leader.part == ladder.part && std::isfinite(limit.value))
          words += "; its limit differs from that of " + leader.knob->name + " by " +
                   percent(std::abs(limit.value - leader.limits[q].value) / study.truths[q].scale);
    }
    out.push_back(words);
  }
  if (const size_t cut = ladder.count("cut"); cut > 0)
    out.push_back("cut by the budget: " + std::to_string(cut) + " of " +
                  std::to_string(ladder.rungs.size() - ladder.count("refused")) + " levels");
  return out;
}

Rows recommendation_rows(const AccuracyStudy& study) {
  Rows rows = {{"promise", "settings", "predicted error", "measured error", "CPU s predicted",
                "CPU s", "verdict", "file"}};
  const auto largest = [](const std::vector<double>& errors) {
    double out = 0;
    for (const double e : errors) out = std::isnan(e) ? e : std::max(out, e);
    return percent(out);
  };
  for (const Recommendation& r : study.recommendations) {
    std::vector<double> found;
    for (size_t q = 0; q < r.found.size(); ++q)
      if (r.covers[q]) found.push_back(r.found[q]);
    std::string names;
    for (const std::string& name : r.names) names += (names.empty() ? "" : "; ") + name;
    rows.push_back({percent(r.promise), names, r.choice ? largest(r.choice->errors) : "",
                    r.verified ? largest(found) : "", r.choice ? to_text(r.choice->cost, 3) : "",
                    r.verified ? to_text(r.seconds_cpu, 3) : "", r.sentence, r.file});
  }
  return rows;
}

std::string absent_words(const AccuracyStudy& study) {
  std::string out;
  for (const auto& [name, why] : study.absent)
    out += (out.empty() ? "" : "; ") + name + " (" + why + ")";
  return out;
}

std::string composed(const AccuracyStudy& study, bool markdown) {
  const auto table = [&](const Rows& rows) {
    return (markdown ? io::markdown_table(rows) : io::aligned_table(rows)) + "\n";
  };
  const std::string head = markdown ? "## " : "";
  std::string out = (markdown ? "# " : "") + study.title + "\n\n";
  out += table(quantity_rows(study));
  for (const Ladder& ladder : study.ladders) {
    out += head + name_of(study, ladder) + "\n" + (markdown ? "\n" : "");
    out += table(ladder_rows(study, ladder));
    for (const std::string& words : ladder_words(study, ladder))
      out += (markdown ? "- " : "  ") + words + "\n";
    out += "\n";
  }
  if (!study.absent.empty())
    out += std::string(markdown ? "Absent: " : "absent: ") + absent_words(study) + "\n\n";
  out += head + "Cheapest settings\n" + (markdown ? "\n" : "");
  out += table(recommendation_rows(study));
  if (markdown)
    out +=
        "A star marks the case as it is; `~` what the fitted order predicts. The error of a "
        "level is that against the limit of its own ladder, other knobs as in the case. Limits "
        "add what is missing to each ladder's limit to the value of the case; a promise is the "
        "sum of the errors over all knobs and of what the limits are uncertain by. The promise "
        "covers these knobs only.\n";
  return out;
}

/// Error of the whole run, where its limit is bounded, against the time it takes.
io::Panel times_panel(const AccuracyStudy& study, size_t q) {
  const Truth& truth = study.truths[q];
  const bool whole = truth.has_limit && std::isfinite(truth.uncertainty);
  io::Panel out;
  out.title = study.interests[q].words() + ": error against CPU time";
  out.x = {"CPU time [s]", true};
  out.y = {whole ? "error of all knobs together [-]" : "error against the ladder's limit [-]",
           true};
  std::vector<std::pair<double, double>> points;
  size_t color = 0;
  for (const Ladder& ladder : study.ladders) {
    if (ladder.part != study.parts[q]) continue;
    io::Curve curve;
    for (const Rung& rung : ladder.rungs) {
      if (!rung.measured()) continue;
      const double error =
          whole ? std::abs(rung.values[q] - truth.value) / truth.scale : rung.errors[q];
      if (!(error > kLeastError)) continue;
      curve.x.push_back(rung.seconds_cpu);
      curve.y.push_back(error);
      points.emplace_back(rung.seconds_cpu, error);
    }
    curve.name = ladder.knob->name;
    curve.markers = true;
    curve.line = ladder.knob->is_ladder;
    curve.color = color++;
    if (!curve.x.empty()) out.curves.push_back(curve);
  }
  const auto dashed = [&](const std::string& name) {
    io::Curve curve;
    curve.name = name;
    curve.dashed = true;
    curve.color = color++;
    return curve;
  };
  io::Curve front = dashed("Pareto front");
  for (const size_t i : pareto_front(points)) {
    front.x.push_back(points[i].first);
    front.y.push_back(points[i].second);
  }
  if (front.x.size() > 1) out.curves.push_back(front);
  if (whole && truth.uncertainty > kLeastError && !points.empty()) {
    const auto [first, last] = std::minmax_element(points.begin(), points.end());
    io::Curve known = dashed("what the limit is known to");
    known.x = {first->first, last->first};
    known.y = {truth.uncertainty, truth.uncertainty};
    out.curves.push_back(known);
  }
  return out;
}

/// Errors against the limits of the ladders, with the orders of those that converge.
io::Panel knobs_panel(const AccuracyStudy& study, size_t q) {
  io::Panel out;
  out.title = study.interests[q].words() + ": error against the knobs";
  out.x = {"knob, relative to the case", true};
  out.y = {"error against the ladder's limit [-]", true};
  size_t color = 0;
  for (const Ladder& ladder : study.ladders) {
    if (ladder.part != study.parts[q]) continue;
    io::Curve curve, fit;
    for (const Rung& rung : ladder.rungs) {
      if (!rung.measured() || !(rung.errors[q] > kLeastError)) continue;
      curve.x.push_back(rung.level.h);
      curve.y.push_back(rung.errors[q]);
    }
    curve.name = ladder.knob->name;
    curve.markers = true;
    curve.color = fit.color = color++;
    if (!ladder.knob->is_ladder || curve.x.empty()) continue;
    out.curves.push_back(curve);
    const Limit& limit = ladder.limits[q];
    if (!ladder.leads() || !limit.converged || !std::isfinite(limit.order) || curve.x.size() < 2)
      continue;
    fit.name = "order " + to_text(limit.order, 3);
    fit.dashed = true;
    fit.x = {curve.x.front(), curve.x.back()};
    const double end = curve.y.back();
    fit.y = {end * std::pow(fit.x[0] / fit.x[1], limit.order), end};
    out.curves.push_back(fit);
  }
  return out;
}

}  // namespace

std::string accuracy_text(const AccuracyStudy& study) { return composed(study, false); }
std::string accuracy_markdown(const AccuracyStudy& study) { return composed(study, true); }

void write_accuracy_csv(const AccuracyStudy& study, const std::string& path) {
  const std::vector<std::string> columns = {
      "part",        "ladder",      "level",    "h",       "status",
      "quantity",    "value",       "error",    "order",   "limit",
      "uncertainty", "converged",   "unknowns", "message", "peak_memory_bytes",
      "seconds_cpu", "seconds_wall"};
  io::CsvWriter csv(path, columns);
  const auto cell = [](double value) {
    return std::isfinite(value) ? io::Cell(value) : io::Cell();
  };
  for (const Ladder& ladder : study.ladders)
    for (size_t i = 0; i < ladder.rungs.size(); ++i) {
      const Rung& rung = ladder.rungs[i];
      for (const size_t q : quantities_of(study, ladder)) {
        const Limit& limit = ladder.limits[q];
        std::vector<io::Cell> row = {
            to_string(ladder.part), ladder.knob->name, rung.level.name,
            rung.level.h,           rung.status,       study.interests[q].words()};
        row.push_back(rung.measured() ? cell(rung.values[q]) : io::Cell());
        row.push_back(cell(rung.errors[q]));
        row.emplace_back(order_at(ladder, i, q));
        row.insert(row.end(), {cell(limit.value), cell(limit.uncertainty), limit.converged,
                               rung.unknowns, rung.message});
        const bool measured = rung.measured();
        for (const double value : {rung.memory, rung.seconds_cpu, rung.seconds_wall})
          row.push_back(measured ? io::Cell(value) : io::Cell());
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
    figure.panels.push_back(knobs_panel(study, q));
  }
  return io::plot_svg(figure);
}

}  // namespace flexmorph::cases
