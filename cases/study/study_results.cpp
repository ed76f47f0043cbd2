#include <algorithm>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <sstream>

#include "cases/results/warnings.h"
#include "cases/run/run.h"
#include "cases/study/statistics.h"
#include "cases/study/study.h"
#include "io/output_folder.h"
#include "io/screen.h"
#include "io/tables.h"
#include "optim/optimizer.h"

namespace flexmorph::cases {
namespace {

double number(const nlohmann::json& object, const char* key) {
  return object.contains(key) && object[key].is_number() ? object[key].get<double>() : std::nan("");
}

BodyResult read_body(const nlohmann::json& r) {
  BodyResult out;
  out.body = r.value("body", "");
  out.stop = r.value("stop", "");
  out.verdict = r.value("verdict", "");
  out.compliance = number(r, "compliance");
  out.volume = number(r, "volume");
  out.crisp_compliance = number(r, "crisp_compliance");
  out.crisp_volume = number(r, "crisp_volume");
  out.uniform_compliance = number(r, "uniform_compliance");
  const nlohmann::json verified = r.value("body_fitted", nlohmann::json::object());
  out.body_fitted = number(verified, "compliance");
  if (verified.contains("compliance") && verified["compliance"] == "infinite")
    out.body_fitted = INFINITY;
  out.body_fitted_error = number(verified, "error");
  out.body_fitted_volume = number(verified, "volume");
  for (const mmc::ResponseRow* row : mmc::responses())
    for (const std::string& key : {mmc::key_of(*row), "crisp_" + mmc::key_of(*row)})
      if (r.contains(key)) out.further[key] = number(r, key.c_str());
  out.kkt = number(r, "kkt");
  out.connected = r.value("connected", false);
  if (r.contains("min_feature") && r["min_feature"].is_number())
    out.min_feature = r["min_feature"].get<double>();
  out.iterations = r.value("iterations", 0);
  out.solves = r.value("state_solves", 0);
  out.factorizations = r.value("factorizations", 0);
  out.components = r.value("components", 0);
  return out;
}

/// Returns the CPU time of every row of the history, which is the time of all evaluations since the
/// previous row [s].
std::vector<double> row_seconds(const io::CsvTable& table) {
  std::vector<double> seconds(table.n_rows(), 0);
  for (const std::string& name : table.columns) {
    if (!name.starts_with("seconds_")) continue;
    const std::vector<double> part = table.numbers(name);
    for (size_t i = 0; i < part.size(); ++i)
      if (std::isfinite(part[i])) seconds[i] += part[i];
  }
  return seconds;
}

/// Returns the number of evaluations of every row since the previous row of the same body and
/// cycle.
std::vector<int> row_evaluations(const io::CsvTable& table) {
  const std::vector<std::string> body = table.texts("body"), cycle = table.texts("cycle");
  const std::vector<double> total = table.numbers("evaluations");
  std::vector<int> out;
  std::map<std::string, double> before;
  for (size_t i = 0; i < total.size(); ++i) {
    double& last = before[body[i] + "," + cycle[i]];
    out.push_back(static_cast<int>(std::max(0.0, total[i] - last)));
    last = total[i];
  }
  return out;
}

void read_history(const std::string& path, std::vector<BodyResult>& bodies) {
  const io::CsvTable table = io::read_csv(path);
  const std::vector<std::string> body = table.texts("body"), cycle = table.texts("cycle"),
                                 band = table.texts("band");
  const std::vector<double> compliance = table.numbers("compliance"),
                            violation = table.numbers("violation"),
                            crisp = table.numbers("crisp_compliance"),
                            connected = table.numbers("connected"),
                            optimizer = table.numbers("seconds_optimizer");
  const std::vector<int> evaluations = row_evaluations(table);
  const std::vector<double> seconds = row_seconds(table);
  for (BodyResult& b : bodies) {
    std::string stage;
    double solves = 0, clock = 0;
    for (size_t i = 0; i < body.size(); ++i) {
      if (body[i] != b.body) continue;
      const std::string own = cycle[i] + "," + band[i];
      const int location = b.history_stage.empty() ? 0 : b.history_stage.back() + (own != stage);
      stage = own;
      b.history_stage.push_back(location);
      b.history_solves.push_back(solves += evaluations[i]);
      b.history_seconds.push_back(clock += seconds[i]);
      b.history_compliance.push_back(compliance[i]);
      b.history_violation.push_back(violation[i]);
      if (std::isfinite(optimizer[i])) b.seconds_optimizer += optimizer[i];
      if (connected[i] == 0) ++b.disconnected;
      if (!std::isfinite(crisp[i])) continue;
      b.crisp_iteration.push_back(static_cast<double>(b.history_solves.size()));
      b.crisp_history.push_back(crisp[i]);
    }
    b.peaks = peaks(b.history_compliance, b.history_stage);
  }
}

void read_run(const std::string& text, VariantResult& out) {
  const nlohmann::json run = nlohmann::json::parse(text, nullptr, false);
  if (!run.is_object())
    throw Error::input(out.directory + "/run.json: this file is not the result of a run");
  out.status = run.value("status", "missing");
  out.message = run.value("message", "");
  out.origin = {run.value("version", ""), run.value("commit", ""), run.value("processor", ""),
                run.value("blas_kernel", "")};
  if (const std::string vectors = run.value("vectors", ""); !vectors.empty())
    out.origin.kernels += " " + vectors;
  for (const nlohmann::json& each : run.value("warnings", nlohmann::json::array()))
    if (each.is_string()) out.warnings.push_back(each);
  out.seconds_cpu = number(run, "seconds_cpu");
  out.seconds_wall = number(run, "seconds_wall");
  out.peak_memory_bytes = number(run, "peak_memory_bytes");
  const nlohmann::json failure = run.value("failure", nlohmann::json::object());
  const std::string kind = failure.value("kind", "");
  out.ending.code = out.done() ? (out.status == "done" ? 0 : kExpectationsMissed)
                               : (kind == "defect"  ? 1
                                  : kind == "input" ? 2
                                                    : 3);
  out.ending.over_time = kind == "limit";
  out.seconds_limit = number(failure, "seconds_limit");
  for (const nlohmann::json& r : run.value("results", nlohmann::json::array()))
    out.bodies.push_back(read_body(r));
  if (!out.bodies.empty()) read_history(out.directory + "/history.csv", out.bodies);
}

}  // namespace

std::string folder_of(const StudyOptions& options, const Variant& variant) {
  return options.directory + "/" + variant.name;
}

bool BodyResult::unfinished() const {
  return verdict == optim::to_string(optim::Verdict::Kind::unfinished);
}

bool VariantResult::unfinished() const {
  return std::any_of(bodies.begin(), bodies.end(),
                     [](const BodyResult& body) { return body.unfinished(); });
}

std::string VariantResult::verdicts() const {
  std::string out;
  for (const BodyResult& body : bodies)
    if (out.empty() || out.find(body.verdict) == std::string::npos)
      out += (out.empty() ? "" : ", ") + body.verdict;
  return out;
}

std::string convergence_note(std::span<const VariantResult> runs) {
  const auto missed = std::count_if(runs.begin(), runs.end(), [](const VariantResult& run) {
    return run.done() && run.unfinished();
  });
  if (missed == 0) return "";
  return "\n" + std::to_string(missed) + " of " + std::to_string(runs.size()) +
         " runs are unfinished (see \"verdict\"): their designs still improved or violated a "
         "limit.\n";
}

std::string warnings_note(std::span<const VariantResult> runs) {
  std::string out;
  size_t n = 0;
  for (const VariantResult& run : runs)
    for (const std::string& warning : run.warnings)
      if (++n <= kMaxWarnings) out += run.name + ": " + warning + "\n";
  if (n > kMaxWarnings)
    out +=
        std::to_string(n - kMaxWarnings) + " more warnings: run.json in the folders of the runs\n";
  return out.empty() ? out : "\nwarnings\n" + out;
}

void print_text(const std::string& text) {
  std::fputs(io::fitted_text(text, io::screen_width()).c_str(), stdout);
  std::fflush(stdout);
}

void print_table(std::span<const std::vector<std::string>> rows, const std::string& file) {
  print_text(io::fitted_table(rows, io::screen_width(), file));
}

std::string VariantResult::words() const {
  const std::string found = verdicts();
  return status + (done() && !found.empty() ? ", " + found : "") +
         counted(warnings.size(), "warning", "warnings");
}

std::string text_of(const std::string& path) {
  std::ifstream file(path);
  std::ostringstream out;
  if (file) out << file.rdbuf();
  return out.str();
}

VariantResult read_result(const StudyOptions& options, const Variant& variant) {
  VariantResult out;
  out.name = variant.name;
  out.directory = folder_of(options, variant);
  const std::string text = text_of(out.directory + "/run.json");
  if (text.empty()) return out;
  try {
    read_run(text, out);
  } catch (const std::exception& error) {  // incomplete files, or files of another program
    out.status = "failed";
    out.message = error.what();
    out.bodies.clear();
  }
  // A killed process could not write its status.
  if (out.status == "running" && !io::is_being_filled(out.directory)) out.status = "killed";
  return out;
}

}  // namespace flexmorph::cases
