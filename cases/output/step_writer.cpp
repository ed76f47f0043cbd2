#include "cases/output/step_writer.h"

namespace flexmorph::cases {

void TableWriter::begin(std::span<const std::vector<io::Cell>> rows) {
  std::vector<std::string> names;
  for (const ColumnInfo& column : table_.columns) names.push_back(column.name);
  csv_.emplace(path_, names, rows);
}

void TableWriter::add(const StepRecord& step) {
  if (!csv_) begin({});
  cells_.assign(step.row.begin(), step.row.end());
  csv_->row(cells_);
}

void TableWriter::archive(Archive& memory) {
  if (!memory.is_restoring() || table_.n_rows() == 0) return;
  std::vector<std::vector<io::Cell>> rows(table_.n_rows());
  for (const std::vector<double>& column : table_.values)
    for (size_t r = 0; r < rows.size(); ++r) rows[r].emplace_back(column[r]);
  begin(rows);
}

}  // namespace flexmorph::cases
