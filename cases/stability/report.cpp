#include <algorithm>
#include <array>

#include "cases/stability/stability.h"
#include "io/files.h"
#include "io/screen.h"
#include "io/tables.h"

namespace flexmorph::cases {
namespace {

using io::to_text;
using Table = std::vector<std::vector<std::string>>;

/// The colour and the meaning of a verdict.
struct Legend {
  StabilityVerdict verdict;
  const char *color, *meaning;
};
constexpr std::array<Legend, 4> kLegend = {{
    {StabilityVerdict::stable, "#7fc97f",
     "exit code 0, all numbers are finite, and the run gives no warning"},
    {StabilityVerdict::refused, "#a6cee3",
     "exit code 2 or 3, with a message that gives the reason"},
    {StabilityVerdict::degraded, "#fdc086", "the run gives a warning, or exceeds its time limit"},
    {StabilityVerdict::wrong, "#e31a1c",
     "a crash, a hang, a number that is not finite, or an end without a message"},
}};

const Legend& legend_of(StabilityVerdict verdict) {
  return *std::find_if(kLegend.begin(), kLegend.end(),
                       [&](const Legend& each) { return each.verdict == verdict; });
}

std::string count(std::span<const StabilityRow> rows, StabilityVerdict verdict,
                  const std::string& suite = "") {
  return std::to_string(std::count_if(rows.begin(), rows.end(), [&](const StabilityRow& row) {
    return row.assessment.verdict == verdict && (suite.empty() || row.suite == suite);
  }));
}

std::string summary(std::span<const StabilityRow> rows) {
  std::string out = std::to_string(rows.size()) + " rows";
  for (const Legend& each : kLegend)
    out += (each.verdict == StabilityVerdict::stable ? ": " : ", ") + count(rows, each.verdict) +
           " " + to_string(each.verdict);
  return out;
}

/// Returns the table of all rows.
/// @param max_reason  largest number of characters of a reason
Table table_of(std::span<const StabilityRow> rows, size_t max_reason) {
  Table out = {{"case", "suite", "parameter", "verdict", "exit", "reason"}};
  out[0].insert(out[0].end(), kRunNumbers.begin(), kRunNumbers.end());
  out[0].emplace_back("seconds_cpu");
  for (const StabilityRow& row : rows) {
    std::vector<std::string>& line = out.emplace_back();
    line = {row.case_name,
            row.suite,
            row.parameter,
            to_string(row.assessment.verdict),
            to_text(row.exit_code),
            row.assessment.reason.size() > max_reason
                ? row.assessment.reason.substr(0, max_reason - 3) + "..."
                : row.assessment.reason};
    for (const std::optional<double>& value : row.assessment.numbers)
      line.push_back(value ? to_text(*value, 2) : "-");
    line.push_back(to_text(row.seconds_cpu, 2));
  }
  return out;
}

/// Returns the index of a value in a list, and appends the value if it is missing.
double index_in(std::vector<std::string>& list, const std::string& value) {
  const auto at = std::find(list.begin(), list.end(), value);
  const auto index = at - list.begin();
  if (at == list.end()) list.push_back(value);
  return static_cast<double>(index);
}

constexpr double kNameWidth = 370, kCellWidth = 46, kLineHeight = 18, kHeadHeight = 170;

std::string text_at(double x, double y, const std::string& words, const std::string& style = "") {
  return "<text x=\"" + to_text(x) + "\" y=\"" + to_text(y) + "\"" + style + ">" +
         io::xml_escaped(words) + "</text>\n";
}

std::string rectangle(double x, double y, double width, double height, const std::string& fill) {
  return "<rect x=\"" + to_text(x) + "\" y=\"" + to_text(y) + "\" width=\"" + to_text(width) +
         "\" height=\"" + to_text(height) + "\" fill=\"" + fill + "\"/>\n";
}

/// Returns the coloured cell of a run; its tool tip contains the reason of the verdict.
std::string cell_at(double x, double y, const StabilityRow& row) {
  const auto& [energy_error, position, velocity, newton, rejected, condition, area] =
      row.assessment.numbers;
  const std::string words = energy_error ? to_text(*energy_error, 1)
                            : newton     ? to_text(*newton, 2)
                                         : "exit " + to_text(row.exit_code);
  return "<g><title>" +
         io::xml_escaped(row.case_name + ", " + row.parameter + ": " +
                         to_string(row.assessment.verdict) + " " + row.assessment.reason) +
         "</title>" +
         rectangle(x, y, kCellWidth - 2, kLineHeight - 2, legend_of(row.assessment.verdict).color) +
         text_at(x + 0.5 * kCellWidth - 1, y + 12, words,
                 " font-size=\"9\" text-anchor=\"middle\"") +
         "</g>\n";
}

}  // namespace

void write_stability_csv(std::span<const StabilityRow> rows, const std::string& path) {
  std::vector<std::string> columns = {"case", "suite", "parameter", "verdict", "exit_code"};
  columns.insert(columns.end(), kRunNumbers.begin(), kRunNumbers.end());
  columns.insert(columns.end(), {"seconds_cpu", "reason"});
  io::CsvWriter csv(path, columns);
  for (const StabilityRow& row : rows) {
    std::vector<io::Cell> cells = {row.case_name, row.suite, row.parameter,
                                   to_string(row.assessment.verdict), row.exit_code};
    for (const std::optional<double>& value : row.assessment.numbers)
      cells.push_back(value ? io::Cell(*value) : io::Cell());
    cells.emplace_back(row.seconds_cpu);
    cells.emplace_back(row.assessment.reason);
    csv.row(cells);
  }
}

std::string stability_markdown(std::span<const StabilityRow> rows) {
  std::string out = "# Stability\n\n" + summary(rows) + ".\n\n";
  for (const Legend& each : kLegend)
    out += "- " + to_string(each.verdict) + ": " + each.meaning + "\n";
  Table counts = {{"suite"}};
  for (const Legend& each : kLegend) counts[0].push_back(to_string(each.verdict));
  std::vector<std::string> suites;
  for (const StabilityRow& row : rows) index_in(suites, row.suite);
  for (const std::string& name : suites) {
    counts.push_back({name});
    for (const Legend& each : kLegend) counts.back().push_back(count(rows, each.verdict, name));
  }
  return out + "\n" + io::markdown_table(counts) + "\n" + io::markdown_table(table_of(rows, 400));
}

std::string stability_text(std::span<const StabilityRow> rows, bool all) {
  std::string out =
      all ? io::fitted_table(table_of(rows, 120), io::screen_width(), "stability.md") + "\n" : "";
  for (const StabilityRow& row : rows)
    if (!all && row.assessment.verdict == StabilityVerdict::wrong)
      out += "WRONG: " + row.case_name + ", " + row.suite + ", " + row.parameter + ": " +
             row.assessment.reason + "\n";
  return out + summary(rows) + "\n";
}

std::string stability_svg(std::span<const StabilityRow> rows) {
  std::vector<std::string> cases, lines;
  for (const StabilityRow& row : rows) index_in(cases, row.case_name);
  const auto x_of = [](double column) { return kNameWidth + column * kCellWidth; };
  const auto y_of = [](double line) { return kHeadHeight + line * kLineHeight; };
  std::string body, cells;
  for (const StabilityRow& row : rows) {
    const double line = index_in(lines, row.suite + ": " + row.parameter);
    cells += cell_at(x_of(index_in(cases, row.case_name)), y_of(line), row);
  }
  double x = 10;
  for (const Legend& each : kLegend) {
    body += rectangle(x, 14, 14, 14, each.color) +
            text_at(x + 20, 26, to_string(each.verdict) + " " + count(rows, each.verdict));
    x += 110;
  }
  body += text_at(
      10, 48, "cells: energy error / largest energy; if there is none, Newton iterations per step");
  for (size_t i = 0; i < cases.size(); ++i) {
    const std::string at =
        to_text(x_of(static_cast<double>(i) + 0.6)) + " " + to_text(kHeadHeight - 6);
    body += text_at(0, 0, cases[i], " transform=\"translate(" + at + ") rotate(-50)\"");
  }
  const double right = std::max(600.0, x_of(static_cast<double>(cases.size())) + 120);
  for (size_t i = 0; i < lines.size(); ++i) {
    const double y = y_of(static_cast<double>(i));
    if (i % 2 == 0) body += rectangle(0, y - 1, right, kLineHeight, "#f2f2f2");
    body += text_at(kNameWidth - 8, y + 12, lines[i], " text-anchor=\"end\"");
  }
  const double bottom = y_of(static_cast<double>(lines.size()) + 1);
  const std::string size = to_text(right) + "\" height=\"" + to_text(bottom);
  return "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"" + size +
         "\" font-family=\"sans-serif\" font-size=\"11\">\n" +
         rectangle(0, 0, right, bottom, "white") + body + cells + "</svg>\n";
}

}  // namespace flexmorph::cases
