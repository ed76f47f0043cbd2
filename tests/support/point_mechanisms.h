#pragma once

#include <cmath>
#include <functional>
#include <vector>

#include "fem/model/workspace.h"

/// Mechanisms of free points in the plane, for tests of joints. They use no elements or joints of
/// the library.
namespace flexmorph::testing {

/// Points of one body with two unknowns each; every "element" is one point.
class Points final : public fem::Element {
 public:
  explicit Points(MatrixXd locations)
      : Element(Kind<Points>{}, {.dim = 2,
                                 .n_shapes = 1,
                                 .n_elements = static_cast<int>(locations.rows()),
                                 .n_vectors = static_cast<int>(locations.rows())}),
        locations_(std::move(locations)) {
    for (int i = 0; i < locations_.rows(); ++i) numbers_.push_back(i);
  }
  std::unique_ptr<fem::Element> clone() const override { return std::make_unique<Points>(*this); }
  std::span<const int> vectors(int e) const override { return {numbers_.data() + e, size_t{1}}; }
  double scale(int) const override { return 1; }
  bool is_position(int) const override { return true; }
  MatrixXd reference() const override { return locations_; }

 private:
  MatrixXd locations_;
  std::vector<int> numbers_;
};

/// A mass for every point [kg].
class PointMasses final : public fem::Term {
 public:
  explicit PointMasses(VectorXd masses) : masses_(std::move(masses)) {}
  std::unique_ptr<fem::Term> clone() const override { return std::make_unique<PointMasses>(*this); }
  void prepare(const fem::Element&, const fem::ScaleFactors&, bool) override {}
  void add_force(int e, const fem::Local& x, fem::LocalRows& force) const override {
    force += masses_[e] * x.a;
  }
  void add_tangent(int e, const fem::Local&, const fem::Weights& w,
                   fem::LocalTangent& tangent) const override {
    tangent.diagonal().array() += w.a * masses_[e];
  }

 private:
  VectorXd masses_;
};

/// Returns a constant time function with its rates.
using Course = std::function<fem::Motion(double)>;
inline Course constant(double value) {
  return [value](double) { return fem::Motion{value, 0, 0}; };
}
inline Course linear(double value, double rate) {
  return [value, rate](double t) { return fem::Motion{value + rate * t, rate, 0}; };
}

/// A joint on numbered points of the body "points".
class PointJoint : public fem::Joint {
 public:
  explicit PointJoint(std::string name) : name_(std::move(name)) {}
  std::string name() const override { return name_; }
  int size() const override { return 1; }
  void bind(std::span<const fem::BodyView> bodies) override {
    first_ = fem::find_body(bodies, name_, "points").first_dof;
  }

 protected:
  int dof(int point, int c) const { return first_ + 2 * point + c; }
  Vec2 at(const VectorXd& x, int point) const { return x.segment<2>(dof(point, 0)); }
  static void row(fem::ConstraintRows& rows, double value, double rate, double acceleration) {
    rows.value = VectorXd::Constant(1, value);
    rows.rate = VectorXd::Constant(1, rate);
    rows.acceleration = VectorXd::Constant(1, acceleration);
    rows.jacobian.clear();
  }

 private:
  std::string name_;
  int first_ = 0;
};

/// Constraint Φ = ½ (|x_a - x_b|² - L²) with L as a function of time; b = -1: x_b is a point of the
/// ground.
class Rod final : public PointJoint {
 public:
  Rod(std::string name, int a, int b, Course length, Vec2 ground = {0, 0})
      : PointJoint(std::move(name)), a_(a), b_(b), length_(std::move(length)), ground_(ground) {}
  std::unique_ptr<fem::Joint> clone() const override { return std::make_unique<Rod>(*this); }
  void evaluate(double t, const VectorXd& q, const VectorXd& v,
                fem::ConstraintRows& rows) const override {
    const fem::Motion l = length_(t);
    const Vec2 d = at(q, a_) - (b_ < 0 ? ground_ : at(q, b_));
    const Vec2 d_t = at(v, a_) - (b_ < 0 ? Vec2(0, 0) : at(v, b_));
    row(rows, 0.5 * (d.squaredNorm() - l.value * l.value), -l.value * l.rate,
        l.rate * l.rate + l.value * l.acceleration - d_t.squaredNorm());
    for (int c = 0; c < 2; ++c) {
      rows.jacobian.emplace_back(0, dof(a_, c), d[c]);
      if (b_ >= 0) rows.jacobian.emplace_back(0, dof(b_, c), -d[c]);
    }
  }

 private:
  int a_, b_;
  Course length_;
  Vec2 ground_;
};

/// The line from the origin to a point has a prescribed angle: Φ = y cos α - x sin α.
class AngleDrive final : public PointJoint {
 public:
  AngleDrive(std::string name, int point, Course angle)
      : PointJoint(std::move(name)), point_(point), angle_(std::move(angle)) {}
  std::unique_ptr<fem::Joint> clone() const override { return std::make_unique<AngleDrive>(*this); }
  void evaluate(double t, const VectorXd& q, const VectorXd& v,
                fem::ConstraintRows& rows) const override {
    const fem::Motion a = angle_(t);
    const Vec2 e(std::cos(a.value), std::sin(a.value)), n(-e.y(), e.x());
    const Vec2 x = at(q, point_), x_t = at(v, point_);
    row(rows, n.dot(x), -a.rate * e.dot(x),
        a.acceleration * e.dot(x) + a.rate * a.rate * n.dot(x) + 2 * a.rate * e.dot(x_t));
    for (int c = 0; c < 2; ++c) rows.jacobian.emplace_back(0, dof(point_, c), n[c]);
  }

 private:
  int point_;
  Course angle_;
};

/// The constraint Σ w_i x_i = value(t) over single unknowns (point, component, weight).
class LinearRow final : public PointJoint {
 public:
  struct Part {
    int point, component;
    double weight = 1;
  };
  LinearRow(std::string name, std::vector<Part> parts, Course value)
      : PointJoint(std::move(name)), parts_(std::move(parts)), value_(std::move(value)) {}
  std::unique_ptr<fem::Joint> clone() const override { return std::make_unique<LinearRow>(*this); }
  void evaluate(double t, const VectorXd& q, const VectorXd&,
                fem::ConstraintRows& rows) const override {
    const fem::Motion m = value_(t);
    row(rows, -m.value, -m.rate, m.acceleration);
    for (const Part& p : parts_) {
      rows.value[0] += p.weight * q[dof(p.point, p.component)];
      rows.jacobian.emplace_back(0, dof(p.point, p.component), p.weight);
    }
  }

 private:
  std::vector<Part> parts_;
  Course value_;
};

inline MatrixXd locations(const std::vector<Vec2>& points) {
  MatrixXd out(points.size(), 2);
  for (size_t i = 0; i < points.size(); ++i)
    out.row(static_cast<Eigen::Index>(i)) = points[i].transpose();
  return out;
}

inline fem::Workspace point_model(const MatrixXd& locations, const VectorXd& masses) {
  fem::Workspace model;
  std::vector<std::unique_ptr<fem::Term>> terms;
  terms.push_back(std::make_unique<PointMasses>(masses));
  model.add_body("points", std::make_unique<Points>(locations), {}, std::move(terms));
  return model;
}
inline fem::Workspace point_model(const MatrixXd& locations) {
  return point_model(locations, VectorXd::Ones(locations.rows()));
}

template <class J, class... Arguments>
void add(fem::Workspace& model, Arguments&&... arguments) {
  model.add_joint(std::make_unique<J>(std::forward<Arguments>(arguments)...));
}

/// Crank OA of length r about the origin, coupler AB of length l, rocker BC of length s about
/// C = (g, 0): points 0 = A and 1 = B.
struct FourBar {
  double r = 0.2, l = 0.5, s = 0.4, g = 0.45;

  Vec2 crank_pin(double angle) const { return r * Vec2(std::cos(angle), std::sin(angle)); }
  /// Returns B on the left of the line from A to C; NaN if the rods are too short.
  Vec2 rocker_pin(double angle) const {
    const Vec2 a = crank_pin(angle), to_c = Vec2(g, 0) - a;
    const double d = to_c.norm(), along = (l * l - s * s + d * d) / (2 * d);
    return a + (along * to_c + std::sqrt(l * l - along * along) * Vec2(-to_c.y(), to_c.x())) / d;
  }
  VectorXd locations(double angle) const {
    const Vec2 a = crank_pin(angle), b = rocker_pin(angle);
    VectorXd q(4);
    for (int c = 0; c < 2; ++c) {
      q[c] = a[c];
      q[2 + c] = b[c];
    }
    return q;
  }
  /// Returns the angle at which coupler and rocker form one straight line.
  double limit_angle() const {
    return std::acos((r * r + g * g - (l + s) * (l + s)) / (2 * r * g));
  }
  fem::Workspace model(const Course& angle) const {
    const VectorXd q = locations(angle(0).value);
    MatrixXd rows(2, 2);
    rows << q[0], q[1], q[2], q[3];
    fem::Workspace out = point_model(rows, Vec2(1, 3));
    add<Rod>(out, "crank", 0, -1, constant(r));
    add<AngleDrive>(out, "motor", 0, angle);
    add<Rod>(out, "coupler", 0, 1, constant(l));
    add<Rod>(out, "rocker", 1, -1, constant(s), Vec2(g, 0));
    return out;
  }
};

}  // namespace flexmorph::testing
