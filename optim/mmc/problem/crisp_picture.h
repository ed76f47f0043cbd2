#pragma once

#include <Eigen/SparseCore>
#include <span>

#include "geometry/components/component.h"

namespace flexmorph::mmc {

struct BodyProblem;

/// What the outlines of components enclose, cell by cell, and how it changes with the components:
/// the crisp design beside the regularized one of UnionTdf and Ersatz.
class CrispPicture {
 public:
  /// @param problem  lives longer
  explicit CrispPicture(const BodyProblem& problem) : problem_(&problem) {}

  /// Area fractions of material (n_cells), as fractions_of() samples them.
  VectorXd fractions(std::span<const Component> components) const;

  /// Area fractions of the part that the components stand for (n_cells), see part_fractions().
  VectorXd of_part(std::span<const Component> components) const;

  /// Derivatives of the area fractions by the parameters of the components (n_cells x 7 N),
  ///
  ///   ∂a_c/∂p = 1/A_c ∫ (∂φ/∂p) / |∇φ| ds
  ///
  /// a_c  area fraction of cell c [-], A_c its area [m²]
  /// φ    TDF of the component whose outline it is, which grows inwards: the integrand is the speed
  ///      at which the outline moves outwards
  ///
  /// over the part of the union's outline in cell c. Sides that borders of the domain, solid or
  /// void regions make do not move. (Shape derivative of an integral over a domain: Hadamard.)
  Eigen::SparseMatrix<double> slopes(std::span<const Component> components) const;

 private:
  const BodyProblem* problem_;
};

}  // namespace flexmorph::mmc
