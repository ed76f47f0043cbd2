#include "cases/study.h"

#include <fcntl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <csignal>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <sstream>

#include "cases/run.h"
#include "cases/statistics.h"
#include "io/files.h"
#include "io/tables.h"

namespace flexmorph::cases {
namespace {

namespace fs = std::filesystem;

volatile std::sig_atomic_t interrupted = 0;

std::string contents_of(const std::string& path) {
  std::ifstream file(path);
  std::ostringstream out;
  out << file.rdbuf();
  return out.str();
}

std::string folder_of(const StudyOptions& options, const Variant& variant) {
  return options.directory + "/" + variant.name;
}

std::vector<std::string> overrides_of(const StudyOptions& options, const Variant& variant) {
  std::vector<std::string> all = options.overrides;
  all.insert(all.end(), variant.overrides.begin(), variant.overrides.end());
  return all;
}

io::CaseFile case_of(const StudyOptions& options, const Variant& variant) {
  return io::CaseFile(find_case(options.case_name), overrides_of(options, variant));
}

bool finished(const StudyOptions& options, const Variant& variant, const VariantResult& result) {
  return result.done() && contents_of(folder_of(options, variant) + "/case.toml") ==
                              case_of(options, variant).text();
}

/// Starts this very program with a run of the variant; its words go to a log beside its folder.
pid_t start(const StudyOptions& options, const Variant& variant) {
  const std::string folder = folder_of(options, variant), log = folder + ".log";
  std::vector<std::string> words = {
      "flexmorph", "run",     options.case_name, "-o",
      folder,      "--quiet", "--threads",       io::to_text(options.threads)};
  for (const std::string& change : overrides_of(options, variant)) {
    words.emplace_back("--set");
    words.push_back(change);
  }
  std::vector<char*> argv;
  for (std::string& word : words) argv.push_back(word.data());
  argv.push_back(nullptr);
  const int out = open(log.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0644);
  if (out < 0) throw Error::input("study: '" + log + "' cannot be written");
  const pid_t child = fork();
  if (child < 0) throw Error::numerical("study: a process cannot be started");
  if (child == 0) {
    dup2(out, STDOUT_FILENO);
    dup2(out, STDERR_FILENO);
    execv("/proc/self/exe", argv.data());
    _exit(127);
  }
  close(out);
  return child;
}

int exit_code(int status) { return WIFEXITED(status) ? WEXITSTATUS(status) : 3; }

double number(const nlohmann::json& object, const char* key) {
  return object.contains(key) && object[key].is_number() ? object[key].get<double>() : std::nan("");
}

BodyResult read_body(const nlohmann::json& r) {
  BodyResult out;
  out.body = r.value("body", "");
  out.stop = r.value("stop", "");
  out.compliance = number(r, "compliance");
  out.volume = number(r, "volume");
  out.sharp_compliance = number(r, "sharp_compliance");
  out.sharp_volume = number(r, "sharp_volume");
  out.uniform_compliance = number(r, "uniform_compliance");
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

void read_history(const std::string& path, std::vector<BodyResult>& bodies) {
  const io::CsvTable table = io::read_csv(path);
  const std::vector<std::string> body = table.texts("body");
  const auto column = [&](const char* name) { return table.numbers(name); };
  const std::vector<double> solves = column("evaluations"), compliance = column("compliance"),
                            violation = column("violation"), band = column("band"),
                            sharp = column("sharp_compliance"), connected = column("connected");
  std::vector<double> seconds(body.size(), 0);
  for (const std::string& name : table.columns) {
    if (!name.starts_with("seconds_") || name == "seconds_output") continue;
    const std::vector<double> part = column(name.c_str());
    for (size_t i = 0; i < part.size(); ++i) seconds[i] += part[i];
  }
  for (BodyResult& b : bodies) {
    for (size_t i = 0; i < body.size(); ++i) {
      if (body[i] != b.body) continue;
      b.history_solves.push_back(solves[i]);
      b.history_compliance.push_back(compliance[i]);
      b.history_violation.push_back(violation[i]);
      b.history_band.push_back(band[i]);
      const double before = b.history_seconds.empty() ? 0 : b.history_seconds.back();
      b.history_seconds.push_back(before + seconds[i]);
      if (connected[i] == 0) ++b.disconnected;
      if (!std::isfinite(sharp[i])) continue;
      b.sharp_iteration.push_back(static_cast<double>(b.history_solves.size()));
      b.sharp_history.push_back(sharp[i]);
    }
    b.peaks = peaks(b.history_compliance, b.history_band);
    if (!b.history_violation.empty()) b.violation = b.history_violation.back();
  }
}

VariantResult read_result(const StudyOptions& options, const Variant& variant) {
  VariantResult out;
  out.name = variant.name;
  out.directory = folder_of(options, variant);
  const std::string text = contents_of(out.directory + "/run.json");
  if (text.empty()) return out;
  const nlohmann::json run = nlohmann::json::parse(text, nullptr, false);
  if (run.is_discarded()) return out;
  out.status = run.value("status", "missing");
  out.message = run.value("message", "");
  out.seconds_cpu = number(run, "seconds_cpu");
  out.seconds_wall = number(run, "seconds_wall");
  for (const nlohmann::json& r : run.value("results", nlohmann::json::array()))
    out.bodies.push_back(read_body(r));
  if (!out.bodies.empty()) read_history(out.directory + "/history.csv", out.bodies);
  return out;
}

/// Keeps `jobs` processes busy; the first signal goes on to all of them.
class Jobs {
 public:
  Jobs(const StudyOptions& options, std::span<const Variant> variants)
      : options_(options), variants_(variants) {}

  void add(size_t variant) {
    say(variants_[variant].name + ": started");
    running_[start(options_, variants_[variant])] = variant;
  }
  size_t n_running() const { return running_.size(); }

  /// Waits for one. @return variant and exit code.
  std::pair<size_t, int> wait_for_one() {
    while (true) {
      int status = 0;
      const pid_t child = waitpid(-1, &status, 0);
      if (child < 0 && errno == EINTR) {
        for (const auto& [pid, variant] : running_) kill(pid, SIGINT);
        continue;
      }
      const auto found = running_.find(child);
      if (found == running_.end()) continue;
      const size_t variant = found->second;
      running_.erase(found);
      return {variant, exit_code(status)};
    }
  }
  void say(const std::string& line) const {
    if (options_.quiet) return;
    std::printf("%s\n", line.c_str());
    std::fflush(stdout);
  }

 private:
  const StudyOptions& options_;
  std::span<const Variant> variants_;
  std::map<pid_t, size_t> running_;
};

void watch_signals() {
  struct sigaction action {};
  action.sa_handler = [](int) { interrupted = 1; };  // no SA_RESTART: waiting ends
  sigaction(SIGINT, &action, nullptr);
  sigaction(SIGTERM, &action, nullptr);
}

/// The last line a run wrote: what it died of.
std::string last_words(const std::string& log) {
  std::istringstream in(contents_of(log));
  std::string last;
  for (std::string line; std::getline(in, line);)
    if (!line.empty()) last = line;
  return last;
}

}  // namespace

void check_variants(const StudyOptions& options, std::span<const Variant> variants) {
  for (const Variant& v : variants) build_scene(read_scene(case_of(options, v)));
}

std::vector<VariantResult> read_results(const StudyOptions& options,
                                        std::span<const Variant> variants) {
  std::vector<VariantResult> out;
  for (const Variant& v : variants) out.push_back(read_result(options, v));
  return out;
}

int run_variant(const StudyOptions& options, const Variant& variant) {
  if (finished(options, variant, read_result(options, variant))) return 0;
  fs::create_directories(options.directory);
  watch_signals();
  Jobs jobs(options, {&variant, 1});
  jobs.add(0);
  const int code = jobs.wait_for_one().second;
  if (code != 0 && code != 4)
    std::fprintf(stderr, "%s\n", last_words(folder_of(options, variant) + ".log").c_str());
  return code;
}

int run_variants(const StudyOptions& options, std::span<const Variant> variants,
                 const std::function<void(std::span<const VariantResult>)>& changed) {
  fs::create_directories(options.directory);
  watch_signals();
  std::vector<VariantResult> results = read_results(options, variants);
  Jobs jobs(options, variants);
  bool failed = false;
  const auto collect = [&] {
    const auto [i, code] = jobs.wait_for_one();
    results[i] = read_result(options, variants[i]);
    if (code != 0 && results[i].done()) results[i].status = "failed";
    if (code != 0 && code != 4) {
      failed = true;
      if (results[i].message.empty())
        results[i].message = last_words(folder_of(options, variants[i]) + ".log");
    }
    jobs.say(variants[i].name + ": " + results[i].status +
             (results[i].message.empty() ? "" : ", " + results[i].message));
    changed(results);
  };
  for (size_t i = 0; i < variants.size() && !interrupted; ++i) {
    if (finished(options, variants[i], results[i])) {
      jobs.say(variants[i].name + ": finished before");
      continue;
    }
    results[i].status = "missing";
    while (jobs.n_running() >= static_cast<size_t>(options.jobs)) collect();
    if (!interrupted) jobs.add(i);
  }
  while (jobs.n_running() > 0) collect();
  changed(results);
  return interrupted ? 4 : failed ? 3 : 0;
}

}  // namespace flexmorph::cases
