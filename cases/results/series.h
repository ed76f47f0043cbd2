#pragma once

#include <span>
#include <string>
#include <vector>

/// Tables that grow row by row, and what their columns hold.
namespace flexmorph::cases {

/// Columns that tables, plots and run.json treat together.
enum class ColumnGroup {
  abscissa,    ///< time, number of the equilibrium, load factor
  deflection,  ///< tip deflections of bodies
  across,      ///< deflections of observed points of designed bodies
  length,      ///< lengths of bodies whose material flows
  observed,    ///< observed points, and free material lines
  measured,    ///< quantities of [[measure]]
  mechanism,   ///< frames, joints, hubs, springs, momentum
  energy,      ///< energies of the whole model
  term,        ///< energies that terms of bodies account for
  power,       ///< powers that enter the mechanism
  solver       ///< numbers of the solution method
};

/// Describes a column of a table.
struct ColumnInfo {
  std::string name;
  std::string unit;     ///< "m"; "-" of a number without a unit
  std::string meaning;  ///< one sentence
  ColumnGroup group = ColumnGroup::observed;
};

/// A table with one value per column and row.
struct Series {
  std::vector<ColumnInfo> columns;
  std::vector<std::vector<double>> values;  ///< (n_columns) of (n_rows)

  Series() = default;
  explicit Series(std::vector<ColumnInfo> described)
      : columns(std::move(described)), values(columns.size()) {}

  std::size_t n_rows() const { return values.empty() ? 0 : values.front().size(); }
  /// Appends a row (n_columns).
  void add_row(std::span<const double> row);
  /// The values of a column (n_rows); null where the table has no column of this name.
  const std::vector<double>* find(const std::string& name) const;
  /// The values of a column (n_rows). @throws std::out_of_range where there is none.
  const std::vector<double>& at(const std::string& name) const;
  /// Indices of the columns of a group, in their order.
  std::vector<std::size_t> of_group(ColumnGroup group) const;
};

/// The largest absolute value; 0 of no values.
double largest_size(std::span<const double> values);

}  // namespace flexmorph::cases
