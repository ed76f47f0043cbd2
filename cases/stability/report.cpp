#include "cases/stability/report.h"

#include <algorithm>
#include <array>
#include <sstream>

#include "io/files.h"
#include "io/tables.h"

namespace flexmorph::cases {
namespace {

using io::to_text;

const std::array<Verdict, 4> kVerdicts = {Verdict::stable, Verdict::refused, Verdict::degraded,
                                          Verdict::wrong};

std::string figure(const std::optional<double>& value, int digits) {
  return value ? to_text(*value, digits) : "-";
}

io::Cell cell(const std::optional<double>& value) { return value ? io::Cell(*value) : io::Cell(); }

long count(std::span<const StabilityRow> rows, Verdict verdict) {
  return std::count_if(rows.begin(), rows.end(),
                       [&](const StabilityRow& row) { return row.judgement.verdict == verdict; });
}

std::string summary(std::span<const StabilityRow> rows) {
  std::string out = std::to_string(rows.size()) + " rows";
  for (const Verdict v : kVerdicts)
    out +=
        (v == Verdict::stable ? ": " : ", ") + std::to_string(count(rows, v)) + " " + to_string(v);
  return out;
}

std::string shortened(std::string text, size_t most) {
  if (text.size() > most) text = text.substr(0, most - 3) + "...";
  return text;
}

std::vector<std::vector<std::string>> table_of(std::span<const StabilityRow> rows, size_t most) {
  std::vector<std::vector<std::string>> out = {
      {"case", "suite", "parameter", "verdict", "exit", "energy defect", "|C| [m]", "|dC/dt| [m/s]",
       "Newton/step", "rejected", "condition", "CPU s", "why"}};
  for (const StabilityRow& row : rows) {
    const Figures& f = row.judgement.figures;
    out.push_back({row.case_name, row.suite, row.perturbation.parameter,
                   to_string(row.judgement.verdict), to_text(row.ending.code),
                   figure(f.energy_defect, 2), figure(f.position_drift, 2),
                   figure(f.velocity_drift, 2), figure(f.newton, 3), figure(f.rejected, 3),
                   figure(f.condition, 2), to_text(row.ending.seconds, 2),
                   shortened(row.judgement.reason, most)});
  }
  return out;
}

template <class T>
size_t place_in(std::vector<T>& list, const T& value) {
  const auto at = std::find(list.begin(), list.end(), value);
  if (at == list.end()) list.push_back(value);
  return static_cast<size_t>(std::find(list.begin(), list.end(), value) - list.begin());
}

const char* colour_of(Verdict verdict) {
  switch (verdict) {
    case Verdict::stable:
      return "#7fc97f";
    case Verdict::refused:
      return "#a6cee3";
    case Verdict::degraded:
      return "#fdc086";
    case Verdict::wrong:
      break;
  }
  return "#e31a1c";
}

constexpr double kNames = 370, kBand = 115, kCell = 46, kLine = 18, kHead = 170, kGap = 26;

std::string text_at(double x, double y, const std::string& words, const std::string& more = "") {
  return "<text x=\"" + to_text(x) + "\" y=\"" + to_text(y) + "\"" + more + ">" +
         io::xml_escaped(words) + "</text>\n";
}

std::string rectangle(double x, double y, double width, double height, const std::string& fill) {
  return "<rect x=\"" + to_text(x) + "\" y=\"" + to_text(y) + "\" width=\"" + to_text(width) +
         "\" height=\"" + to_text(height) + "\" fill=\"" + fill + "\"/>\n";
}

std::string box_at(double x, double y, const StabilityRow& row) {
  const Figures& f = row.judgement.figures;
  const std::string words = f.energy_defect       ? to_text(*f.energy_defect, 1)
                            : f.newton            ? to_text(*f.newton, 2)
                            : row.ending.code > 0 ? "exit " + to_text(row.ending.code)
                                                  : "";
  return "<g><title>" +
         io::xml_escaped(row.case_name + ", " + row.perturbation.parameter + ": " +
                         to_string(row.judgement.verdict) +
                         (row.judgement.reason.empty() ? "" : ": " + row.judgement.reason)) +
         "</title>" + rectangle(x, y, kCell - 2, kLine - 2, colour_of(row.judgement.verdict)) +
         text_at(x + 0.5 * kCell - 1, y + 12, words, " font-size=\"9\" text-anchor=\"middle\"") +
         "</g>\n";
}

/// Names of the cases over their columns.
std::string heads(const std::vector<std::string>& cases, double y) {
  std::string out;
  for (size_t i = 0; i < cases.size(); ++i) {
    const double x = kNames + (static_cast<double>(i) + 0.6) * kCell;
    out +=
        text_at(x, y, cases[i], " transform=\"rotate(-50 " + to_text(x) + " " + to_text(y) + ")\"");
  }
  return out;
}

/// One suite: parameters down, cases in their columns. @return where it ends.
double add_map(std::span<const StabilityRow> rows, const std::string& name,
               const std::vector<std::string>& cases, double top, std::string& out) {
  std::vector<std::string> parameters;
  std::string boxes;
  for (const StabilityRow& row : rows) {
    if (row.suite != name) continue;
    const auto column = std::find(cases.begin(), cases.end(), row.case_name) - cases.begin();
    const auto line = static_cast<double>(place_in(parameters, row.perturbation.parameter));
    boxes += box_at(kNames + static_cast<double>(column) * kCell, top + line * kLine, row);
  }
  const auto lines = static_cast<double>(parameters.size());
  out += text_at(10, top + 12, name, " font-size=\"14\" font-weight=\"bold\"");
  // Bands that lead the eye from a parameter to its boxes.
  for (size_t i = 0; i < parameters.size(); i += 2)
    out += rectangle(kBand, top + static_cast<double>(i) * kLine - 1,
                     kNames - kBand + static_cast<double>(cases.size()) * kCell, kLine, "#f2f2f2");
  for (size_t i = 0; i < parameters.size(); ++i)
    out += text_at(kNames - 8, top + static_cast<double>(i) * kLine + 12, parameters[i],
                   " text-anchor=\"end\"");
  out += boxes;
  return top + lines * kLine + kGap;
}

}  // namespace

void write_stability_csv(std::span<const StabilityRow> rows, const std::string& path) {
  const std::vector<std::string> columns = {"case",
                                            "suite",
                                            "parameter",
                                            "verdict",
                                            "exit_code",
                                            "signal",
                                            "energy_defect",
                                            "energy_growth",
                                            "position_drift",
                                            "velocity_drift",
                                            "newton_per_step",
                                            "rejected_steps",
                                            "condition",
                                            "smallest_area_ratio",
                                            "seconds_cpu",
                                            "reason"};
  io::CsvWriter csv(path, columns);
  for (const StabilityRow& row : rows) {
    const Figures& f = row.judgement.figures;
    csv.row({row.case_name, row.suite, row.perturbation.parameter, to_string(row.judgement.verdict),
             row.ending.code, row.ending.signal, cell(f.energy_defect), cell(f.energy_growth),
             cell(f.position_drift), cell(f.velocity_drift), cell(f.newton), cell(f.rejected),
             cell(f.condition), cell(f.area_ratio), row.ending.seconds, row.judgement.reason});
  }
}

std::string stability_markdown(std::span<const StabilityRow> rows) {
  std::ostringstream out;
  out << "# Stability\n\n" << summary(rows) << ".\n\n";
  out << "stable: every number of every file is finite, constraints hold to 1e-8 of the length of "
         "the scene, the balance of energy to (h omega)^2 of the largest energy (between 1e-6 and "
         "0.1; omega: the fastest of bending, turning, spin-up, warming and, where the start is no "
         "equilibrium, axial vibration), exact laws hold.\n\nrefused: exit 2 or 3, and the message "
         "says what and "
         "where.\n\ndegraded: a bound is missed, and why.\n\nWRONG: NaN, a crash, a hang, a broken "
         "law, a refusal without a cause.\n\n";
  std::vector<std::vector<std::string>> counts = {{"suite", "rows"}};
  for (const Verdict v : kVerdicts) counts[0].push_back(to_string(v));
  std::vector<std::string> names;
  for (const StabilityRow& row : rows) place_in(names, row.suite);
  for (const std::string& name : names) {
    std::vector<StabilityRow> own;
    for (const StabilityRow& row : rows)
      if (row.suite == name) own.push_back(row);
    std::vector<std::string> line = {name, std::to_string(own.size())};
    for (const Verdict v : kVerdicts) line.push_back(std::to_string(count(own, v)));
    counts.push_back(std::move(line));
  }
  out << io::markdown_table(counts) << "\n" << io::markdown_table(table_of(rows, 400));
  return out.str();
}

std::string stability_text(std::span<const StabilityRow> rows, bool all) {
  std::string out = all ? io::aligned_table(table_of(rows, 120)) + "\n" : "";
  for (const StabilityRow& row : rows)
    if (!all && row.judgement.verdict == Verdict::wrong)
      out += "WRONG: " + row.case_name + ", " + row.suite + ", " + row.perturbation.parameter +
             ": " + row.judgement.reason + "\n";
  return out + summary(rows) + "\n";
}

std::string stability_svg(std::span<const StabilityRow> rows) {
  std::vector<std::string> names, cases;
  for (const StabilityRow& row : rows) {
    place_in(names, row.suite);
    place_in(cases, row.case_name);
  }
  std::string body;
  double x = 10;
  for (const Verdict v : kVerdicts) {
    const std::string words = to_string(v) + " " + std::to_string(count(rows, v));
    body += rectangle(x, 14, 14, 14, colour_of(v)) + text_at(x + 20, 26, words);
    x += 110;
  }
  body += text_at(10, 48, "in the boxes: missed energy over the largest, else Newton iterations");
  body += heads(cases, kHead - 6);
  double top = kHead;
  for (const std::string& name : names) top = add_map(rows, name, cases, top, body);
  const double right = std::max(600.0, kNames + static_cast<double>(cases.size()) * kCell + 120);
  return "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"" + to_text(right) + "\" height=\"" +
         to_text(top) + "\" viewBox=\"0 0 " + to_text(right) + " " + to_text(top) +
         "\" font-family=\"sans-serif\" font-size=\"11\">\n" +
         rectangle(0, 0, right, top, "white") + body + "</svg>\n";
}

}  // namespace flexmorph::cases
