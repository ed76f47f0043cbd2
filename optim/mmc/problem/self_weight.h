#pragma once

#include <span>
#include <vector>

#include "fem/solve/static_solver.h"

namespace flexmorph::mmc {

/// The weight of a static plate as a function of its design. A cell with the mass scale factor m
/// contributes to each of its four nodes the force
///
///   f = m ρ c Δx Δy g / 4
///
/// ρ (1)  density              [kg/m^3]
/// c (1)  thickness            [m]
/// g (2)  gravity              [m/s^2]
///
/// which is the consistent nodal force of a uniform body force on a bilinear rectangle.
class SelfWeight {
 public:
  /// Creates the weight of the plate of a solver.
  /// @param gravity  acceleration of gravity [m/s^2]
  /// @param outside  1 for cells outside of the domain (n_cells), which have no weight; empty: none
  SelfWeight(const fem::StaticSolver& solver, const Vec2& gravity,
             std::span<const signed char> outside);

  /// Adds the weight to every row of the forces F (n x n_unknowns) [N].
  /// @param mass  mass scale factors (n_cells)
  void add(const VectorXd& mass, MatrixXd& F) const;
  /// Returns the work of the weight of every cell of full mass on the displacements of every load
  /// (n x n_cells) [J].
  /// @param u  displacements (n x n_unknowns) [m]
  MatrixXd work(const MatrixXd& u) const;

 private:
  Grid grid_;
  Vec2 force_;             // force of a full cell on one of its nodes [N]
  std::vector<int> rows_;  // indices of the unknowns of the nodes (2 n_nodes); -1: held
  std::vector<signed char> outside_;
};

}  // namespace flexmorph::mmc
