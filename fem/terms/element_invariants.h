#pragma once

#include <memory>
#include <optional>

#include "fem/terms/factor_moments.h"
#include "fem/terms/membrane_invariant.h"

namespace flexmorph::fem {

/// W of the elements of a mesh (membrane_invariant.h), made no more often than they differ: that of
/// the element before where size and material are the same, and of cells of one shape a multiple.
/// That of an element over many cells of a design is made from moments of their factors.
class ElementInvariants {
 public:
  using Packed = std::shared_ptr<const std::vector<double>>;
  static constexpr int kDegree = 12;     ///< of the strains' products
  static constexpr int kCellDegree = 4;  ///< of the strains' products, with one vector at a node

  /// @param elasticity  h C [N/m]
  ElementInvariants(const Eigen::Matrix3d& elasticity, Strains strains)
      : elasticity_(elasticity), strains_(strains) {}

  /// @param kinds    vectors at each of four nodes
  /// @param coupled  does W couple all pairs, as with material that differs over an element?
  /// @throws Error (input) for other numbers than 1, 3 and 4.
  void number(int kinds, bool coupled);
  /// The mesh, or, where `all` is said, its material is another one.
  void begin(const Element& element, const Factors& factors, bool all);

  /// Lower triangles of the blocks of W, row by row.
  /// @throws Error (input) where shape functions are no products along m and n.
  Packed of(const Element& element, int e, const Factors& factors);
  /// Weights for n x n points of element e with the factors in them, n those of degree 12; only
  /// where the material is that of a design, and elements have many cells.
  bool weigh(int e, MatrixXd& weights) const { return moments_.weigh(e, weights); }
  /// The blocks of the last W as full squares.
  Packed squares();
  /// The products that the last W is made of: the mean factor of the element.
  const ProductTable& table() const { return table_; }
  /// W of a table, as it is (cells alone, of material that is not the element's).
  std::vector<double> of_table(const ProductTable& table) const;

  int n_pairs() const { return static_cast<int>(pairs_.i.size()); }

 private:
  Packed scaled();

  Eigen::Matrix3d elasticity_;
  Strains strains_;
  int kinds_ = 0;
  bool coupled_ = false;
  PairNumbers pairs_;                         // of gram::Numbering
  InvariantPlaces places_;                    // of the entries of W
  std::vector<int> function_m_, function_n_;  // even or odd function of every vector
  FactorMoments moments_;
  ProductTable table_, previous_;
  int tabulated_ = -1;  // element of table_
  MatrixXd weights_;
  Packed scaled_from_;  // W of a cell that those of others are scaled from
  ProductTable scaled_from_table_;
  Packed last_, squares_, squares_of_;  // W of table_; the squares of which W
};

}  // namespace flexmorph::fem
