#pragma once

#include "fem/model/workspace.h"

namespace flexmorph::fem {

/// Constraint rows of all joints with columns scaled to displacements and rows to unit size:
///
///   J = R Φ_q S⁻¹,   S = diag(Model::scales()),   R_i = 1 / max over bodies |(Φ_q S⁻¹)_i of the
///   body|,
///
/// so that R Φ is the violation of a constraint as a displacement [m], in whatever unit its row is
/// written. A row of zeros keeps R_i = 1.
class ScaledConstraints {
 public:
  /// Rows that are evaluated: without those that the model leaves out, which are zero
  /// (Model::leave_out()), or all.
  enum class Rows { kept, all };
  /// Evaluates the constraints at a state and scales them.
  /// @throws Error (numerical) naming the joint when Φ or Φ_q contain numbers that are not finite.
  void evaluate(Workspace& model, const State& x, Rows which = Rows::kept);

  /// Returns the constraint rows before scaling.
  const Constraints& unscaled() const { return c_; }
  /// Returns the scale R of the rows (m).
  const VectorXd& row_scale() const { return row_scale_; }
  /// Returns the scale S of the unknowns (n).
  const VectorXd& scales() const { return scales_; }
  /// Returns J (m x n); its pattern changes only when that of the model does.
  const SparseMatrix& jacobian() const { return jacobian_; }
  /// Returns the violation R Φ of every row (m) [m].
  VectorXd misses() const { return row_scale_.cwiseProduct(c_.value); }

 private:
  Constraints c_;
  VectorXd row_scale_, scales_, of_body_;
  SparseMatrix jacobian_;
  std::vector<Eigen::Triplet<double>> scaled_;
  std::vector<int> body_of_dof_;
  int version_ = -1;
};

/// Returns the number of the joint that row i of Φ belongs to.
int joint_of_row(const Model& model, int row);

/// Returns a text such as "joint 'a'" or "joints 'a', 'b'", with at most five names.
std::string list_joints(const std::vector<std::string>& names);

/// Returns the weights of the rows (m) with zeros for joints that belong to a body, or unchanged if
/// all others are zero.
VectorXd weights_of_joints(const Model& model, VectorXd weights);

/// Returns the names of joints by the weight of their rows (m), see weights_of_joints(), the
/// heaviest first. The list contains joints whose heaviest row has at least the fraction `least` of
/// the weight of the heaviest row of all.
std::vector<std::string> heaviest_joints(const Model& model, const VectorXd& weights, double least);

/// Returns a length of the model, the largest of its scaled unknowns S q [m]; 1 if all are 0.
double model_size(const VectorXd& scales, const VectorXd& q);

/// Returns the largest coordinate of the undeformed model in the frames of its bodies [m]; for a
/// model of rigid bodies alone model_size() of its reference.
double undeformed_size(const Model& model, const VectorXd& scales);

}  // namespace flexmorph::fem
