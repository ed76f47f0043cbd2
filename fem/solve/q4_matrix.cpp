#include "fem/solve/q4_matrix.h"

#include <algorithm>
#include <cstddef>

#include "fem/solve/q4_cell.h"

namespace flexmorph::fem {
namespace {

/// Returns the displacement of every unknown, the inverse of `rows`.
std::vector<int> inverse(std::span<const int> rows) {
  std::vector<int> out(rows.size(), -1);
  int n = 0;
  for (std::size_t k = 0; k < rows.size(); ++k) {
    if (rows[k] < 0) continue;
    out[static_cast<std::size_t>(rows[k])] = static_cast<int>(k);
    ++n;
  }
  out.resize(static_cast<std::size_t>(n));
  return out;
}

}  // namespace

Q4Matrix::Q4Matrix(const Grid& grid, const PlaneSection& section, std::vector<int> cells,
                   std::vector<int> rows, std::optional<std::pair<int, int>> further)
    : grid_(grid),
      cell_stiffness_(q4_stiffness(section, grid.dx(), grid.dy())),
      cells_(std::move(cells)),
      rows_(std::move(rows)),
      displacement_of_(inverse(rows_)),
      factor_(pattern(further)) {}

/// Finds the unknowns of the cells around a node that are not below `first`, ascending.
void Q4Matrix::unknowns_around(int node, int first, std::span<const char> inside,
                               std::vector<int>& out) const {
  const int i = node / (grid_.ny + 1), j = node % (grid_.ny + 1);
  out.clear();
  for (int ci = std::max(0, i - 1); ci <= std::min(grid_.nx - 1, i); ++ci)
    for (int cj = std::max(0, j - 1); cj <= std::min(grid_.ny - 1, j); ++cj)
      if (inside[static_cast<std::size_t>(grid_.cell(ci, cj))])
        for (const int row : rows_of_cell(ci, cj))
          if (row >= first) out.push_back(row);
  std::sort(out.begin(), out.end());
  out.erase(std::unique(out.begin(), out.end()), out.end());
}

/// Builds the lower triangle by columns, and finds the entries to which the cells contribute.
SupernodalFactor Q4Matrix::pattern(std::optional<std::pair<int, int>> further) {
  std::vector<char> inside(static_cast<std::size_t>(grid_.n_cells()), 0);
  for (const int cell : cells_) inside[static_cast<std::size_t>(cell)] = 1;
  std::vector<int> starts = {0}, pattern, column;
  starts.reserve(static_cast<std::size_t>(size()) + 1);
  pattern.reserve(static_cast<std::size_t>(size()) * 10);  // 9 nodes, half of them numbered later
  for (int c = 0; c < size(); ++c) {
    unknowns_around(displacement_of(c) / 2, c, inside, column);
    if (further && further->second == c &&
        !std::binary_search(column.begin(), column.end(), further->first))
      column.insert(std::lower_bound(column.begin(), column.end(), further->first), further->first);
    pattern.insert(pattern.end(), column.begin(), column.end());
    starts.push_back(static_cast<int>(pattern.size()));
  }
  const auto entry = [&](int r, int c) {
    const auto begin = pattern.begin() + starts[static_cast<std::size_t>(c)];
    const auto end = pattern.begin() + starts[static_cast<std::size_t>(c) + 1];
    return static_cast<int>(std::lower_bound(begin, end, r) - pattern.begin());
  };
  scatter_.reserve(36 * cells_.size());
  for (const int value_index : cells_) {
    const auto cell = rows_of_cell(value_index / grid_.ny, value_index % grid_.ny);
    for (std::size_t a = 0; a < 8; ++a)
      for (std::size_t b = 0; b <= a; ++b) {
        const int c = std::min(cell[a], cell[b]), r = std::max(cell[a], cell[b]);
        scatter_.push_back(c < 0 ? -1 : entry(r, c));
      }
  }
  if (further) further_entry_ = entry(further->first, further->second);
  return {std::move(starts), std::move(pattern)};
}

std::span<double> Q4Matrix::assemble(const VectorXd& stiffness_factor) {
  const std::span<double> values = factor_.values();
  std::fill(values.begin(), values.end(), 0.0);
  const int* entry = scatter_.data();
  for (const int cell : cells_) {
    const double factor = stiffness_factor(cell);
    for (int a = 0; a < 8; ++a)
      for (int b = 0; b <= a; ++b, ++entry)
        if (*entry >= 0) values[static_cast<std::size_t>(*entry)] += factor * cell_stiffness_(a, b);
  }
  return values;
}

}  // namespace flexmorph::fem
