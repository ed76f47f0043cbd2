#include "cases/results/series.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace flexmorph::cases {

void Series::add_row(std::span<const double> row) {
  for (std::size_t c = 0; c < values.size(); ++c) values[c].push_back(row[c]);
}

const std::vector<double>* Series::find(const std::string& name) const {
  for (std::size_t c = 0; c < columns.size(); ++c)
    if (columns[c].name == name) return &values[c];
  return nullptr;
}

const std::vector<double>& Series::at(const std::string& name) const {
  if (const std::vector<double>* found = find(name)) return *found;
  throw std::out_of_range("the table has no column '" + name + "'");
}

std::vector<std::size_t> Series::of_group(ColumnGroup group) const {
  std::vector<std::size_t> out;
  for (std::size_t c = 0; c < columns.size(); ++c)
    if (columns[c].group == group) out.push_back(c);
  return out;
}

double largest_size(std::span<const double> values) {
  double out = 0;
  for (const double value : values) out = std::max(out, std::abs(value));
  return out;
}

}  // namespace flexmorph::cases
