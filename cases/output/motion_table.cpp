#include "cases/output/motion_table.h"

namespace flexmorph::cases {
namespace {

/// Calls with the name and the value of every column, in the order of the table.
template <class Add>
void each_of_row(const MotionRecord& m, const Scene& scene, const std::vector<Column>& measured,
                 const std::vector<Column>& mechanism, size_t row, const Add& add) {
  const auto all = [&](const std::vector<Column>& columns) {
    for (const Column& column : columns) add(column.name, column.values[row]);
  };
  add("time", m.time[row]);
  for (size_t i = 0; i < m.bodies.size(); ++i)
    add(m.bodies[i] + ".tip_deflection", m.deflection[i][row]);
  for (const std::string& body : m.growing)
    add(body + ".length", scene.body(body).length_at(m.time[row]));
  all(m.observed);
  all(measured);
  all(mechanism);
  add("energy.kinetic", m.kinetic[row]);
  add("energy.strain", m.strain[row]);
  add("energy.potential", m.potential[row]);
  add("energy.defect", m.defect[row]);
  all(m.written);
  all(m.powers);
}

}  // namespace

void MotionTable::begin(const MotionRecord& motion, const std::vector<Column>& measured,
                        const std::vector<Column>& mechanism, size_t n_rows) {
  std::vector<std::string> columns;
  each_of_row(motion, scene_, measured, mechanism, 0,
              [&](const std::string& name, double) { columns.push_back(name); });
  std::vector<std::vector<io::Cell>> rows(n_rows);
  for (size_t row = 0; row < n_rows; ++row)
    each_of_row(motion, scene_, measured, mechanism, row,
                [&](const std::string&, double value) { rows[row].emplace_back(value); });
  csv_.emplace(path_, columns, rows);
}

void MotionTable::add_all(const MotionRecord& motion, const std::vector<Column>& measured,
                          const std::vector<Column>& mechanism) {
  if (!motion.time.empty()) begin(motion, measured, mechanism, motion.time.size());
}

void MotionTable::add(const MotionRecord& motion, const std::vector<Column>& measured,
                      const std::vector<Column>& mechanism) {
  if (!csv_) begin(motion, measured, mechanism, 0);
  row_.clear();
  each_of_row(motion, scene_, measured, mechanism, motion.time.size() - 1,
              [&](const std::string&, double value) { row_.emplace_back(value); });
  csv_->row(row_);
}

}  // namespace flexmorph::cases
