#pragma once

#include <optional>
#include <string>
#include <vector>

#include "io/case_files/case_file.h"

/// The table [accuracy] of a case: what `flexmorph accuracy` measures. A run does not look at it.
namespace flexmorph::cases {

/// A quantity of interest: one number of a run.
struct Interest {
  /// When a column of a table is looked at.
  enum class At { end, max, time };

  /// A column of motion.csv or path.csv ("plate.corner_z"), a figure of the design
  /// ("compliance", "arm.volume"), or a number of run.json ("motion.energy_defect").
  std::string name;
  At at = At::end;              ///< max: the largest size
  double time = 0;              ///< [s], load factor of a path; with At::time
  std::optional<double> scale;  ///< errors are parts of it; absent: of the value itself
  std::optional<double> value;  ///< known from elsewhere
  std::string file;             ///< or a CSV file with a column of that name; empty: neither
  std::string source;           ///< where that comes from

  bool has_reference() const { return value || !file.empty(); }
  /// "plate.corner_z at the end".
  std::string words() const;
};

struct Accuracy {
  std::vector<Interest> quantities;  ///< at least one
  std::vector<std::string> ladders;  ///< names of knobs, not checked; empty: all that apply
  std::string place;                 ///< file and line, for messages about them
  bool optimized = false;            ///< design = "optimized": the result, not the start
};

/// Reads [accuracy].
/// @throws Error (input) located in the file.
Accuracy read_accuracy(const io::Table& t);

}  // namespace flexmorph::cases
