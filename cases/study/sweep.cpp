#include "cases/study/sweep.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <numeric>
#include <optional>
#include <tuple>

#include "cases/check/ready.h"
#include "cases/run/run.h"
#include "cases/scene/scene.h"
#include "cases/study/rows.h"
#include "cases/study/study_page.h"
#include "cases/study/sweep_motion.h"
#include "cases/study/sweep_plan.h"
#include "io/plots.h"
#include "io/tables.h"

namespace flexmorph::cases {
namespace {

constexpr size_t kMaxVariants = 10'000;

std::string trimmed(const std::string& text) {
  const size_t first = text.find_first_not_of(" \t"), last = text.find_last_not_of(" \t");
  return first == std::string::npos ? "" : text.substr(first, last - first + 1);
}

/// Returns a value as text for the name of a folder, without the brackets of lists and the quotes
/// of strings.
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

std::vector<Motions> motions_of(const Sweep& sweep, std::span<const VariantResult> runs) {
  std::vector<Motions> out;
  for (size_t k = 0; k < runs.size(); ++k)
    out.push_back(read_motions(runs[k].directory, sweep.title_of(k)));
  set_units(out, runs);
  return out;
}

/// Returns the table of designs or motions for the terminal.
std::vector<std::vector<std::string>> summary_of(const Sweep& sweep,
                                                 std::span<const VariantResult> runs) {
  return sweep.table.goals.empty() ? motion_table(motions_of(sweep, runs), runs)
                                   : result_rows(sweep.table, runs);
}

std::optional<double> number_of(const std::string& text) {
  double value = 0;
  const char *first = text.data() + text.starts_with('+'), *last = text.data() + text.size();
  const auto [end, error] = std::from_chars(first, last, value);
  const bool whole = error == std::errc() && end == last;
  return whole && std::isfinite(value) ? std::optional(value) : std::nullopt;
}

/// Returns a figure of the values at the end of the runs against the numbers of the last key;
/// without panels if this key has less than three values, or values that are not numbers.
io::Figure ends_figure(const Sweep& sweep, std::span<const Motions> motions) {
  const size_t last = sweep.varied.size() - 1;
  if (sweep.varied[last].values.size() < 3) return {};
  std::vector<double> numbers;
  std::vector<std::string> curves;
  for (size_t k = 0; k < motions.size(); ++k) {
    const std::optional<double> number = number_of(sweep.value(k, last));
    if (!number) return {};
    numbers.push_back(*number);
    curves.push_back(sweep.title_of(k, last));
  }
  return final_figure(sweep.case_name, sweep.varied[last].key, motions, numbers, curves);
}

void write_motions(const Sweep& sweep, std::span<const VariantResult> runs,
                   const std::string& stem) {
  const std::vector<Motions> motions = motions_of(sweep, runs);
  const std::vector<std::vector<std::string>> rows = motion_table(motions, runs);
  io::CsvWriter csv(stem + ".csv", rows[0]);
  for (size_t r = 1; r < rows.size(); ++r)
    csv.row(std::vector<io::Cell>(rows[r].begin(), rows[r].end()));
  io::write_file(stem + ".md",
                 "# " + sweep.case_name + "\n\n" + io::markdown_table(rows) + rows_note(runs));
  const io::Figure figure = motion_figure(sweep.case_name, motions, sweep.reference),
                   ends = ends_figure(sweep, motions);
  io::write_file(stem + ".svg", io::plot_svg(figure));
  if (!ends.panels.empty()) io::write_file(stem + "_ends.svg", io::plot_svg(ends));
  StudyPage page;
  page.title = sweep.case_name + ": sweep";
  page.summary = rows;
  page.rows = {{"variant", "status"}};
  for (const VariantResult& run : runs) page.rows.push_back({run.name, run.words()});
  page.notes = {rows_note(runs)};
  page.plots = {{"motions", figure}, {"ends", ends}};
  write_study_page(page, runs, stem + ".html");
}

void write_all(const Sweep& sweep, std::span<const VariantResult> runs,
               const std::string& directory) {
  const std::string stem = directory + "/sweep";
  if (sweep.table.goals.empty())
    write_motions(sweep, runs, stem);
  else
    write_designs(sweep, runs, stem);
}

/// Returns the goals of the designs of all variants.
/// @throws Error (input) if the variants have different numbers of designs.
std::vector<mmc::Goal> goals_of(const StudyOptions& study, std::span<const Variant> variants) {
  std::vector<mmc::Goal> out;
  std::optional<size_t> n_designs;
  for (const Variant& v : variants) {
    const Scene scene = read_scene(case_of(study, v));
    for (const BodyDesign& d : scene.designs) out.push_back(d.goal);
    if (scene.designs.size() != n_designs.value_or(scene.designs.size()))
      throw Error::input(
          "sweep: the variants have different numbers of [[design]]; all variants need "
          "an equal number, or none");
    n_designs = scene.designs.size();
  }
  return out;
}

}  // namespace

Varied read_varied(const std::string& text) {
  const size_t equal = text.find('=');
  const auto fail = [&](const std::string& what) {
    throw Error::input("--vary " + text + ": " + what + "; the form is KEY=V1,V2,...");
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
  if (depth != 0 || quote != 0) fail("a bracket or a quote is not closed");
  for (std::string& value : out.values) {
    value = trimmed(value);
    if (value.empty()) fail("a value is empty");
  }
  return out;
}

std::vector<Variant> combinations(const std::vector<Varied>& varied) {
  if (varied.empty()) throw Error::input("sweep: at least one --vary KEY=V1,V2,... is required");
  size_t count = 1;
  for (size_t i = 0; i < varied.size(); ++i) {
    count *= varied[i].values.size();
    for (size_t j = 0; j < i; ++j)
      if (varied[j].key == varied[i].key)
        throw Error::input("sweep: --vary " + varied[i].key + " appears more than once");
    if (count > kMaxVariants)
      throw Error::input("sweep: the number of variants is at most " +
                         std::to_string(kMaxVariants));
  }
  // The names and the overrides of rows do not depend on the order of the keys, so that a study can
  // be called with another order.
  std::vector<size_t> strides(varied.size(), 1), order(varied.size());
  for (size_t i = varied.size(); i-- > 1;) strides[i - 1] = strides[i] * varied[i].values.size();
  std::iota(order.begin(), order.end(), 0);
  const auto rank = [&](size_t i) {
    const std::string& key = varied[i].key;
    return std::tuple(key != "case", last_part(key), key);
  };
  std::sort(order.begin(), order.end(), [&](size_t a, size_t b) { return rank(a) < rank(b); });
  std::vector<Variant> out;
  for (size_t k = 0; k < count; ++k) {
    Variant v;
    for (const size_t i : order) {
      const std::string& value = varied[i].values[k / strides[i] % varied[i].values.size()];
      if (varied[i].key == "case")
        v.case_name = value;
      else
        v.overrides.push_back(varied[i].key + "=" + value);
      if (!v.name.empty()) v.name += ",";
      v.name.append(last_part(varied[i].key)).append("=").append(plain(value));
    }
    for (const Variant& other : out)
      if (other.name == v.name) throw Error::input("sweep: two variants have the name " + v.name);
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
  if (study.directory.empty())
    study.directory =
        "runs/sweep_" + std::filesystem::path(find_case(study.case_name)).stem().string();
  if (study.dispatch.prints()) {
    check_variants(study, sweep.variants);
    return run_variants(study, sweep.variants, {}).exit_code;
  }
  if (!study.dispatch.collect) check_variants(study, sweep.variants);
  sweep.table.goals = goals_of(study, sweep.variants);
  sweep.table.names = {"variant"};
  for (const Varied& v : sweep.varied) sweep.table.names.push_back(v.key);
  for (size_t k = 0; k < sweep.variants.size(); ++k) {
    std::vector<std::string>& values = sweep.table.values.emplace_back();
    values.push_back(sweep.variants[k].name);
    for (size_t v = 0; v < sweep.varied.size(); ++v) values.push_back(sweep.value(k, v));
  }
  if (!options.reference.empty() && !sweep.table.goals.empty())
    throw Error::input("sweep: --reference is only for cases without a [[design]]");
  sweep.reference = read_reference(options.reference);
  const StudyOutcome outcome = run_variants(
      study, sweep.variants,
      [&](std::span<const VariantResult> runs) { write_all(sweep, runs, study.directory); });
  print_table(summary_of(sweep, outcome.results), "sweep.md");
  print_text(warnings_note(outcome.results));
  print_text(convergence_note(outcome.results));
  print_text(rows_note(outcome.results));
  print_text(study.directory + ": sweep.html, sweep.md, sweep.csv, sweep.svg, rows.csv\n");
  return outcome.exit_code;
}

}  // namespace flexmorph::cases
