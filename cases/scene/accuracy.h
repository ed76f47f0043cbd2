#pragma once

#include <optional>
#include <string>
#include <vector>

#include "io/case_files/case_file.h"

/// The table [accuracy] of a case, which the command `flexmorph accuracy` uses. A run ignores it.
namespace flexmorph::cases {

/// A quantity of interest: one number of a run.
struct Interest {
  /// Point of the run at which a column of a table is evaluated.
  enum class At { end, max, time };

  /// Name of a column of motion.csv or path.csv ("plate.corner_z"), of a number of the design
  /// ("compliance", "arm.volume"), or of a number of run.json ("motion.energy_error").
  std::string name;

  At at = At::end;              ///< Point of evaluation; At::max takes the largest absolute value.
  double time = 0;              ///< Time [s], or load factor of a path, of At::time.
  std::optional<double> scale;  ///< Scale of relative errors; absent: the value itself.
  std::optional<double> value;  ///< Reference value from another source, if given.
  std::string file;             ///< CSV file with a reference column of this name; empty: none.
  std::string source;           ///< Origin of the reference, as the case gives it.

  /// Returns true if the case gives a reference value or a reference file.
  bool has_reference() const { return value || !file.empty(); }
  /// Returns the name with the point of evaluation, such as "plate.corner_z, largest".
  std::string words() const;
};

/// The contents of [accuracy].
struct Accuracy {
  std::vector<Interest> quantities;  ///< Quantities of interest, at least one.

  /// Names of the discretization parameters to refine, not checked here; empty: all that apply.
  std::vector<std::string> refinements;

  std::string location;    ///< File and line of the table, for messages.
  bool optimized = false;  ///< True if the optimized design is used (design = "optimized").
};

/// Reads the table [accuracy] of a case.
/// @throws Error (input) located in the file.
Accuracy read_accuracy(const io::Table& t);

}  // namespace flexmorph::cases
