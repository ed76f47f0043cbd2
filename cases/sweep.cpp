#include "cases/sweep.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <sstream>

#include "cases/run.h"
#include "cases/scene.h"
#include "io/plots.h"
#include "io/sheet.h"
#include "io/tables.h"

namespace flexmorph::cases {
namespace {

constexpr size_t kMostVariants = 10'000;

std::string last_part(const std::string& key) { return key.substr(key.rfind('.') + 1); }

/// A value as part of a folder's name.
std::string plain(const std::string& value) {
  std::string out;
  for (const char c : value) {
    const bool kept = std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '.' || c == '-' ||
                      c == '+' || c == '_';
    out += kept ? c : '_';
  }
  return out;
}

std::vector<std::string> texts(const VariantResult& run) {
  std::vector<std::string> row = {run.name, run.status};
  if (run.bodies.empty()) {
    row.push_back(run.message);
    return row;
  }
  const BodyResult& b = run.bodies.front();
  row.insert(
      row.end(),
      {io::to_text(b.compliance, 5), io::to_text(b.volume, 5), io::to_text(b.sharp_compliance, 5),
       io::to_text(b.sharp_volume, 5), io::to_text(b.sharp_compliance / b.uniform_compliance, 4),
       b.connected ? "yes" : "no", b.min_feature ? io::to_text(*b.min_feature, 4) : "-",
       io::to_text(b.components), io::to_text(b.peaks), io::to_text(b.iterations),
       io::to_text(b.solves), io::to_text(run.seconds_cpu, 3)});
  return row;
}

std::vector<std::vector<std::string>> table_of(std::span<const VariantResult> runs) {
  std::vector<std::vector<std::string>> rows = {
      {"variant", "status", "compliance", "volume", "sharp compliance", "sharp volume",
       "sharp/uniform", "connected", "smallest feature", "components", "peaks", "iterations",
       "solves", "CPU s"}};
  for (const VariantResult& run : runs) rows.push_back(texts(run));
  for (auto& row : rows) row.resize(rows.front().size());
  return rows;
}

void write_csv(std::span<const VariantResult> runs, std::span<const Variant> variants,
               const std::vector<Varied>& varied, const std::string& path) {
  std::vector<std::string> columns = {"variant"};
  for (const Varied& v : varied) columns.push_back(v.key);
  for (const char* name : {"status", "body", "compliance", "volume", "sharp_compliance",
                           "sharp_volume", "uniform_compliance", "kkt", "connected", "min_feature",
                           "components", "peaks", "iterations", "state_solves", "seconds_cpu"})
    columns.emplace_back(name);
  io::CsvWriter csv(path, columns);
  for (size_t k = 0; k < runs.size(); ++k) {
    std::vector<io::Cell> head = {runs[k].name};
    for (size_t v = 0; v < varied.size(); ++v)
      head.emplace_back(variants[k].overrides[v].substr(varied[v].key.size() + 1));
    head.emplace_back(runs[k].status);
    for (const BodyResult& b : runs[k].bodies) {
      std::vector<io::Cell> row = head;
      io::Cell feature;
      if (b.min_feature) feature = *b.min_feature;
      for (const io::Cell& cell : std::initializer_list<io::Cell>{
               b.body, b.compliance, b.volume, b.sharp_compliance, b.sharp_volume,
               b.uniform_compliance, b.kkt, b.connected, feature, b.components, b.peaks,
               b.iterations, b.solves, runs[k].seconds_cpu})
        row.push_back(cell);
      csv.row(row);
    }
    if (!runs[k].bodies.empty()) continue;
    head.resize(columns.size());
    csv.row(head);
  }
}

std::string contents_of(const std::string& path) {
  std::ifstream file(path);
  std::ostringstream out;
  out << file.rdbuf();
  return out.str();
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
  panel.curves.push_back({"sharp", b.sharp_iteration, b.sharp_history, false, true});
  figure.panels = {panel};
  return io::plot_svg(figure);
}

/// Designs above their histories, all histories on the same axis: P Figs. 15-22 on one page.
std::string sheet_of(const std::string& title, std::span<const VariantResult> runs) {
  double lowest = INFINITY, highest = 0;
  for (const VariantResult& run : runs)
    for (const BodyResult& b : run.bodies)
      for (const double c : b.history_compliance) {
        lowest = std::min(lowest, c);
        highest = std::max(highest, c);
      }
  std::vector<io::SheetEntry> entries;
  for (const VariantResult& run : runs) {
    io::SheetEntry entry{run.name, {}};
    if (!run.done()) entry.title += " (" + run.status + ")";
    for (const BodyResult& b : run.bodies) {
      const std::string stem = run.bodies.size() > 1 ? "/design_" + b.body : "/design";
      const std::string design = contents_of(run.directory + stem + ".svg");
      if (!design.empty()) entry.pictures.push_back(design);
      entry.pictures.push_back(history_picture(b, 0.9 * lowest, std::min(highest, 30 * lowest)));
    }
    entries.push_back(std::move(entry));
  }
  return io::contact_sheet(title, entries, runs.size() > 4 && runs.size() % 3 == 0 ? 3 : 4);
}

void write_all(const StudyOptions& study, const std::vector<Varied>& varied,
               std::span<const Variant> variants, std::span<const VariantResult> runs) {
  const std::string stem = study.directory + "/sweep";
  write_csv(runs, variants, varied, stem + ".csv");
  io::write_file(stem + ".md",
                 "# " + study.case_name + "\n\n" + io::markdown_table(table_of(runs)));
  io::write_file(stem + ".svg", sheet_of(study.case_name, runs));
}

}  // namespace

Varied read_varied(const std::string& text) {
  const size_t equal = text.find('=');
  const auto fail = [&](const std::string& what) {
    throw Error::input("--vary " + text + ": " + what + "; KEY=V1,V2,... is wanted");
  };
  if (equal == std::string::npos || equal == 0) fail("there is no key");
  Varied out{text.substr(0, equal), {""}};
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
  for (const std::string& value : out.values)
    if (value.empty()) fail("a value is empty");
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
  std::vector<Varied> varied;
  for (const std::string& text : options.vary) varied.push_back(read_varied(text));
  const std::vector<Variant> variants = combinations(varied);
  StudyOptions study = options.study;
  const int count = static_cast<int>(variants.size());
  if (options.index < 0 || options.index > count)
    throw Error::input("sweep: --index " + std::to_string(options.index) + ": 1 to " +
                       std::to_string(count));
  if (options.list) {
    for (int k = 0; k < count; ++k)
      std::printf("%d %s\n", k + 1, variants[static_cast<size_t>(k)].name.c_str());
    return 0;
  }
  if (study.directory.empty())
    study.directory =
        "runs/sweep_" + read_scene(io::CaseFile(find_case(study.case_name), study.overrides)).name;
  if (options.index > 0) {
    const Variant& one = variants[static_cast<size_t>(options.index - 1)];
    check_variants(study, {&one, 1});
    return run_variant(study, one);
  }
  check_variants(study, variants);
  const int code = run_variants(study, variants, [&](std::span<const VariantResult> runs) {
    write_all(study, varied, variants, runs);
  });
  std::fputs(io::aligned_table(table_of(read_results(study, variants))).c_str(), stdout);
  std::printf("%s/sweep.md, .csv, .svg\n", study.directory.c_str());
  return code;
}

}  // namespace flexmorph::cases
