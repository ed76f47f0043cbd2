#include "cases/study/study.h"

#include <fcntl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <csignal>
#include <cstdio>
#include <filesystem>
#include <map>
#include <sstream>
#include <thread>

#include "cases/run/run.h"
#include "io/files.h"

namespace flexmorph::cases {
namespace {

namespace fs = std::filesystem;

volatile std::sig_atomic_t interrupted = 0;

std::vector<std::string> overrides_of(const StudyOptions& options, const Variant& variant) {
  std::vector<std::string> all = options.overrides;
  all.insert(all.end(), variant.overrides.begin(), variant.overrides.end());
  return all;
}

bool finished(const StudyOptions& options, const Variant& variant, const VariantResult& result) {
  return result.done() &&
         text_of(folder_of(options, variant) + "/case.toml") == case_of(options, variant).text();
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
    if (options.time_limit > 0) {
      const auto limit = static_cast<rlim_t>(std::ceil(options.time_limit));
      const rlimit seconds{limit, limit};
      setrlimit(RLIMIT_CPU, &seconds);
    }
    execv("/proc/self/exe", argv.data());
    _exit(127);
  }
  close(out);
  return child;
}

/// How a process ended: its exit code, or the signal that ended it.
struct Ended {
  int code = 3, signal = 0;

  explicit Ended(int status) {
    if (WIFEXITED(status)) code = WEXITSTATUS(status);
    if (WIFSIGNALED(status)) signal = WTERMSIG(status);
  }
};

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

  /// Waits for one of them.
  std::pair<size_t, Ended> wait_for_one() {
    while (true) {
      // Asked again and again: a signal that came just before a call that waits would be missed.
      if (interrupted && !told_) {
        for (const auto& [pid, variant] : running_) kill(pid, SIGINT);
        told_ = true;
      }
      int status = 0;
      const pid_t child = waitpid(-1, &status, WNOHANG);
      const auto found = running_.find(child);
      if (found == running_.end()) {
        std::this_thread::sleep_for(std::chrono::milliseconds(10));
        continue;
      }
      const size_t variant = found->second;
      running_.erase(found);
      return {variant, Ended(status)};
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
  bool told_ = false;  // did the runs hear of the interruption?
};

void watch_signals() {
  interrupted = 0;
  struct sigaction action {};
  action.sa_handler = [](int) { interrupted = 1; };  // no SA_RESTART: waiting ends
  sigaction(SIGINT, &action, nullptr);
  sigaction(SIGTERM, &action, nullptr);
}

/// The last line a run wrote: what it died of.
std::string last_words(const std::string& log) {
  std::istringstream in(text_of(log));
  std::string last;
  for (std::string line; std::getline(in, line);)
    if (!line.empty()) last = line;
  return last;
}

/// The result of a run that has just ended. A run that could not say so itself has failed.
VariantResult result_of(const StudyOptions& options, const Variant& variant, const Ended& ended) {
  VariantResult out = read_result(options, variant);
  const bool stopped = ended.code == 4 || (interrupted && ended.signal != 0);
  if (stopped) {
    out.status = "interrupted";
  } else if (ended.signal != 0) {
    out.status = "failed";
    out.message = "ended by signal " + std::to_string(ended.signal);
    if (options.time_limit > 0 && (ended.signal == SIGXCPU || ended.signal == SIGKILL))
      out.message = "ended after " + io::to_text(options.time_limit, 3) + " CPU seconds";
  } else if (ended.code != 0 && ended.code != kMissed) {
    out.status = "failed";
    if (out.message.empty()) out.message = last_words(out.directory + ".log");
  } else if (!out.done()) {
    out.status = "failed";
    if (out.message.empty()) out.message = "there is no run.json of a finished run";
  }
  return out;
}

void make_folder(const std::string& path) {
  std::error_code error;
  fs::create_directories(path, error);
  if (error) throw Error::input("folder '" + path + "': " + error.message());
}

}  // namespace

io::CaseFile case_of(const StudyOptions& options, const Variant& variant) {
  return io::CaseFile(find_case(options.case_name), overrides_of(options, variant));
}

void check_variants(const StudyOptions& options, std::span<const Variant> variants) {
  for (const Variant& v : variants) build_scene(read_scene(case_of(options, v)));
}

int run_variant(const StudyOptions& options, const Variant& variant) {
  make_folder(options.directory);
  watch_signals();
  Jobs jobs(options, {&variant, 1});
  if (finished(options, variant, read_result(options, variant))) {
    jobs.say(variant.name + ": finished before");
    return 0;
  }
  jobs.add(0);
  const Ended ended = jobs.wait_for_one().second;
  const VariantResult result = result_of(options, variant, ended);
  jobs.say(variant.name + ": " + result.status);
  if (!result.message.empty())
    std::fprintf(stderr, "flexmorph: %s: %s\n", variant.name.c_str(), result.message.c_str());
  return result.status == "interrupted" ? 4 : ended.code;
}

StudyOutcome run_variants(const StudyOptions& options, std::span<const Variant> variants,
                          const std::function<void(std::span<const VariantResult>)>& changed) {
  make_folder(options.directory);
  watch_signals();
  StudyOutcome out;
  std::vector<size_t> wanted;
  Jobs jobs(options, variants);
  for (size_t i = 0; i < variants.size(); ++i) {
    out.results.push_back(read_result(options, variants[i]));
    if (finished(options, variants[i], out.results[i])) {
      jobs.say(variants[i].name + ": finished before");
      continue;
    }
    // What an earlier run with another case has left is no result of this study.
    VariantResult& result = out.results[i] = VariantResult();
    result.name = variants[i].name;
    result.directory = folder_of(options, variants[i]);
    wanted.push_back(i);
  }
  const auto collect = [&] {
    const auto [i, ended] = jobs.wait_for_one();
    VariantResult& result = out.results[i];
    result = result_of(options, variants[i], ended);
    jobs.say(result.name + ": " + result.status);
    if (result.status == "failed") {
      out.exit_code = 3;
      std::fprintf(stderr, "flexmorph: %s: %s\n", result.name.c_str(), result.message.c_str());
    }
    changed(out.results);
  };
  for (const size_t i : wanted) {
    while (jobs.n_running() >= static_cast<size_t>(options.jobs)) collect();
    if (interrupted) break;
    jobs.add(i);
  }
  while (jobs.n_running() > 0) collect();
  changed(out.results);
  if (interrupted) out.exit_code = 4;
  return out;
}

std::vector<std::string> lean_overrides(const Scene& scene, Part part) {
  std::vector<std::string> out = {"output.vtk=false", "output.plots=false", "expect="};
  if (part == Part::motion) {
    if (scene.designs.empty()) return out;
    for (const char* name : {"design=", "optimizer=", "cycle=", "verify=", "esl="})
      out.emplace_back(name);
    return out;
  }
  for (const char* name : {"optimizer.max_iterations=0", "verify=", "output.sharp_every=0"})
    out.emplace_back(name);
  return out;
}

}  // namespace flexmorph::cases
