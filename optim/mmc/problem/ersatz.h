#pragma once

#include <Eigen/SparseCore>
#include <span>

#include "geometry/components/outline.h"
#include "geometry/grid.h"

namespace flexmorph::mmc {

/// Scale factors of stiffness and mass of the cells, relative to full material.
struct CellScaleFactors {
  VectorXd stiffness, mass;  ///< Scale factors of each cell (n_cells) [-].
};

/// Maps nodal Heaviside values of the TDF to scale factors of the design cells, and derivatives by
/// these scale factors back to the nodes.
///
///   stiffness = mean of E^q over the corners, q = 2      mass = mean of (H - α)/(1 - α)
///
/// H = density, E = eroded of UnionTdf. The stiffness is that of the eroded design, because corners
/// do not resolve a gap narrower than a cell: without erosion optimizers leave slits there, which
/// cost no volume. The void keeps α^q of its stiffness and no mass (optim/README.md, Ersatz
/// material). Cells whose centre lies in a `solid` polygon are full material and cells whose centre
/// lies in an `empty` polygon are void, whatever the components cover; solid has priority. Cells
/// outside of the domain are void.
class Ersatz {
 public:
  /// Creates the map for a grid with passive regions.
  /// @param alpha    α, value of the Heaviside function in the void [-]
  /// @param solid    polygons of solid passive regions [m]
  /// @param empty    polygons of void passive regions [m]
  /// @param outside  1 for cells that do not belong to the domain (n_cells); empty: none
  Ersatz(const Grid& grid, double alpha, std::span<const std::vector<Vec2>> solid,
         std::span<const std::vector<Vec2>> empty, std::span<const signed char> outside = {});

  /// Returns the number of cells that belong to the domain.
  int n_domain_cells() const { return n_domain_; }

  /// Computes the scale factors of all cells.
  /// @param h, eroded  density() and eroded() of the TDF (n_nodes)
  void factors(const VectorXd& h, const VectorXd& eroded, CellScaleFactors& out) const;

  /// Applies the chain rule to one function: df/dstiffness and df/dmass (n_cells) -> df/dH and
  /// df/dE (n_nodes).
  void pull_back(const VectorXd& eroded, const VectorXd& d_stiffness, const VectorXd& d_mass,
                 VectorXd& d_h, VectorXd& d_eroded) const;

  /// Applies the chain rule to several functions at once: (n_functions x n_cells) -> (n_functions x
  /// n_nodes). An empty d_mass stands for zeros and leaves d_h empty.
  void pull_back(const VectorXd& eroded, const MatrixXd& d_stiffness, const MatrixXd& d_mass,
                 MatrixXd& d_h, MatrixXd& d_eroded) const;

  /// Returns second derivatives d²f/dE² (n_nodes) of a function f of the stiffness factors, without
  /// the contribution of the second derivatives of f by these factors. Mixed derivatives are zero,
  /// because the stiffness factors are sums of squares of the nodal values E.
  /// @param d_stiffness  df/dstiffness (n_cells)
  VectorXd twice(const VectorXd& d_stiffness) const;
  /// Returns the derivatives dstiffness/dE (n_cells x n_nodes).
  Eigen::SparseMatrix<double> stiffness_gradient(const VectorXd& eroded) const;

  /// Returns 1 for nodes of cells that are not fixed, whose values components can change, and 0 for
  /// all other nodes (n_nodes).
  std::vector<signed char> shaped_nodes() const;

  /// Returns the scale factors of a crisp design: full material where there is material, the void
  /// stiffness of factors() elsewhere.
  /// @param fractions  area fractions of the exact union (n_cells)
  CellScaleFactors crisp(const VectorXd& fractions) const;
  /// Returns the derivative of a stiffness factor of crisp() by its area fraction. The derivative
  /// of a mass factor is 1.
  double crisp_stiffness_derivative() const { return 1 - alpha_ * alpha_; }
  /// Returns the scale factors of a crisp design for dynamics, with separate scale factors of void.
  /// @param fractions  area fractions of the exact union (n_cells)
  static CellScaleFactors dynamic(const VectorXd& fractions, double stiffness_void,
                                  double mass_void);

 private:
  Grid grid_;
  double alpha_;
  int n_domain_ = 0;
  std::vector<signed char> fixed_;  // 1: solid, -1: empty, 0: given by the components
};

}  // namespace flexmorph::mmc
