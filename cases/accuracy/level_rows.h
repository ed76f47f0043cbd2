#pragma once

#include <optional>
#include <string>
#include <vector>

#include "cases/accuracy/study.h"

namespace flexmorph::cases {

/// Status of a level whose row has no results (LevelRun::status).
inline constexpr const char* kMissing = "missing";

/// The rows of an accuracy study: the optimization, the unchanged case, the levels, and the runs
/// that verify recommendations. They are run one after the other within a budget, or all at once on
/// other machines (Dispatch).
class LevelRows {
 public:
  /// Creates the rows of a study.
  /// @param scene, study  have to outlive the object; the study may be filled later
  LevelRows(const Scene& scene, const AccuracyStudy& study, const StudyOptions& options);

  /// Returns the options of the rows.
  const StudyOptions& options() const { return options_; }
  /// Tells whether the rows are run elsewhere, so that no budget chooses them.
  bool are_elsewhere() const;
  /// Tells whether the levels analyse optimized designs.
  bool start_from_optimum() const;

  /// Returns the row that optimizes the designs.
  static Variant optimization();
  /// Sets the starts of the designs to the optimized ones.
  void take_optimum();
  /// Returns the row of a level.
  Variant row(Part part, const std::string& name, const Level& level) const;
  /// Returns the name of the row of a level of a series.
  static std::string name_of(const RefinementSeries& series, size_t level);

  /// Returns the result of a row, which is run here unless the rows are elsewhere. The status is
  /// kMissing if it has none. Rows that verify recommendations are run on other machines, too.
  /// @param limit  limit of the CPU time [s]; 0: none
  /// @throws Interrupted
  VariantResult result_of(const Variant& row, double limit, bool verifies);

  /// Returns the rows that are known before any of them is measured. Rows of optimized designs are
  /// known after the optimization.
  std::vector<Variant> known();
  /// Runs the known rows on other machines.
  /// @throws Interrupted if rows have no results then
  void run_known(bool quiet);
  /// Tells whether all rows have results.
  bool have_results(const std::vector<Variant>& rows) const;
  /// Prints the command lines of rows, or their job array.
  void print(const std::vector<Variant>& rows) const;
  /// Collects existing results from now on, and runs nothing.
  void collect() { options_.dispatch = {.collect = true}; }

  /// Returns the results that were read so far.
  const std::vector<VariantResult>& results() const { return results_; }
  /// Returns the rows that were read and have no results.
  const std::vector<Variant>& missing() const { return missing_; }

 private:
  std::optional<double> last_time() const;

  const Scene& scene_;
  const AccuracyStudy& study_;
  StudyOptions options_;
  std::vector<std::string> starts_;  // overrides that set the starts of the designs
  std::vector<VariantResult> results_;
  std::vector<Variant> missing_;
};

}  // namespace flexmorph::cases
