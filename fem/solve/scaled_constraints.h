#pragma once

#include "fem/model/workspace.h"

namespace flexmorph::fem {

/// Rows of all joints with columns scaled to displacements and rows to unit size:
///
///   J = R Φ_q S⁻¹,   S = diag(Model::scales()),   R_i = 1 / max over bodies |(Φ_q S⁻¹)_i of the
///   body|,
///
/// so that R Φ is what a joint misses by, as a displacement [m], whatever the unit of its row.
/// A row of zeros keeps R_i = 1.
class ScaledConstraints {
 public:
  /// @throws Error (numerical) naming the joint when Φ or Φ_q hold numbers that are not finite.
  void evaluate(Workspace& model, const State& x);

  const Constraints& unscaled() const { return c_; }
  const VectorXd& row_scale() const { return row_scale_; }  ///< R (m)
  const VectorXd& scales() const { return scales_; }        ///< S (n)
  /// J (m x n), in a pattern that stays until the model's does.
  const SparseMatrix& jacobian() const { return jacobian_; }
  VectorXd misses() const { return row_scale_.cwiseProduct(c_.value); }  ///< R Φ (m) [m]

 private:
  Constraints c_;
  VectorXd row_scale_, scales_, of_body_;
  SparseMatrix jacobian_;
  std::vector<Eigen::Triplet<double>> scaled_;
  std::vector<int> body_of_dof_;
  int version_ = -1;
};

/// Number of the joint that row i of Φ belongs to.
int joint_of_row(const Model& model, int row);

/// "joint 'a'" or "joints 'a', 'b'"; the first five of many.
std::string list_joints(const std::vector<std::string>& names);

/// The weights (m) of rows, those of joints that belong to a body set to zero (unless then all
/// are).
VectorXd weights_of_joints(const Model& model, VectorXd weights);

/// Joints by the weight of their rows (m), heaviest first, as far as the weight of a joint's
/// heaviest row is above the part `least` of the heaviest of all; of weights_of_joints().
std::vector<std::string> heaviest_joints(const Model& model, const VectorXd& weights, double least);

/// A length of the model: its largest position or displacement-scaled unknown, 1 when all are 0
/// [m].
double model_size(const VectorXd& scales, const VectorXd& q);

/// Largest coordinate of the undeformed model in its own frames; of rigid bodies alone their
/// largest length; 1 where there is neither [m].
double undeformed_size(const Model& model, const VectorXd& scales);

}  // namespace flexmorph::fem
