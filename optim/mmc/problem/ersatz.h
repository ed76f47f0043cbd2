#pragma once

#include <Eigen/SparseCore>
#include <span>

#include "geometry/components/outline.h"
#include "geometry/grid.h"

namespace flexmorph::mmc {

/// What a design makes of every cell: factors on stiffness and mass of full material (n_cells).
struct CellFactors {
  VectorXd stiffness, mass;
};

/// Nodal Heaviside values of the TDF -> factors of the design cells, and back.
///
///   stiffness = mean of E^q over the corners, q = 2      mass = mean of (H - α)/(1 - α)
///
/// H = density, E = eroded of UnionTdf. Stiffness comes from the eroded design, because corners
/// see no gap narrower than a cell: without it optimizers leave slits there, which weigh nothing.
/// The void keeps α^q of its stiffness and no mass (optim/README.md, Ersatz material). Cells whose
/// centre lies in a `solid` polygon are full material, those in an `empty` one void, whatever the
/// components do; solid wins. Cells outside of the domain are void.
class Ersatz {
 public:
  /// @param outside  cells that do not belong to the domain: 1 (n_cells); empty: all belong to it
  Ersatz(const Grid& grid, double alpha, std::span<const std::vector<Vec2>> solid,
         std::span<const std::vector<Vec2>> empty, std::span<const signed char> outside = {});

  int n_domain_cells() const { return n_domain_; }

  /// @param h, eroded  density() and eroded() of the TDF (n_nodes)
  void factors(const VectorXd& h, const VectorXd& eroded, CellFactors& out) const;

  /// Chain rule: df/dstiffness and df/dmass (n_cells) -> df/dH and df/dE (n_nodes).
  void pull_back(const VectorXd& eroded, const VectorXd& d_stiffness, const VectorXd& d_mass,
                 VectorXd& d_h, VectorXd& d_eroded) const;

  /// The same for many functions at once: (n_functions x n_cells) -> (n_functions x n_nodes).
  /// An empty d_mass stands for zeros and leaves d_h empty.
  void pull_back(const VectorXd& eroded, const MatrixXd& d_stiffness, const MatrixXd& d_mass,
                 MatrixXd& d_h, MatrixXd& d_eroded) const;

  /// Second derivatives of a function of the stiffness factors, whose own ones are left out: the
  /// factors are sums of squares of E, one node's by itself.
  /// @return d²f/dE² (n_nodes)
  VectorXd twice(const VectorXd& d_stiffness) const;
  /// dstiffness/dE (n_cells x n_nodes).
  Eigen::SparseMatrix<double> stiffness_slopes(const VectorXd& eroded) const;

  /// Nodes the components may shape: those of a cell that is not fixed (1 or 0, n_nodes).
  std::vector<signed char> shaped_nodes() const;

  /// Factors of a sharp picture (area fractions of the true union, n_cells): material where it is,
  /// the void stiffness of factors() elsewhere.
  CellFactors sharp(const VectorXd& fractions) const;
  /// Derivative of a stiffness factor of sharp() by its area fraction; that of a mass factor is 1.
  double sharp_stiffness_slope() const { return 1 - alpha_ * alpha_; }
  /// The same for dynamics with its own void factors.
  static CellFactors dynamic(const VectorXd& fractions, double stiffness_void, double mass_void);

 private:
  Grid grid_;
  double alpha_;
  int n_domain_ = 0;
  std::vector<signed char> fixed_;  // 1: solid, -1: empty, 0: from the components
};

}  // namespace flexmorph::mmc
