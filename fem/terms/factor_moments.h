#pragma once

#include <vector>

#include "fem/element.h"

namespace flexmorph::fem {

/// Moments of the factors of a design across a plate, made once per design:
///
///   M_c(h) = Σ_r κ_cr ∫_r ℓ_h(u) du
///
/// κ_cr  factor of the cell in column c and row r of the grid
/// ℓ_h   Lagrange's polynomials at n Gauss points of a row of elements, u in [0, 1] across it; the
///       integral is over the part of cell row r that lies in it, cut ones included
///
/// With them the weights of an element's n x n points, exact up to degree n - 1 each way, cost the
/// columns of cells that it lies in, and not its cells: its m-lines may move in every step.
class FactorMoments {
 public:
  /// Those of a mesh whose elements lie in many cells of a design: made anew where `all` says that
  /// the design is another one, or its n-lines are. No others have any: cells, uniform material,
  /// elements that take no factors (and say so where they are tabulated).
  /// @param factor  of all cells, one of the two of `factors`
  void follow(const Element& element, const Factors& factors, const VectorXd& factor, int n,
              bool all);
  /// Weights of the points (g, h) of element e where follow() left it [m²]; false, and nothing
  /// done, without moments.
  /// @param out  (n x n)
  bool weigh(int e, MatrixXd& out) const;

  /// @param across  n-lines of the mesh, which stay [m]
  void prepare(const std::vector<double>& across, const Grid& grid, const VectorXd& factor, int n);
  /// Weights of the points of the element between two m-lines in row j of the elements [m²].
  /// @param out  (n x n)
  void weights(double start, double end, int j, MatrixXd& out) const;

 private:
  Grid grid_;
  int n_ = 0;
  std::vector<double> along_, across_;  // lines of the mesh
  std::vector<MatrixXd> rows_;          // M of every row of elements (n x columns)
};

}  // namespace flexmorph::fem
