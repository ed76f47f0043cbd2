#pragma once

#include "geometry/base.h"

namespace flexmorph {

/// Regular grid of rectangular cells over [x0, x0 + width] x [y0, y0 + height]   [m].
///
/// Nodes and cells are numbered column by column, y fastest, from the left:
///   node(i, j) = i (ny + 1) + j,   0 <= i <= nx, 0 <= j <= ny
///   cell(i, j) = i ny + j,         0 <= i <  nx, 0 <= j <  ny
struct Grid {
  double x0 = 0, y0 = 0;
  double width = 1, height = 1;
  int nx = 1, ny = 1;

  double dx() const { return width / nx; }
  double dy() const { return height / ny; }
  int n_nodes() const { return (nx + 1) * (ny + 1); }
  int n_cells() const { return nx * ny; }
  int node(int i, int j) const { return i * (ny + 1) + j; }
  int cell(int i, int j) const { return i * ny + j; }
  Vec2 node_position(int i, int j) const { return {x0 + i * dx(), y0 + j * dy()}; }
  Vec2 cell_center(int i, int j) const { return {x0 + (i + 0.5) * dx(), y0 + (j + 0.5) * dy()}; }
};

}  // namespace flexmorph
