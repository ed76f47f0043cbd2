#pragma once

#include "fem/model/workspace.h"

/// Models whose drives stand still.
namespace flexmorph::testing {

/// A joint at a fixed time: its drive stands still.
class LockedJoint final : public fem::Joint {
 public:
  LockedJoint(std::unique_ptr<fem::Joint> joint, double t) : joint_(std::move(joint)), t_(t) {}
  std::unique_ptr<fem::Joint> clone() const override {
    return std::make_unique<LockedJoint>(joint_->clone(), t_);
  }
  std::string name() const override { return joint_->name(); }
  int size() const override { return joint_->size(); }
  bool belongs_to_body() const override { return joint_->belongs_to_body(); }
  void bind(std::span<const fem::BodyView> bodies) override { joint_->bind(bodies); }
  /// The acceleration is a quadratic polynomial of v, of which only the quadratic part remains.
  void evaluate(double, const VectorXd& q, const VectorXd& v,
                fem::ConstraintRows& rows) const override {
    fem::ConstraintRows back, still;
    joint_->evaluate(t_, q, -v, back);
    joint_->evaluate(t_, q, VectorXd::Zero(v.size()), still);
    joint_->evaluate(t_, q, v, rows);
    rows.acceleration = 0.5 * (rows.acceleration + back.acceleration) - still.acceleration;
    rows.rate.setZero();
  }
  void add_stiffness(double, const VectorXd& q, const VectorXd& lambda,
                     std::vector<Eigen::Triplet<double>>& out) const override {
    joint_->add_stiffness(t_, q, lambda, out);
  }

 private:
  std::unique_ptr<fem::Joint> joint_;
  double t_;
};

/// A copy of a model with all joints at a fixed time.
class LockedModel : public fem::Model {
 public:
  LockedModel(const fem::Model& model, double t) : Model(model) {
    for (auto& joint : joints_) joint = std::make_unique<LockedJoint>(std::move(joint), t);
    for (auto& joint : joints_) joint->bind(views());
  }
};

/// Returns the frequency of an oscillation from its first and last zero with rising sign [Hz]; 0
/// with fewer than two of them.
inline double frequency_of_zeros(const std::vector<double>& t, const std::vector<double>& y) {
  double first = 0, last = 0;
  int zeros = 0;
  for (size_t k = 1; k < t.size(); ++k) {
    if (!(y[k - 1] < 0 && y[k] >= 0)) continue;
    last = t[k] - (t[k] - t[k - 1]) * y[k] / (y[k] - y[k - 1]);
    if (zeros++ == 0) first = last;
  }
  return zeros < 2 ? 0 : (zeros - 1) / (last - first);
}

}  // namespace flexmorph::testing
