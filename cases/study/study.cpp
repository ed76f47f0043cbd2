#include "cases/study/study.h"

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <filesystem>
#include <sstream>

#include "cases/check/ready.h"
#include "cases/output/kept_case.h"
#include "cases/run/progress.h"
#include "cases/run/run.h"
#include "cases/study/processes.h"
#include "io/files.h"
#include "io/output_folder.h"

namespace flexmorph::cases {
namespace {

namespace fs = std::filesystem;

std::vector<std::string> overrides_of(const StudyOptions& options, const Variant& variant) {
  std::vector<std::string> all = options.overrides;
  all.insert(all.end(), variant.overrides.begin(), variant.overrides.end());
  return all;
}

const std::string& case_name_of(const StudyOptions& options, const Variant& variant) {
  return variant.case_name.empty() ? options.case_name : variant.case_name;
}

bool finished(const StudyOptions& options, const Variant& variant, const VariantResult& result) {
  const bool ended = result.done() || (options.keeps_failures && result.status == "failed");
  return ended && keeps_case(folder_of(options, variant), case_of(options, variant));
}

/// Returns the process that runs a variant with this program. Its output is written to a log file
/// next to its folder.
Child child_of(const StudyOptions& options, const Variant& variant) {
  const std::string folder = folder_of(options, variant);
  Child out;
  out.log = folder + ".log";
  out.words = {"run",       case_name_of(options, variant), "-o", folder,
               "--threads", io::to_text(options.threads)};
  // Failures that are results are read from the log, which then contains nothing else.
  if (options.quiet || options.keeps_failures) out.words.emplace_back("--quiet");
  out.words.insert(out.words.end(), options.arguments.begin(), options.arguments.end());
  // A killed run of the same case is resumed. If the case was changed, a new run starts, and the
  // old folder is moved.
  if (keeps_case(folder, case_of(options, variant))) out.words.emplace_back("--resume");
  for (const std::string& change : overrides_of(options, variant)) {
    out.words.emplace_back("--set");
    out.words.push_back(change);
  }
  return out;
}

constexpr std::chrono::seconds kBetweenProgress(20);  // time between lines about running variants

void say(const StudyOptions& options, const std::string& line) {
  if (options.quiet) return;
  print_text(line);
}

/// Returns the result of a run that has just ended. A run without a status of its own has failed.
VariantResult result_of(const StudyOptions& options, const Variant& variant, const Ending& ending) {
  VariantResult out = read_result(options, variant);
  out.ending = ending;
  if (ending.over_time) {
    out.status = "failed";
    out.message = "ended after " + io::to_text(options.time_limit, 3) + " CPU seconds";
  } else if (ending.interrupted || ending.code == 4) {
    out.status = "interrupted";
  } else if (ending.signal != 0) {
    out.status = "failed";
    out.message = "ended by signal " + std::to_string(ending.signal);
  } else if (ending.code != 0 && ending.code != kExpectationsMissed) {
    out.status = "failed";
    if (out.message.empty()) out.message = last_text(text_of(out.directory + ".log"));
  } else if (!out.done()) {
    out.status = "failed";
    if (out.message.empty()) out.message = "the run folder has no run.json of a finished run";
  }
  return out;
}

void make_folder(const std::string& path) {
  std::error_code error;
  fs::create_directories(path, error);
  if (error) throw Error::input("folder '" + path + "' cannot be created: " + error.message());
}

}  // namespace

std::string last_text(const std::string& words) {
  constexpr const char* kProgram = "flexmorph: ";
  std::istringstream in(words);
  std::string last, complaint;
  for (std::string line; std::getline(in, line);) {
    if (!line.empty()) last = line;
    if (line.starts_with(kProgram)) complaint = line.substr(std::string(kProgram).size());
  }
  return complaint.empty() ? last : complaint;
}

std::string completed_text(const std::string& log) {
  constexpr const char* kShare = " % of the run";  // as class Progress writes it
  std::istringstream in(log);
  std::string words;
  for (std::string word; in >> word;) words += (words.empty() ? "" : " ") + word;
  const size_t end = words.rfind(kShare);
  if (end == std::string::npos) return "0 %";
  const size_t begin = words.find_last_of(" ", end - 1) + 1;
  return words.substr(begin, end - begin) + " %";
}

io::CaseFile case_of(const StudyOptions& options, const Variant& variant) {
  return io::CaseFile(find_case(case_name_of(options, variant)), overrides_of(options, variant));
}

void check_variants(const StudyOptions& options, std::span<const Variant> variants) {
  for (const Variant& v : variants)
    require_buildable(PreparedCase(read_scene(case_of(options, v))));
}

int run_variant(const StudyOptions& options, const Variant& variant) {
  make_folder(options.directory);
  io::require_study_folder(options.directory);
  if (finished(options, variant, read_result(options, variant))) {
    say(options, variant.name + ": finished before");
    return 0;
  }
  int code = 4;  // exit code if the run is interrupted before it starts
  run_children({child_of(options, variant)}, 1, {.seconds = options.time_limit},
               {.started = [&](size_t) { say(options, variant.name + ": started"); },
                .ended =
                    [&](size_t, const Ending& ending) {
                      const VariantResult result = result_of(options, variant, ending);
                      say(options, variant.name + ": " + result.words());
                      if (!result.message.empty())
                        std::fprintf(stderr, "flexmorph: %s: %s\n", variant.name.c_str(),
                                     result.message.c_str());
                      // Expectations of the case do not apply to its variants.
                      if (result.status == "interrupted")
                        code = 4;
                      else
                        code = result.done() ? 0 : ending.code < 0 ? 3 : ending.code;
                    }});
  return code;
}

StudyOutcome run_variants(const StudyOptions& options, std::span<const Variant> variants,
                          const std::function<void(std::span<const VariantResult>)>& changed) {
  make_folder(options.directory);
  const io::FolderLock lock(options.directory);
  StudyOutcome out;
  std::vector<size_t> wanted;
  std::vector<Child> children;
  for (size_t i = 0; i < variants.size(); ++i) {
    out.results.push_back(read_result(options, variants[i]));
    if (finished(options, variants[i], out.results[i])) {
      say(options, variants[i].name + ": finished before");
      continue;
    }
    // Results of an earlier run of another case in the folder do not belong to this study.
    VariantResult& result = out.results[i] = VariantResult();
    result.name = variants[i].name;
    result.directory = folder_of(options, variants[i]);
    wanted.push_back(i);
    make_folder(fs::path(result.directory).parent_path().string());
    children.push_back(child_of(options, variants[i]));
  }
  const auto begin = std::chrono::steady_clock::now();
  size_t ended = 0;
  const auto collect = [&](size_t at, const Ending& ending) {
    const size_t i = wanted[at];
    VariantResult& result = out.results[i];
    result = result_of(options, variants[i], ending);
    const double seconds =
        std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
    const double part = static_cast<double>(++ended) / static_cast<double>(wanted.size());
    const double left = seconds * (1 - part) / part;
    const size_t before = variants.size() - wanted.size();
    say(options, std::to_string(before + ended) + "/" + std::to_string(variants.size()) + " " +
                     result.name + ": " + result.words() +
                     (part < 1 ? left_text({left, left}) : ""));
    if (result.status == "failed" && !options.keeps_failures) {
      out.exit_code = 3;
      std::fprintf(stderr, "flexmorph: %s: %s\n", result.name.c_str(), result.message.c_str());
    }
    changed(out.results);
  };
  const auto started = [&](size_t at) { say(options, variants[wanted[at]].name + ": started"); };
  auto shown = begin;
  const auto waiting = [&](const std::vector<size_t>& running) {
    const auto now = std::chrono::steady_clock::now();
    if (options.quiet || now - shown < kBetweenProgress) return;
    shown = now;
    std::string words;
    for (const size_t at : running)
      words += (words.empty() ? "running: " : ", ") + variants[wanted[at]].name + " " +
               completed_text(text_of(children[at].log));
    say(options, words);
  };
  const ChildLimits limits{.seconds = options.time_limit, .memory = options.memory_limit};
  const bool whole = run_children(children, options.jobs, limits,
                                  {.started = started, .ended = collect, .waiting = waiting});
  changed(out.results);
  if (!whole) {
    out.exit_code = 4;
    say(options, "interrupted: the same command continues the study in " + options.directory);
  }
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
  for (const char* name : {"optimizer.max_iterations=0", "verify=", "output.crisp_every=0"})
    out.emplace_back(name);
  return out;
}

}  // namespace flexmorph::cases
