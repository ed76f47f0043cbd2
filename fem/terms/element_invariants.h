#pragma once

#include <memory>
#include <optional>

#include "fem/terms/factor_moments.h"
#include "fem/terms/membrane_invariant.h"

namespace flexmorph::fem {

/// Matrices W of the elements of a mesh (membrane_invariant.h), computed only where they differ. An
/// element reuses the matrix of the previous one if size and material are equal, and cells of one
/// shape use a multiple of one matrix. For an element that covers many cells of a design, W is
/// computed from moments of their scale factors.
class ElementInvariants {
 public:
  using Packed = std::shared_ptr<const std::vector<double>>;  ///< Shared entries of W.
  static constexpr int kDegree = 12;  ///< Polynomial degree of the products of strains.
  /// Polynomial degree of the products of strains with one vector per node.
  static constexpr int kCellDegree = 4;

  /// Creates the matrices for an elasticity.
  /// @param elasticity  h C [N/m]
  ElementInvariants(const Eigen::Matrix3d& elasticity, Strains strains)
      : elasticity_(elasticity), strains_(strains) {}

  /// Numbers the pairs of vectors.
  /// @param kinds  number of vectors at each of four nodes
  /// @param coupled  true if W couples all pairs, as with material that varies within an element
  /// @throws Error (input) for numbers other than 1, 3 and 4.
  void number(int kinds, bool coupled);
  /// Starts the computation for a mesh.
  /// @param all  true if the mesh or its material has changed, false if only lines have moved
  void begin(const Element& element, const ScaleFactors& factors, bool all);

  /// Returns the lower triangles of the blocks of W of element e, row by row.
  /// @throws Error (input) where the shape functions are not products along m and n.
  Packed of(const Element& element, int e, const ScaleFactors& factors);
  /// Computes weights of n x n points of element e that include the scale factors, n = kDegree + 1.
  /// @returns false unless the material is a design and the elements cover many cells.
  bool weigh(int e, MatrixXd& weights) const { return moments_.weigh(e, weights); }
  /// Returns the blocks of the last W as full squares.
  Packed squares();
  /// Returns the products from which the last W was made. Their weights contain the mean scale
  /// factor of the element.
  const ProductTable& table() const { return table_; }
  /// Returns W of a table without reuse (for cells alone, with material that differs from the
  /// element's).
  std::vector<double> of_table(const ProductTable& table) const;

  /// Returns the number of pairs of vectors.
  int n_pairs() const { return static_cast<int>(pairs_.i.size()); }

 private:
  Packed scaled();

  Eigen::Matrix3d elasticity_;
  Strains strains_;
  int kinds_ = 0;
  bool coupled_ = false;
  PairNumbers pairs_;               // of gram::Numbering
  InvariantIndices value_indices_;  // indices of the entries of W
  // Even or odd function of every vector.
  std::vector<int> function_m_, function_n_;
  ScaleFactorMoments moments_;
  ProductTable table_, previous_;
  int tabulated_ = -1;  // element of table_
  MatrixXd weights_;
  Packed scaled_from_;  // W of a cell from which the matrices of other cells are scaled
  ProductTable scaled_from_table_;
  Packed last_, squares_, squares_of_;  // W of table_; its squares; the W they belong to
};

}  // namespace flexmorph::fem
