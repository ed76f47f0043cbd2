#pragma once

#include <cmath>
#include <memory>
#include <vector>

#include "fem/loads.h"
#include "fem/model/workspace.h"
#include "tests/support/disturbance.h"

/// A pendulum in Cartesian coordinates (index 3) whose motion is known: one point on a rod.
namespace flexmorph::testing {

inline constexpr double kLength = 1, kGravity = 9.81, kMass = 2;

/// A body of one point, whose position r is the vector of unknowns q.
class Particle final : public fem::Element, public fem::ShapeElement {
 public:
  Particle()
      : Element(Kind<Particle>{}, {.dim = 2, .n_shapes = 1, .n_elements = 1, .n_vectors = 1}) {}
  std::unique_ptr<fem::Element> clone() const override { return std::make_unique<Particle>(*this); }
  std::span<const int> vectors(int) const override { return {&zero_, 1}; }
  double scale(int) const override { return 1; }
  bool is_position(int) const override { return true; }
  MatrixXd reference() const override { return Eigen::RowVector2d(0, -kLength); }
  std::vector<fem::NodeVectors> edge(const std::string&) const override {
    return {{0, -1, -1, -1, {0, 0}}};
  }
  std::vector<fem::NodeVectors> nodes() const override { return {}; }
  std::array<std::vector<double>, 2> lines() const override { return {}; }
  void tabulate(int, int, fem::Tabulate, const fem::ScaleFactors&, fem::ScaleFactorKind,
                fem::ShapeTable& out) const override {
    out.weight = VectorXd::Ones(1);
    out.material = {Vec2::Zero()};
    out.N = MatrixXd::Ones(1, 1);
    for (MatrixXd* none : {&out.N_t, &out.N_tt, &out.N_m, &out.N_n, &out.N_mt, &out.N_nt})
      none->resize(0, 0);
  }
  int locate(const Vec2&, fem::Tabulate what, fem::ShapeTable& out) const override {
    tabulate(0, 0, what, {}, fem::ScaleFactorKind::none, out);
    return 0;
  }

 private:
  int zero_ = 0;
};

/// The constraint (|r|² - L²) / 2 = 0.
class Rod final : public fem::Joint {
 public:
  explicit Rod(bool exact_tangent) : exact_tangent_(exact_tangent) {}
  std::unique_ptr<fem::Joint> clone() const override { return std::make_unique<Rod>(*this); }
  std::string name() const override { return "rod"; }
  int size() const override { return 1; }
  void bind(std::span<const fem::BodyView> bodies) override {
    first_ = fem::find_body(bodies, name(), "bob").first_dof;
  }
  void evaluate(double, const VectorXd& q, const VectorXd& v,
                fem::ConstraintRows& rows) const override {
    const auto r = q.segment<2>(first_), r_t = v.segment<2>(first_);
    rows.value = VectorXd::Constant(1, (r.squaredNorm() - kLength * kLength) / 2);
    rows.rate = VectorXd::Zero(1);
    rows.acceleration = VectorXd::Constant(1, -r_t.squaredNorm());
    rows.jacobian.clear();
    for (int c = 0; c < 2; ++c) rows.jacobian.emplace_back(0, first_ + c, r[c]);
  }
  void add_stiffness(double, const VectorXd&, const VectorXd& lambda,
                     std::vector<Eigen::Triplet<double>>& out) const override {
    if (exact_tangent_)
      for (int c = 0; c < 2; ++c) out.emplace_back(first_ + c, first_ + c, lambda[0]);
  }

 private:
  bool exact_tangent_;
  int first_ = 0;
};

struct Swing {
  double angle, rate;
  Vec2 position() const { return kLength * Vec2(std::sin(angle), -std::cos(angle)); }
  Vec2 velocity() const { return kLength * rate * Vec2(std::cos(angle), std::sin(angle)); }
  /// Returns the multiplier along r from λ L² = m |v|² + m g L cos(angle); λ > 0 pulls the point
  /// towards the origin.
  double lambda() const { return kMass * (rate * rate + kGravity / kLength * std::cos(angle)); }
};

/// Returns the solution of θ'' = -g/L sin θ by Runge-Kutta steps of 1e-5 s; its error (1e-5)^4 is
/// negligible.
inline Swing exact_swing(double t) {
  static std::vector<Swing> table = {{1.0, 0.8}};
  constexpr double h = 1e-5;
  const auto rate = [](const Swing& s) {
    return Swing{s.rate, -kGravity / kLength * std::sin(s.angle)};
  };
  const auto moved = [](const Swing& s, double by, const Swing& d) {
    return Swing{s.angle + by * d.angle, s.rate + by * d.rate};
  };
  const auto index = static_cast<size_t>(std::lround(t / h));
  while (table.size() <= index) {
    const Swing s = table.back();
    const Swing k1 = rate(s), k2 = rate(moved(s, h / 2, k1)), k3 = rate(moved(s, h / 2, k2)),
                k4 = rate(moved(s, h, k3));
    table.push_back({s.angle + h / 6 * (k1.angle + 2 * k2.angle + 2 * k3.angle + k4.angle),
                     s.rate + h / 6 * (k1.rate + 2 * k2.rate + 2 * k3.rate + k4.rate)});
  }
  return table[index];
}

/// The model and its state at time 0 without accelerations and multipliers.
inline fem::Workspace particle_pendulum(bool exact_tangent = true) {
  fem::Workspace model;
  std::vector<std::unique_ptr<fem::Term>> terms;
  terms.push_back(fem::make_point_mass(kMass, {0, 0}, Vec2(0, -kGravity)));
  model.add_body("bob", std::make_unique<Particle>(), {}, std::move(terms));
  model.add_joint(std::make_unique<Rod>(exact_tangent));
  return model;
}
inline fem::State swing_start(const fem::Model& model) {
  fem::State x = model.reference();
  x.q.head<2>() = exact_swing(0).position();
  x.v.head<2>() = disturbed(1.0) * exact_swing(0).velocity();
  return x;
}

}  // namespace flexmorph::testing
