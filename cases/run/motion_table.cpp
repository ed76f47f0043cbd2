#include "cases/run/motion_table.h"

namespace flexmorph::cases {
namespace {

/// Calls with the name and the last value of every column, in the order of the table.
template <class Add>
void last_row(const MotionRecord& m, const Scene& scene, const std::vector<Column>& measured,
              const std::vector<Column>& mechanism, const Add& add) {
  const auto all = [&](const std::vector<Column>& columns) {
    for (const Column& column : columns) add(column.name, column.values.back());
  };
  add("time", m.time.back());
  for (size_t i = 0; i < m.bodies.size(); ++i)
    add(m.bodies[i] + ".tip_deflection", m.deflection[i].back());
  for (const std::string& body : m.growing)
    add(body + ".length", scene.body(body).length_at(m.time.back()));
  all(m.observed);
  all(measured);
  all(mechanism);
  add("energy.kinetic", m.kinetic.back());
  add("energy.strain", m.strain.back());
  add("energy.potential", m.potential.back());
  add("energy.defect", m.defect.back());
  all(m.written);
  all(m.powers);
}

}  // namespace

void MotionTable::add(const MotionRecord& motion, const std::vector<Column>& measured,
                      const std::vector<Column>& mechanism) {
  if (!csv_) {
    std::vector<std::string> columns;
    last_row(motion, scene_, measured, mechanism,
             [&](const std::string& name, double) { columns.push_back(name); });
    csv_.emplace(path_, columns);
  }
  row_.clear();
  last_row(motion, scene_, measured, mechanism,
           [&](const std::string&, double value) { row_.emplace_back(value); });
  csv_->row(row_);
}

}  // namespace flexmorph::cases
