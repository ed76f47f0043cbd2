#pragma once

#include <span>
#include <string>
#include <vector>

/// Tables that are filled row by row, and descriptions of their columns.
namespace flexmorph::cases {

/// Groups of columns that tables, plots and run.json handle in the same way.
enum class ColumnGroup {
  abscissa,    ///< Time, number of the equilibrium, load factor.
  deflection,  ///< Tip deflections of bodies.
  across,      ///< Deflections of observed points of designed bodies.
  length,      ///< Lengths of bodies whose material moves through the mesh.
  observed,    ///< Observed points, and material coordinates of free lines of the mesh.
  measured,    ///< Quantities of [[measure]].
  mechanism,   ///< Frames, joints, hubs (rigid frames with prescribed motion), springs, momentum.
  energy,      ///< Energies of the whole model.
  term,        ///< Energies of terms of bodies, for example dissipated energy.
  power,       ///< Powers that enter the mechanism.
  solver       ///< Numbers of the solution method.
};

/// The description of a column of a table.
struct ColumnInfo {
  std::string name;                           ///< Name of the column.
  std::string unit;                           ///< Unit, as "m"; "-" for a number without a unit.
  std::string meaning;                        ///< Meaning of the column as a short text.
  ColumnGroup group = ColumnGroup::observed;  ///< Group of the column.
};

/// A table with one value per column and row.
struct Series {
  std::vector<ColumnInfo> columns;          ///< Descriptions of the columns (n_columns).
  std::vector<std::vector<double>> values;  ///< Values by column (n_columns x n_rows).

  Series() = default;
  /// Creates a table without rows.
  explicit Series(std::vector<ColumnInfo> described)
      : columns(std::move(described)), values(columns.size()) {}

  /// Returns the number of rows.
  std::size_t n_rows() const { return values.empty() ? 0 : values.front().size(); }
  /// Appends a row (n_columns).
  void add_row(std::span<const double> row);
  /// Returns the values of a column (n_rows); null if the table has no column of this name.
  const std::vector<double>* find(const std::string& name) const;
  /// Returns the values of a column (n_rows).
  /// @throws std::out_of_range if the table has no column of this name.
  const std::vector<double>& at(const std::string& name) const;
  /// Returns the indices of the columns of a group, in the order of the table.
  std::vector<std::size_t> of_group(ColumnGroup group) const;
};

/// Returns the largest absolute value; 0 if there are no values.
double largest_size(std::span<const double> values);

}  // namespace flexmorph::cases
