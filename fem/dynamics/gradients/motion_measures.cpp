#include "fem/dynamics/gradients/motion_measures.h"

#include "fem/dynamics/mesh_changes/moving_root.h"

namespace flexmorph::fem {
namespace {

class StrainEnergy final : public MotionMeasure {
 public:
  double value(Workspace& model, const State& x) const override {
    return 2 * model.strain_energy(x);
  }
  void add_gradient(Workspace& model, const State& x, double weight, StateGradient& by_state,
                    std::vector<ScaleFactorGradient>& d_factors) const override {
    model.add_strain_energy_gradient(x, 2 * weight, by_state.q, d_factors);
  }
};

/// Returns d / |d|, or zero for d = 0.
Vec2 direction(const Vec2& d) {
  const double size = d.norm();
  return size > 0 ? Vec2(d / size) : Vec2(0, 0);
}

class Deflection final : public MotionMeasure {
 public:
  Deflection(std::string body, const Vec2& material, DrivenFrame driven_frame, int line)
      : body_(std::move(body)),
        material_(material),
        driven_frame_(std::move(driven_frame)),
        line_(line) {}

  double value(Workspace& model, const State& x) const override {
    model.prepare(x);
    return difference(model, x).norm();
  }
  void add_gradient(Workspace& model, const State& x, double weight, StateGradient& by_state,
                    std::vector<ScaleFactorGradient>&) const override {
    model.prepare(x);
    const Vec2 pull = weight * direction(difference(model, x));
    const Body& body = model.body(body_);
    ShapeTable t;
    const auto vectors =
        body.element->vectors(body.element->locate(material_, Tabulate::position, t));
    for (size_t k = 0; k < vectors.size(); ++k)
      by_state.q.segment<2>(body.first_dof + 2 * vectors[k]) +=
          t.N(0, static_cast<Eigen::Index>(k)) * pull;
    if (driven_frame_.body().empty()) return;
    // The point o + R p of the carrier is r_b + arm.x u + arm.y v, v = u rotated by 90 degrees,
    // which is linear in r_b and u.
    const int r = model.body(driven_frame_.body()).first_dof;
    const Vec2 arm = driven_frame_.point() + rotation(driven_frame_.angle()) * in_frame(model);
    by_state.q.segment<2>(r) -= pull;
    by_state.q.segment<2>(r + 2) -=
        Vec2(arm.x() * pull.x() + arm.y() * pull.y(), arm.x() * pull.y() - arm.y() * pull.x());
  }

 private:
  Vec2 in_frame(const Model& model) const {
    return {material_.x() - grid_of(model.body(body_)).line_m(line_).value, material_.y()};
  }
  Vec2 difference(const Workspace& model, const State& x) const {
    const Vec2 at = point_position(model.body(body_), x, material_).head<2>();
    if (driven_frame_.body().empty()) {
      const FrameMotion f = driven_frame_.drive()(x.t);
      return at - f.origin - rotation(f.angle) * in_frame(model);
    }
    const int r = model.body(driven_frame_.body()).first_dof;
    const Vec2 arm = driven_frame_.point() + rotation(driven_frame_.angle()) * in_frame(model),
               u = x.q.segment<2>(r + 2);
    return at - x.q.segment<2>(r) - arm.x() * u - arm.y() * Vec2(-u.y(), u.x());
  }

  std::string body_;
  Vec2 material_;
  DrivenFrame driven_frame_;
  int line_;
};

class LocationError final : public MotionMeasure {
 public:
  LocationError(std::string body, std::array<std::function<Motion(double)>, 2> path)
      : body_(std::move(body)), path_(std::move(path)) {}
  double value(Workspace& model, const State& x) const override {
    return difference(model, x).norm();
  }
  void add_gradient(Workspace& model, const State& x, double weight, StateGradient& by_state,
                    std::vector<ScaleFactorGradient>&) const override {
    by_state.q.segment<2>(model.body(body_).first_dof) += weight * direction(difference(model, x));
  }

 private:
  Vec2 difference(const Workspace& model, const State& x) const {
    return x.q.segment<2>(model.body(body_).first_dof) -
           Vec2(path_[0](x.t).value, path_[1](x.t).value);
  }
  std::string body_;
  std::array<std::function<Motion(double)>, 2> path_;
};

/// The force f = -E Φ_qᵀ λ of a joint; the two rows of E are translations of the body along x and
/// y.
class JointForce final : public MotionMeasure {
 public:
  JointForce(std::string joint, std::string body)
      : joint_(std::move(joint)), body_(std::move(body)) {}
  double value(Workspace& model, const State& x) const override { return force(model, x).norm(); }
  void add_gradient(Workspace& model, const State& x, double weight, StateGradient& by_state,
                    std::vector<ScaleFactorGradient>&) const override {
    const Vec2 pull = -weight * direction(force(model, x));
    const VectorXd along = shift(model, pull);
    const auto [first, last] = rows(model);
    Constraints c;
    model.constraints(x, c);
    VectorXd own = VectorXd::Zero(x.lambda.size());
    own.segment(first, last - first) = x.lambda.segment(first, last - first);
    for (const auto& entry : c.jacobian)
      if (entry.row() >= first && entry.row() < last)
        by_state.lambda[entry.row()] += entry.value() * along[entry.col()];
    by_state.q += model.constraint_curvature(x, own, along);
  }

 private:
  std::pair<int, int> rows(const Model& model) const {
    const auto& all = model.joints();
    for (size_t i = 0; i < all.size(); ++i)
      if (all[i]->name() == joint_) return {model.first_row(i), model.first_row(i + 1)};
    throw Error::input("there is no joint '" + joint_ + "'");
  }
  /// Returns the virtual displacement of a translation of the body (n_dofs).
  VectorXd shift(const Model& model, const Vec2& by) const {
    const Body& body = model.body(body_);
    VectorXd out = VectorXd::Zero(model.n_dofs());
    for (int k = 0; k < body.element->n_vectors(); ++k)
      if (body.element->is_position(k))
        out.segment<2>(body.first_dof + body.element->dim() * k) = by;
    return out;
  }
  Vec2 force(Workspace& model, const State& x) const {
    const auto [first, last] = rows(model);
    Constraints c;
    model.constraints(x, c);
    const Body& body = model.body(body_);
    Vec2 out(0, 0);
    std::vector<int> axis(static_cast<size_t>(model.n_dofs()), -1);
    for (int k = 0; k < body.element->n_vectors(); ++k)
      for (int d = 0; d < 2 && body.element->is_position(k); ++d)
        axis[static_cast<size_t>(body.first_dof + body.element->dim() * k + d)] = d;
    for (const auto& entry : c.jacobian)
      if (entry.row() >= first && entry.row() < last)
        if (const int d = axis[static_cast<size_t>(entry.col())]; d >= 0)
          out[d] -= entry.value() * x.lambda[entry.row()];
    return out;
  }

  std::string joint_, body_;
};

}  // namespace

std::shared_ptr<const MotionMeasure> measure_strain_energy() {
  return std::make_shared<StrainEnergy>();
}
std::shared_ptr<const MotionMeasure> measure_deflection(std::string body, const Vec2& material,
                                                        DrivenFrame driven_frame, int line) {
  return std::make_shared<Deflection>(std::move(body), material, std::move(driven_frame), line);
}
std::shared_ptr<const MotionMeasure> measure_location_error(
    std::string body, std::array<std::function<Motion(double)>, 2> path) {
  return std::make_shared<LocationError>(std::move(body), std::move(path));
}
std::shared_ptr<const MotionMeasure> measure_joint_force(std::string joint, std::string body) {
  return std::make_shared<JointForce>(std::move(joint), std::move(body));
}

}  // namespace flexmorph::fem
