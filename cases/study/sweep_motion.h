#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "cases/study/study.h"
#include "io/plots.h"

/// Plots and tables of a sweep of scenes without a design: the observed quantities of all variants.
namespace flexmorph::cases {

/// The columns of motion.csv (or of path.csv of a static analysis) of a variant or of a reference.
/// The first column is the abscissa of the others. There are no columns if there is no such file.
struct Motions {
  std::string label;                         ///< Label of the curves in plots.
  std::vector<std::string> names;            ///< Names of the columns (n_columns).
  std::vector<std::vector<double>> columns;  ///< Values by column (n_columns x n_rows).
  std::vector<std::string> units = {};       ///< Units of the columns (n_columns); "" if unknown.

  /// Returns the values of a column (n_rows); null if there is no column of this name.
  const std::vector<double>* column(const std::string& name) const;
};
/// Reads the columns of the motion or of the path of equilibria in a run folder, without units.
/// @throws Error (input) when a file cannot be parsed.
Motions read_motions(const std::string& directory, const std::string& label);
/// Sets the units of all variants from the case of the first run that has columns; they stay empty
/// if this case cannot be built.
void set_units(std::span<Motions> variants, std::span<const VariantResult> runs);
/// The tip deflection of a body over the motion with its design.
struct Deflection {
  std::vector<double> time, value;  ///< Times [s] and tip deflections [m] (n_rows).

  /// Returns the largest absolute value of the deflection [m].
  double largest() const;
};
/// Returns the tip deflection of a body, from the verification of the design if there is one;
/// nothing for a body without a tip.
/// @throws Error (input) when a file cannot be parsed.
std::optional<Deflection> deflection_of(const VariantResult& run, const std::string& body);
/// Reads the columns of a reference file; returns no columns for an empty path.
/// @throws Error (input) when the file cannot be read.
Motions read_reference(const std::string& path);

/// Returns a figure with a panel per column that is not constant, a curve per variant, and points
/// of the reference if it has the column.
io::Figure motion_figure(const std::string& title, std::span<const Motions> variants,
                         const Motions& reference);

/// Returns a figure of the values at the end of the runs against the varied numbers, with a panel
/// per column that differs between runs (T Fig. 15, see fem/README.md). A panel shows the change of
/// the value relative to the first value of the curve [%] if none of these first values is zero,
/// else the value.
/// @param label   label of the axis of the numbers
/// @param number  varied number of every variant
/// @param curve   name of the curve of every variant; variants with the same name form a curve
io::Figure final_figure(const std::string& title, const std::string& label,
                        std::span<const Motions> variants, std::span<const double> number,
                        std::span<const std::string> curve);

/// Returns a header and a row per variant and observed column: unit, smallest, largest and last
/// value.
std::vector<std::vector<std::string>> motion_table(std::span<const Motions> variants,
                                                   std::span<const VariantResult> runs);

}  // namespace flexmorph::cases
