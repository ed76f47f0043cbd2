#include "cases/study/result_table.h"

#include <algorithm>
#include <cmath>

#include "cases/study/sweep_motion.h"
#include "io/tables.h"

namespace flexmorph::cases {
namespace {

/// One row of a table: a designed body of a run, with its goal.
struct Entry {
  const VariantResult& run;
  const BodyResult& body;
  const mmc::Goal& goal;
};

/// A column with a number of a result.
struct NumberColumn {
  const char* name;
  int digits;  ///< Number of digits in reports; 0: the column is only in CSV files.
  double (*value)(const Entry& e);
};

const std::vector<NumberColumn>& number_columns() {
  static const std::vector<NumberColumn> kColumns = {
      {"figure", 5, [](const Entry& e) { return figure_of(e.body, e.goal); }},
      {"compliance", 5, [](const Entry& e) { return e.body.compliance; }},
      {"volume", 5, [](const Entry& e) { return e.body.volume; }},
      {"crisp_compliance", 5, [](const Entry& e) { return e.body.crisp_compliance; }},
      {"crisp_volume", 5, [](const Entry& e) { return e.body.crisp_volume; }},
      {"body_fitted", 5, [](const Entry& e) { return e.body.body_fitted; }},
      {"body_fitted_error", 0, [](const Entry& e) { return e.body.body_fitted_error; }},
      {"body_fitted_volume", 0, [](const Entry& e) { return e.body.body_fitted_volume; }},
      {"uniform_compliance", 4, [](const Entry& e) { return e.body.uniform_compliance; }},
      {"violation", 2, [](const Entry& e) { return violation_of(e.body, e.goal); }},
      {"kkt", 2, [](const Entry& e) { return e.body.kkt; }},
      {"connected", 1, [](const Entry& e) { return 1.0 * e.body.connected; }},
      {"min_feature", 4, [](const Entry& e) { return e.body.min_feature.value_or(std::nan("")); }},
      {"largest_tip_deflection", 4,
       [](const Entry& e) {
         const auto deflection = deflection_of(e.run, e.body.body);
         return deflection ? deflection->largest() : std::nan("");
       }},
      {"components", 5, [](const Entry& e) { return 1.0 * e.body.components; }},
      {"peaks", 5, [](const Entry& e) { return 1.0 * e.body.peaks; }},
      {"disconnected", 0, [](const Entry& e) { return 1.0 * e.body.disconnected; }},
      {"iterations", 9, [](const Entry& e) { return 1.0 * e.body.iterations; }},
      {"state_solves", 9, [](const Entry& e) { return 1.0 * e.body.solves; }},
      {"factorizations", 0, [](const Entry& e) { return 1.0 * e.body.factorizations; }},
      {"seconds_cpu", 3, [](const Entry& e) { return e.run.seconds_cpu; }},
      {"seconds_wall", 0, [](const Entry& e) { return e.run.seconds_wall; }},
      {"seconds_design", 0,
       [](const Entry& e) {
         return e.body.history_seconds.empty() ? 0.0 : e.body.history_seconds.back();
       }},
      {"seconds_optimizer", 0, [](const Entry& e) { return e.body.seconds_optimizer; }}};
  return kColumns;
}

/// Returns the value of a response; NaN if the name is missing.
double value_of(const mmc::Figures& figures, const std::string& name) {
  const auto found = figures.find(name);
  return found == figures.end() ? std::nan("") : found->second;
}

/// Calls `row` for every entry of every run, with the first cells of the run; for a run without
/// designs it calls `row` once with a null entry.
template <class Row>
void for_rows(const ResultTable& table, std::span<const VariantResult> runs, const Row& row) {
  for (size_t k = 0; k < runs.size(); ++k) {
    for (size_t b = 0; b < runs[k].bodies.size(); ++b) {
      const Entry entry{runs[k], runs[k].bodies[b], table.goal(k, b)};
      row(table.values[k], runs[k], &entry);
    }
    if (runs[k].bodies.empty()) row(table.values[k], runs[k], static_cast<const Entry*>(nullptr));
  }
}

}  // namespace

double figure_of(const BodyResult& result, const mmc::Goal& goal) {
  if (goal.objective == &mmc::kVolume) return result.crisp_volume;
  if (!goal.objective->needs_state())
    return value_of(result.further, "crisp_" + mmc::key_of(*goal.objective));
  const std::optional<double> allowed = mmc::allowed_volume(goal);
  const bool fitted = !std::isnan(result.body_fitted);
  const double compliance = fitted ? result.body_fitted : result.crisp_compliance,
               volume = fitted ? result.body_fitted_volume : result.crisp_volume;
  return allowed ? compliance * volume / *allowed : compliance;
}

double violation_of(const BodyResult& result, const mmc::Goal& goal) {
  double out = 0;
  for (const mmc::Limit& limit : goal.limits) {
    const double value = limit.row == &mmc::kVolume ? result.volume
                         : limit.row == &mmc::compliance_row(goal)
                             ? result.compliance
                             : value_of(result.further, mmc::key_of(*limit.row));
    const double excess = limit.excess(value);
    if (!(excess <= out)) out = excess;  // a missing value gives NaN
  }
  return out;
}

void write_results(const ResultTable& table, std::span<const VariantResult> runs,
                   const std::string& path) {
  std::vector<std::string> names = table.names;
  names.insert(names.end(), {"status", "body"});
  for (const NumberColumn& column : number_columns()) names.emplace_back(column.name);
  names.insert(names.end(), {"verdict", "stop", "message"});
  io::CsvWriter csv(path, names);
  for_rows(table, runs, [&](const auto& head, const VariantResult& run, const Entry* entry) {
    std::vector<io::Cell> row(head.begin(), head.end());
    row.emplace_back(run.status);
    row.emplace_back(entry ? entry->body.body : "");
    for (const NumberColumn& column : number_columns()) {
      const double value = entry ? column.value(*entry) : std::nan("");
      row.push_back(std::isnan(value) ? io::Cell() : io::Cell(value));
    }
    row.emplace_back(entry ? entry->body.verdict : "");
    row.emplace_back(entry ? entry->body.stop : "");
    row.emplace_back(run.message);
    csv.row(row);
  });
}

std::vector<std::vector<std::string>> result_rows(const ResultTable& table,
                                                  std::span<const VariantResult> runs) {
  std::vector<std::vector<std::string>> rows = {table.names};
  const bool several = table.n_bodies() > 1;
  if (several) rows[0].emplace_back("body");
  rows[0].emplace_back("status");
  for (const NumberColumn& column : number_columns())
    if (column.digits > 0) rows[0].emplace_back(column.name);
  rows[0].emplace_back("stopped by");
  for_rows(table, runs, [&](const auto& head, const VariantResult& run, const Entry* entry) {
    std::vector<std::string>& row = rows.emplace_back(head);
    if (several) row.push_back(entry ? entry->body.body : "");
    const bool failed = !entry && !run.message.empty();
    row.push_back(run.words() + (failed ? ": " + run.message : ""));
    for (const NumberColumn& column : number_columns()) {
      if (column.digits == 0) continue;
      const double value = entry ? column.value(*entry) : std::nan("");
      row.push_back(std::isnan(value) ? "-" : io::to_text(value, column.digits));
    }
    row.push_back(entry ? entry->body.stop.substr(0, entry->body.stop.find(':')) : "");
  });
  return rows;
}

}  // namespace flexmorph::cases
