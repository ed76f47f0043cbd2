#pragma once

#include <Eigen/SparseCore>
#include <span>

#include "geometry/components/component.h"

namespace flexmorph::mmc {

struct BodyProblem;

/// The crisp design: area fractions of the material that the outlines of components enclose in each
/// cell, and their derivatives. UnionTdf and Ersatz describe the regularized design instead.
class CrispPicture {
 public:
  /// Creates the crisp view of the designs of a body.
  /// @param problem  must live longer
  explicit CrispPicture(const BodyProblem& problem) : problem_(&problem) {}

  /// Returns the area fractions of material (n_cells), sampled by fractions_of().
  VectorXd fractions(std::span<const Component> components) const;

  /// Returns the area fractions of the finished part of the components (n_cells), see
  /// part_fractions().
  VectorXd of_part(std::span<const Component> components) const;

  /// Returns the derivatives of the area fractions by the component parameters (n_cells x 7 N),
  ///
  ///   ∂a_c/∂p = 1/A_c ∫ (∂φ/∂p) / |∇φ| ds
  ///
  /// a_c  area fraction of cell c [-], A_c its area [m²]
  /// φ    TDF of the component that the outline belongs to. φ increases inwards; therefore the
  ///      integrand is the speed at which the outline moves outwards
  ///
  /// where the integral extends over the outline of the union within cell c. Sides on borders of
  /// the domain and of solid or void regions do not move. (Hadamard's shape derivative of an
  /// integral over a domain.)
  Eigen::SparseMatrix<double> slopes(std::span<const Component> components) const;

 private:
  const BodyProblem* problem_;
};

}  // namespace flexmorph::mmc
