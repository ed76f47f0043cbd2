#pragma once

#include <optional>
#include <string>

#include "cases/results/series.h"
#include "fem/model/workspace.h"
#include "geometry/archive.h"
#include "io/tables.h"

/// Output of the steps of a motion or of a path of equilibria.
namespace flexmorph::cases {

/// A step of a motion or an equilibrium of a path, as it is passed to the writers.
struct StepRecord {
  fem::Workspace& model;        ///< Model, prepared for the state x.
  const fem::State& x;          ///< State with its Lagrange multipliers.
  std::span<const double> row;  ///< Values of all columns of the table (n_columns).
  double abscissa = 0;          ///< Time of a motion [s], or number of an equilibrium.
  double heating = 1;           ///< Factor of the temperature rises, in a [static] analysis.
  bool stop = true;             ///< True if output at x was requested: start, stop or end.
};

/// Interface of writers, which receive the steps one after the other and use only their records.
class StepWriter {
 public:
  virtual ~StepWriter() = default;
  /// Writes the next step. @throws Error (numerical) when it cannot be written.
  virtual void add(const StepRecord& step) = 0;
  /// Saves the data that the writer keeps between two steps to an archive, or restores them from
  /// it.
  virtual void archive(Archive&) {}
};

/// Collects the rows in a table.
class SeriesWriter : public StepWriter {
 public:
  /// Prepares a writer that appends the rows to a table.
  /// @param table  table whose columns are set; outlives the writer
  explicit SeriesWriter(Series& table) : table_(table) {}
  void add(const StepRecord& step) override { table_.add_row(step.row); }
  void archive(Archive& memory) override { memory(table_.values); }

 private:
  Series& table_;
};

/// Writes a CSV file row by row, so that the rows of a run that was killed are on the disk.
class TableWriter : public StepWriter {
 public:
  /// Prepares a writer; the file is created with the first row.
  /// @param path   path of the file
  /// @param table  table with the same columns; of a resumed motion it is restored before this
  ///               writer and has all rows so far
  TableWriter(std::string path, const Series& table) : path_(std::move(path)), table_(table) {}
  void add(const StepRecord& step) override;
  /// Writes all rows of the table again when the writer is restored; it saves nothing.
  void archive(Archive& memory) override;

 private:
  void begin(std::span<const std::vector<io::Cell>> rows);

  std::string path_;
  const Series& table_;
  std::optional<io::CsvWriter> csv_;
  std::vector<io::Cell> cells_;
};

}  // namespace flexmorph::cases
