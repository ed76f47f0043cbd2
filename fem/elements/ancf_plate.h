#pragma once

#include "fem/line_grid.h"

namespace flexmorph::fem {

/// Rectangular thin ANCF plate elements on a tensor grid of material lines, P 2.1.
///
///   r(X, t) = Σ_k N_k(ξ, η) q_k,   node unknowns r, r_m, r_n and, for h16, r_mn
///
/// h16 has all 16 products of cubic Hermite functions (Bogner-Fox-Schmit); h12 is P (3), without
/// the mixed derivative; q4 has the products of linear functions and only the node unknown r, so
/// that one element is one cell of a design. With driven lines (ALE-ANCF) material flows through
/// the mesh and the shape functions have rates; without driven lines the rates are not computed.
///
/// Source: P (1)-(5); Hyldahl et al. (2013); h16: fem/README.md, Plate element.
class AncfPlate final : public LineGrid,
                        public EulerianLineElement,
                        public CellElement,
                        public ProductElement {
 public:
  /// Sets of shape functions.
  enum class ShapeSet { h12, h16, q4 };

  /// Creates the plate at time t [s] in `dim` dimensions, with the given m-lines and n-lines.
  /// @throws Error unless there are at least two lines in each direction, increasing at that time.
  AncfPlate(int dim, ShapeSet shapes, std::vector<MaterialLine> m, std::vector<MaterialLine> n,
            double t = 0);

  std::span<const int> vectors(int e) const override;
  double scale(int k) const override;
  bool is_position(int k) const override { return k % per_node_ == 0; }
  MatrixXd reference() const override;
  std::vector<NodeVectors> edge(const std::string& name) const override;
  std::vector<NodeVectors> nodes() const override;
  void move_to(double t) override;
  bool moving(int e) const override;
  VectorXd scalars() const override;
  void move_lines(const VectorXd& p, const VectorXd& rate, const VectorXd& acceleration) override;
  std::span<const int> free_sides(int e) const override;
  void tabulate_eulerian(int e, int degree, Tabulate what, EulerianTable& out) const override;
  void tabulate(int e, int degree, Tabulate what, const ScaleFactors& factors, ScaleFactorKind kind,
                ShapeTable& out) const override;
  bool tabulate_products(int e, int degree, const ScaleFactors& factors, ScaleFactorKind kind,
                         ProductTable& out) const override;
  void add_cell_integrals(int e, int degree, const VectorXd& values, const Grid& grid,
                          VectorXd& out) const override;
  CellRange cells(int e, const Grid& grid) const override;
  int locate(const Vec2& material, Tabulate what, ShapeTable& out) const override;

  int per_node() const override { return per_node_; }
  const std::vector<MaterialLine>& lines_m() const override { return m_; }
  const Motion& line_m(int i) const override { return at_m_[static_cast<size_t>(i)]; }
  const Motion& line_n(int j) const override { return at_n_[static_cast<size_t>(j)]; }
  int n_n() const override { return static_cast<int>(n_.size()) - 1; }
  void at(int e, double s, double u, Tabulate what, ShapeTable& out) const override;
  std::unique_ptr<LineGrid> copy() const override;
  std::unique_ptr<LineGrid> with_line(int i, double value) const override;
  std::unique_ptr<LineGrid> without_line(int i) const override;
  std::unique_ptr<LineGrid> frozen() const override;
  std::unique_ptr<LineGrid> with_lines_m(std::vector<MaterialLine> m, double t) const override;

 private:
  NodeVectors vectors_of(int i, int j) const;
  void number_eulerian_lines();
  void fill(int e, std::span<const double> s, std::span<const double> u, Tabulate what,
            ShapeTable& out) const;
  MatrixXd weights(int e, int n, const ScaleFactors& factors, ScaleFactorKind kind) const;

  int per_node_;
  ShapeSet shapes_;
  std::vector<MaterialLine> m_, n_;
  double t_ = 0;
  std::vector<Motion> at_m_, at_n_;
  std::vector<Hermite> hermite_m_, hermite_n_;
  std::vector<int> vectors_;  // n_shapes numbers per element
  std::vector<Motion> free_;  // of the free lines, m-lines first
  std::vector<int> sides_;    // kSides numbers per element, or none
};

}  // namespace flexmorph::fem
