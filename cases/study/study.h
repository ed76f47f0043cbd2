#pragma once

#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "cases/results/quantities.h"
#include "cases/study/dispatch.h"
#include "cases/study/processes.h"
#include "io/case_files/case_file.h"
#include "optim/mmc/problem/body_problem.h"

/// Studies: many runs of one case with changes. Every run has its own process and run folder.
namespace flexmorph::cases {

/// Options that all studies have.
struct StudyOptions {
  std::string case_name;               ///< Path of a case file, or name of a shipped case.
  std::string directory;               ///< Folder of the study; empty: chosen by the study.
  std::vector<std::string> overrides;  ///< Overrides of all variants, "KEY=VALUE".
  int jobs = 1;                        ///< Number of processes at the same time.
  int threads = 1;                     ///< Number of threads of each process.
  bool quiet = false;                  ///< True if no progress is printed.
  double time_limit = 0;               ///< CPU time after which a run is ended [s]; 0: no limit.
  double memory_limit = 0;             ///< Address space of a run [bytes]; 0: no limit.
  std::vector<std::string> arguments;  ///< Further arguments of every `flexmorph run`.
  Dispatch dispatch;                   ///< Destination of the runs.

  /// True if a failed run counts as a result of the study, which is not reported as an error.
  bool keeps_failures = false;
};

/// One run of a study: a changed case with a name.
struct Variant {
  std::string name;                    ///< Name of its run folder in the folder of the study.
  std::vector<std::string> overrides;  ///< Overrides that follow the overrides of the study.
  std::string case_name = {};          ///< Case of the variant; empty means the case of the study.
};

/// The results of one designed body of a run, read from run.json and history.csv.
struct BodyResult {
  std::string verdict;     ///< Verdict on the design: optim::to_string(Verdict::Kind).
  std::string body, stop;  ///< Name of the body, and reason why the optimizer stopped.

  /// Compliances [J] and volume fractions [-] of the regularized design, of the crisp design, and
  /// of uniform material.
  double compliance = 0, volume = 0, crisp_compliance = 0, crisp_volume = 0, uniform_compliance = 0;

  /// Body-fitted compliance of the outline [J] (NaN: not verified, infinite: a load acts on
  /// material without support), its estimated relative error [-], and the volume fraction of the
  /// outline [-].
  double body_fitted = 0, body_fitted_error = 0, body_fitted_volume = 0;

  /// Values of further responses by name, with the prefix crisp_ for the crisp design.
  mmc::Figures further;

  double kkt = 0;                     ///< KKT residual of the design problem [-].
  bool connected = false;             ///< True if one region of material joins supports and loads.
  std::optional<double> min_feature;  ///< Smallest width of material of the outline [m].

  /// Numbers of design iterations, state solves, factorizations and components.
  int iterations = 0, solves = 0, factorizations = 0, components = 0;

  int peaks = 0;                 ///< Number of peaks of the history, see peaks().
  int disconnected = 0;          ///< Number of history rows with a disconnected crisp design.
  double seconds_optimizer = 0;  ///< CPU time of the optimizer itself [s].

  /// Columns of the history (n_rows). Solves are counted over all cycles, and seconds are the
  /// cumulative CPU time of the design iterations [s].
  std::vector<double> history_solves, history_compliance, history_violation, history_seconds;

  /// Stage of every row. The rows of a stage have the same cycle and band; only rows of one stage
  /// can be compared.
  std::vector<int> history_stage;

  /// Iterations at which the crisp design was evaluated, and its compliances [J].
  std::vector<double> crisp_iteration, crisp_history;

  /// Tells whether the verdict on the design is "unfinished".
  bool unfinished() const;
};

/// The program and the machine that have computed a run. Results of equal cases are equal bit for
/// bit if version, commit and kernels are equal.
struct Origin {
  std::string version, commit;  ///< Version of Flexmorph, and commit of its sources.
  std::string processor;        ///< Name of the processor.
  std::string kernels;          ///< Kernels of OpenBLAS, and widest vectors of Flexmorph.

  bool operator==(const Origin&) const = default;
  /// Returns the origin as text.
  std::string words() const;
};

/// The results of a run, read from its run folder.
struct VariantResult {
  std::string name, directory;  ///< Name of the variant, and path of its run folder.

  /// Status: "done", "done, not usable", "failed", "interrupted", "running" (a process still writes
  /// into the folder), "killed" (the status is "running", but the process has ended), "missing",
  /// "another case" (see collected_row()).
  std::string status = "missing";

  Origin origin;        ///< Program and machine of the run.
  std::string message;  ///< Reason of a failure.
  Ending ending;        ///< End of the process; for a run of an earlier study only its exit code.

  /// CPU time [s] and wall time [s] of all calls of the run, and its peak memory [bytes].
  double seconds_cpu = 0, seconds_wall = 0, peak_memory_bytes = 0;
  double seconds_limit = 0;  ///< Limit of CPU time that the last call reached [s]; NaN: none.

  std::vector<BodyResult> bodies;  ///< Results of the designed bodies.

  std::vector<std::string> warnings;  ///< Warnings of the run.

  /// Tells whether the run is complete.
  bool done() const { return status.starts_with("done"); }
  /// Tells whether the verdict on one of the designs is "unfinished".
  bool unfinished() const;
  /// Returns the verdicts on the designs, each verdict once.
  std::string verdicts() const;
  /// Returns the status, the verdicts and the number of warnings as text.
  std::string words() const;
};

/// Returns the paragraph on unfinished runs that follows the tables of a study; empty if all runs
/// are finished.
std::string convergence_note(std::span<const VariantResult> runs);

/// Returns the warnings of all runs for the screen, one paragraph each, with the name of the run in
/// front; empty if there are none. Of many warnings the first kMaxWarnings are given.
std::string warnings_note(std::span<const VariantResult> runs);
inline constexpr size_t kMaxWarnings =
    20;  ///< Largest number of warnings of a study on the screen.

/// Prints a text on the screen, with lines that are not longer than the screen is wide.
void print_text(const std::string& text);
/// Prints the rows of a table, with those columns that the screen can show (io::fitted_table()).
/// @param file  file that has all columns
void print_table(std::span<const std::vector<std::string>> rows, const std::string& file);

/// Reads the case of every variant and builds its model as a run would do.
/// @throws Error (input) as a run would; no file has been written then.
void check_variants(const StudyOptions& options, std::span<const Variant> variants);

/// The result of run_variants().
struct StudyOutcome {
  int exit_code = 0;  ///< Exit code: 0; 3 if a run failed; 4 if runs are missing or interrupted.
  std::vector<VariantResult> results;  ///< Results of all variants; none if lines were printed.
};

/// Function that receives the results so far.
using ResultsChanged = std::function<void(std::span<const VariantResult>)>;

/// Runs the variants that are not finished yet, where StudyOptions::dispatch says. A variant is
/// finished if its run is complete or has failed (exit codes 0, 3 and 5) and the case in its folder
/// is identical. If the study is interrupted, the current runs are interrupted too and keep their
/// results so far. Writes rows.csv into the folder of the study (write_rows()). If the study only
/// prints command lines, nothing is run.
/// @param changed  called with the results so far, after the end of every run and at the end
/// @throws Error (input) when the folder cannot be written.
StudyOutcome run_variants(const StudyOptions& options, std::span<const Variant> variants,
                          const ResultsChanged& changed);

/// Returns the path of the run folder of a variant.
std::string folder_of(const StudyOptions& options, const Variant& variant);

/// Returns the case of a variant.
/// @throws Error (input) as a run would.
io::CaseFile case_of(const StudyOptions& options, const Variant& variant);

/// Reads the result of a variant from its run folder.
VariantResult read_result(const StudyOptions& options, const Variant& variant);

/// Returns the last error message in the terminal output of a run: the first line of the message,
/// without the name of the program. Without an error message, it returns the last line.
std::string last_text(const std::string& words);

/// Returns the completed part of a run from its terminal output so far, such as "12 %".
std::string completed_text(const std::string& log);

/// Returns the text of a file; empty if the file cannot be read.
std::string text_of(const std::string& path);

/// Returns the overrides that reduce a run of the case to one subproblem, without pictures and
/// without expectations, because the expectations belong to the unchanged case.
std::vector<std::string> lean_overrides(const Scene& scene, Part part);

}  // namespace flexmorph::cases
