#pragma once

#include <vector>

#include "fem/element.h"

namespace flexmorph::fem {

/// Moments of the scale factors of a design across a plate, computed once per design:
///
///   M_c(h) = Σ_r κ_cr ∫_r ℓ_h(u) du
///
///   κ_cr  scale factor of the cell in column c and row r of the grid
///   ℓ_h   Lagrange polynomials at n Gauss points of a row of elements, u in [0, 1] across it; the
///         integral is over the part of cell row r that lies in the row of elements, cells that are
///         cut included
///
/// With the moments, the weights of an element's n x n points, exact up to degree n - 1 in each
/// direction, have a cost proportional to the columns of cells in the element, not to all its
/// cells. Therefore its m-lines may move in every step.
class ScaleFactorMoments {
 public:
  /// Computes the moments of a mesh whose elements cover many cells of a design. They are
  /// recomputed if `all` is true (the design has changed) or if the n-lines have changed. Meshes of
  /// cells, uniform material and elements that take no scale factors (and throw when they are
  /// tabulated) have no moments.
  /// @param factor  scale factors of all cells, one of the two kinds in `factors`
  void follow(const Element& element, const ScaleFactors& factors, const VectorXd& factor, int n,
              bool all);
  /// Computes the weights of the points (g, h) of element e, with the lines of the last follow()
  /// [m²].
  /// @returns false, with `out` unchanged, if there are no moments
  /// @param out  (n x n)
  bool weigh(int e, MatrixXd& out) const;

  /// Computes the moments of all rows of elements.
  /// @param across  n-lines of the mesh, which do not move [m]
  void prepare(const std::vector<double>& across, const Grid& grid, const VectorXd& factor, int n);
  /// Computes the weights of the points of the element between two m-lines in row j of the elements
  /// [m²].
  /// @param out  (n x n)
  void weights(double start, double end, int j, MatrixXd& out) const;

 private:
  Grid grid_;
  int n_ = 0;
  std::vector<double> along_, across_;  // lines of the mesh
  std::vector<MatrixXd> rows_;          // M of every row of elements (n x columns)
};

}  // namespace flexmorph::fem
