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
#include "cases/study/rows.h"
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

/// Returns the process that runs a variant with this program. Its output is written to a log file
/// next to its folder.
Child child_of(const StudyOptions& options, const Variant& variant) {
  const std::string folder = folder_of(options, variant);
  // A killed run of the same case is resumed. If the case was changed, a new run starts, and the
  // old folder is moved.
  Child out{row_arguments(options, variant, keeps_case(folder, case_of(options, variant))),
            folder + ".log"};
  // Failures that are results are read from the log, which then contains nothing else.
  if (options.quiet || options.keeps_failures) out.words.emplace_back("--quiet");
  return out;
}

constexpr double kSecondsToEnd = 10;                  // CPU time of a run after its time limit [s]
constexpr std::chrono::seconds kBetweenProgress(20);  // time between lines about running variants

void say(const StudyOptions& options, const std::string& line) {
  if (options.quiet) return;
  print_text(line);
}

/// Returns the result of a run that has just ended. A run without a status of its own has failed.
VariantResult result_of(const StudyOptions& options, const Variant& variant, const Ending& ending) {
  VariantResult out = read_result(options, variant);
  const bool limited = out.ending.over_time;
  out.ending = ending;
  out.ending.over_time = ending.over_time || limited;
  if (ending.over_time) {
    out.status = "failed";
    out.message = "ended after " + io::to_text(options.time_limit, 3) + " CPU seconds";
  } else if (ending.interrupted || ending.code == 4) {
    out.status = "interrupted";
  } else if (ending.signal != 0) {
    // A row that ended without an exit code is run again, except where failures are the results.
    out.status = options.keeps_failures ? "failed" : "killed";
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
  const size_t begin = words.find_last_of(' ', end - 1) + 1;
  return words.substr(begin, end - begin) + " %";
}

io::CaseFile case_of(const StudyOptions& options, const Variant& variant) {
  return io::CaseFile(find_case(case_name_of(options, variant)), overrides_of(options, variant));
}

void check_variants(const StudyOptions& options, std::span<const Variant> variants) {
  for (const Variant& v : variants)
    require_buildable(PreparedCase(read_scene(case_of(options, v))));
}

std::vector<std::string> row_arguments(const StudyOptions& options, const Variant& variant,
                                       bool resume) {
  std::vector<std::string> out = {"run", case_name_of(options, variant)};
  for (const std::string& change : overrides_of(options, variant)) {
    out.emplace_back("--set");
    out.push_back(change);
  }
  out.insert(out.end(), {"-o", folder_of(options, variant)});
  if (options.threads != 1) out.insert(out.end(), {"--threads", io::to_text(options.threads)});
  if (options.time_limit > 0) out.insert(out.end(), {"--seconds", io::to_text(options.time_limit)});
  out.insert(out.end(), options.arguments.begin(), options.arguments.end());
  if (resume) out.emplace_back("--resume");
  return out;
}

namespace {

/// Prints why a row failed or was killed on the error stream.
void report_failure(const StudyOptions& options, const VariantResult& row) {
  if (options.keeps_failures || (row.status != "failed" && row.status != "killed")) return;
  std::fprintf(stderr, "flexmorph: %s: %s\n", row.name.c_str(), row.message.c_str());
}

/// Runs the variants that are not finished yet on this machine.
StudyOutcome run_here(const StudyOptions& options, std::span<const Variant> variants,
                      const ResultsChanged& changed) {
  make_folder(options.directory);
  const io::FolderLock lock(options.directory);
  StudyOutcome out;
  std::vector<size_t> wanted;
  std::vector<Child> children;
  for (size_t i = 0; i < variants.size(); ++i) {
    out.results.push_back(read_result(options, variants[i]));
    if (is_answered(options, variants[i], out.results[i])) {
      say(options, variants[i].name + ": finished before");
      report_failure(options, out.results[i]);
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
    report_failure(options, result);
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
  // A run ends itself at its time limit, unless it hangs.
  const ChildLimits limits{
      .seconds = options.time_limit > 0 ? options.time_limit + kSecondsToEnd : 0,
      .memory = options.memory_limit};
  const bool whole = run_children(children, options.jobs, limits,
                                  {.started = started, .ended = collect, .waiting = waiting});
  changed(out.results);
  out.exit_code = exit_code_of(options, out.results);
  if (!whole) {
    out.exit_code = 4;
    say(options, "interrupted: the same command continues the study in " + options.directory);
  }
  return out;
}

}  // namespace

StudyOutcome run_rows(const StudyOptions& options, std::span<const Variant> variants,
                      const ResultsChanged& changed) {
  const Dispatch& dispatch = options.dispatch;
  if (dispatch.prints()) {
    std::fputs(rows_text(options, variants).c_str(), stdout);
    return {};
  }
  if (dispatch.collect) return collect_rows(options, variants, changed);
  if (!dispatch.hosts.empty()) return run_on_hosts(options, variants, changed);
  return run_here(options, variants, changed);
}

StudyOutcome run_variants(const StudyOptions& options, std::span<const Variant> variants,
                          const ResultsChanged& changed) {
  return run_rows(options, variants, [&](std::span<const VariantResult> rows) {
    write_rows(rows, options.directory + "/rows.csv");
    changed(rows);
  });
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
