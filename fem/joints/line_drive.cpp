#include "fem/joint.h"

namespace flexmorph::fem {
namespace {

class LineDrive final : public Joint {
 public:
  LineDrive(std::string name, std::string body, int scalar, std::function<Motion(double)> motion)
      : name_(std::move(name)),
        body_(std::move(body)),
        scalar_(scalar),
        motion_(std::move(motion)) {}

  std::unique_ptr<Joint> clone() const override { return std::make_unique<LineDrive>(*this); }
  std::string name() const override { return name_; }
  int size() const override { return 1; }

  void bind(std::span<const BodyView> bodies) override {
    const BodyView& body = find_body(bodies, name_, body_);
    if (scalar_ < 0 || scalar_ >= body.element->n_scalars())
      throw Error::input("joint '" + name_ + "': line " + std::to_string(scalar_) +
                         " does not exist; the material coordinates of " +
                         std::to_string(body.element->n_scalars()) + " lines of body '" + body_ +
                         "' are unknowns");
    dof_ = body.first_dof + body.element->dim() * body.element->n_vectors() + scalar_;
  }

  void evaluate(double t, const VectorXd& q, const VectorXd&, ConstraintRows& rows) const override {
    const Motion motion = motion_(t);
    rows.value = VectorXd::Constant(1, q[dof_] - motion.value);
    rows.rate = VectorXd::Constant(1, -motion.rate);
    rows.acceleration = VectorXd::Constant(1, motion.acceleration);
    rows.jacobian.clear();
    rows.jacobian.emplace_back(0, dof_, 1.0);
  }

 private:
  std::string name_, body_;
  int scalar_, dof_ = 0;
  std::function<Motion(double)> motion_;
};

}  // namespace

std::unique_ptr<Joint> make_line_drive(std::string name, std::string body, int scalar,
                                       std::function<Motion(double)> motion) {
  return std::make_unique<LineDrive>(std::move(name), std::move(body), scalar, std::move(motion));
}

}  // namespace flexmorph::fem
