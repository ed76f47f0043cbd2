#pragma once

#include "geometry/base.h"

namespace flexmorph {

/// A regular grid of rectangular cells over [x0, x0 + width] x [y0, y0 + height] [m].
///
/// Nodes and cells are numbered column by column from the left, and upwards (y fastest) in a
/// column:
///
///   node(i, j) = i (ny + 1) + j,   0 <= i <= nx, 0 <= j <= ny
///   cell(i, j) = i ny + j,         0 <= i <  nx, 0 <= j <  ny
struct Grid {
  double x0 = 0, y0 = 0;         ///< Lower left corner [m].
  double width = 1, height = 1;  ///< Size of the grid [m].
  int nx = 1, ny = 1;            ///< Number of cells in x and y.

  /// Returns the width of a cell [m].
  double dx() const { return width / nx; }
  /// Returns the height of a cell [m].
  double dy() const { return height / ny; }
  /// Returns the number of nodes.
  int n_nodes() const { return (nx + 1) * (ny + 1); }
  /// Returns the number of cells.
  int n_cells() const { return nx * ny; }
  /// Returns the index of the node in column i and row j.
  int node(int i, int j) const { return i * (ny + 1) + j; }
  /// Returns the index of the cell in column i and row j.
  int cell(int i, int j) const { return i * ny + j; }
  /// Returns the position of the node in column i and row j [m].
  Vec2 node_position(int i, int j) const { return {x0 + i * dx(), y0 + j * dy()}; }
  /// Returns the center of the cell in column i and row j [m].
  Vec2 cell_center(int i, int j) const { return {x0 + (i + 0.5) * dx(), y0 + (j + 0.5) * dy()}; }
};

}  // namespace flexmorph
