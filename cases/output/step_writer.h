#pragma once

#include <optional>
#include <string>

#include "cases/results/series.h"
#include "fem/model/workspace.h"
#include "geometry/memory.h"
#include "io/tables.h"

/// What takes the steps of a motion or of a path of equilibria.
namespace flexmorph::cases {

/// A step of a motion or an equilibrium of a path, as its writers get it.
struct StepRecord {
  fem::Workspace& model;        ///< prepared for x
  const fem::State& x;          ///< state, with the multipliers that belong to it
  std::span<const double> row;  ///< values of all columns of the table (n_columns)
  double abscissa = 0;          ///< time of a motion [s], number of an equilibrium
  double heating = 1;           ///< factor of the temperatures in a [static] analysis
  bool stop = true;             ///< whether x is a state that was asked for: start, stop or end
};

/// Takes one step after the other. A writer asks for nothing but its record.
class StepWriter {
 public:
  virtual ~StepWriter() = default;
  /// Takes the next step. @throws Error (numerical) when it cannot be written.
  virtual void add(const StepRecord& step) = 0;
  /// Saves or restores what the writer holds between two steps.
  virtual void remember(Memory&) {}
};

/// Collects the rows in a table.
class SeriesWriter : public StepWriter {
 public:
  /// @param table  with its columns; outlives the writer
  explicit SeriesWriter(Series& table) : table_(table) {}
  void add(const StepRecord& step) override { table_.add_row(step.row); }
  void remember(Memory& memory) override { memory(table_.values); }

 private:
  Series& table_;
};

/// Writes a CSV file that grows with the motion: rows of a run that was killed are on the disk.
class TableWriter : public StepWriter {
 public:
  /// @param path   nothing is written before the first row
  /// @param table  holds the rows so far when the motion is resumed; is restored before this writer
  TableWriter(std::string path, const Series& table) : path_(std::move(path)), table_(table) {}
  void add(const StepRecord& step) override;
  /// Restored, writes the rows of the table anew.
  void remember(Memory& memory) override;

 private:
  void begin(std::span<const std::vector<io::Cell>> rows);

  std::string path_;
  const Series& table_;
  std::optional<io::CsvWriter> csv_;
  std::vector<io::Cell> cells_;
};

}  // namespace flexmorph::cases
