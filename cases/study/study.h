#pragma once

#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "cases/results/quantities.h"
#include "cases/study/processes.h"
#include "io/case_files/case_file.h"
#include "optim/mmc/problem/body_problem.h"

/// Many runs of one case with changes: each a process of its own with a run folder of its own.
namespace flexmorph::cases {

struct StudyOptions {
  std::string case_name;
  std::string directory;               ///< holds the run folders; empty: chosen by the study
  std::vector<std::string> overrides;  ///< KEY=VALUE of all variants
  int jobs = 1;                        ///< processes at a time
  int threads = 1;                     ///< of each
  bool quiet = false;
  double time_limit = 0;               ///< CPU time after which a run is ended [s]; 0: none
  double memory_limit = 0;             ///< address space of a run [bytes]; 0: no limit
  std::vector<std::string> arguments;  ///< further ones of every `flexmorph run`
  /// A run that fails is a result: it is not run again with the same case, and not reported as an
  /// error.
  bool keeps_failures = false;
};

struct Variant {
  std::string name;                    ///< of its folder
  std::vector<std::string> overrides;  ///< of its own, after those of the study
  std::string case_name = {};          ///< empty: that of the study
};

/// One designed body of a run: results of run.json and columns of history.csv.
struct BodyResult {
  std::string verdict;  ///< on its design: optim::to_string(Verdict::Kind)
  std::string body, stop;
  double compliance = 0, volume = 0, sharp_compliance = 0, sharp_volume = 0, uniform_compliance = 0;
  /// Of the outline (NaN: not judged, infinite: a load acts on nothing that is held), its estimated
  /// relative error, and its volume.
  double body_fitted = 0, body_fitted_error = 0, body_fitted_volume = 0;
  mmc::Figures further;  ///< other responses, and likewise with sharp_ before their names
  double kkt = 0;
  bool connected = false;
  std::optional<double> min_feature;
  int iterations = 0, solves = 0, factorizations = 0, components = 0;
  int peaks = 0;                 ///< of the history, see peaks()
  int disconnected = 0;          ///< sharp pictures of the history that had come apart
  double seconds_optimizer = 0;  ///< CPU seconds of the optimizer itself
  /// Rows of the history. Solves count on over cycles; seconds are cumulative CPU seconds of the
  /// design iterations; rows of one stage share cycle and band, only they compare.
  std::vector<double> history_solves, history_compliance, history_violation, history_seconds;
  std::vector<int> history_stage;
  std::vector<double> sharp_iteration, sharp_history;  ///< where evaluated

  bool unfinished() const;  ///< whether the verdict on its design says so
};

/// What a run folder says.
struct VariantResult {
  std::string name, directory;
  std::string status =
      "missing";  ///< "done", "done, not usable", "failed", "interrupted", "running" (its process
                  ///< lives), "killed" (it does not), "missing"
  std::string message;  ///< why it failed
  Ending ending;        ///< how its process ended; of a run of an earlier study the exit code
  double seconds_cpu = 0, seconds_wall = 0, peak_memory_bytes = 0;
  std::vector<BodyResult> bodies;

  int warnings = 0;  ///< that it gave

  bool done() const { return status.starts_with("done"); }
  bool unfinished() const;       ///< whether the verdict on one of its designs says so
  std::string verdicts() const;  ///< those on its designs, each once
  /// The status, the verdicts and the number of warnings.
  std::string words() const;
};

/// What tables of a study end with: a paragraph on its runs that are unfinished; empty: none.
std::string convergence_note(std::span<const VariantResult> runs);

/// Reads every variant's case and builds what it would build.
/// @throws Error (input) as a run would; nothing has been written then.
void check_variants(const StudyOptions& options, std::span<const Variant> variants);

struct StudyOutcome {
  int exit_code = 0;  ///< 0, 3 when a run failed, 4 when interrupted
  std::vector<VariantResult> results;
};

/// Runs the variants that are not finished yet (status done with the very same case). When the
/// study is interrupted, so are the runs under way: they keep what they have.
/// @param changed  called after each that ended and at the end, with the results so far
/// @throws Error (input) when the folder cannot be written.
StudyOutcome run_variants(const StudyOptions& options, std::span<const Variant> variants,
                          const std::function<void(std::span<const VariantResult>)>& changed);

/// Runs one variant in its folder, unless it is finished. @return its exit code.
int run_variant(const StudyOptions& options, const Variant& variant);

/// Run folder of a variant.
std::string folder_of(const StudyOptions& options, const Variant& variant);

/// The case of a variant. @throws Error (input) as a run would.
io::CaseFile case_of(const StudyOptions& options, const Variant& variant);

/// What the folder of a variant says.
VariantResult read_result(const StudyOptions& options, const Variant& variant);

/// What a run complained of last, from its words on the terminal: the first line of that message,
/// without the name of the program; of one that did not complain its last line.
std::string last_words(const std::string& words);

/// A whole file; empty when it cannot be read.
std::string text_of(const std::string& path);

/// What turns a run of the case into one of a part, without files that nobody asked for and without
/// expectations, which are of the case as it is.
std::vector<std::string> lean_overrides(const Scene& scene, Part part);

}  // namespace flexmorph::cases
