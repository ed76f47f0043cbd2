#pragma once

#include <span>
#include <vector>

#include "fem/solve/static_solver.h"

namespace flexmorph::mmc {

/// Weight of a plate at rest, which follows its design. A cell with the mass scale factor m puts
/// on each of its four nodes
///
///   f = m ρ c Δx Δy g / 4
///
/// ρ (1)  density              [kg/m^3]
/// c (1)  thickness            [m]
/// g (2)  gravity              [m/s^2]
///
/// the consistent nodal forces of a uniform body force on a bilinear rectangle.
class SelfWeight {
 public:
  /// @param outside  1 for cells outside of the domain (n_cells), which weigh nothing; empty: none
  SelfWeight(const fem::StaticSolver& solver, const Vec2& gravity,
             std::span<const signed char> outside);

  /// Adds the weight at these mass scale factors (n_cells) to every row of F (n x n_unknowns) [N].
  void add(const VectorXd& mass, MatrixXd& F) const;
  /// Returns the work of the weight of every cell of full mass on displacements u (n x n_unknowns),
  /// per load (n x n_cells) [J].
  MatrixXd work(const MatrixXd& u) const;

 private:
  Grid grid_;
  Vec2 force_;             // of a full cell on one of its nodes [N]
  std::vector<int> rows_;  // of the unknowns of the nodes (2 n_nodes); -1: held
  std::vector<signed char> outside_;
};

}  // namespace flexmorph::mmc
