#include <cmath>
#include <numbers>

#include "fem/force_elements/pair_force_element.h"
#include "geometry/text.h"

namespace flexmorph::fem {
namespace {

using Values = MarkerPair::Values;
using Square = MarkerPair::Square;
constexpr auto kPositionA = MarkerPair::kPositionA, kPositionB = MarkerPair::kPositionB;

double checked(const std::string& force_element, const std::string& what, double value,
               double least) {
  if (!(value >= least) || !std::isfinite(value))
    throw Error::input("force element '" + force_element + "': " + what + " = " +
                       std::to_string(value) +
                       formatted("; it must be a finite number of at least %g", least));
  return value;
}

/// Returns the derivatives by y of a function of d = p_b - p_a from its derivatives by d.
Values of_difference(const Vec2& by_d) {
  Values out = Values::Zero();
  out.segment<2>(kPositionA) = -by_d;
  out.segment<2>(kPositionB) = by_d;
  return out;
}
Square of_difference(const Eigen::Matrix2d& by_dd) {
  Square out = Square::Zero();
  out.block<2, 2>(kPositionA, kPositionA) = out.block<2, 2>(kPositionB, kPositionB) = by_dd;
  out.block<2, 2>(kPositionA, kPositionB) = out.block<2, 2>(kPositionB, kPositionA) = -by_dd;
  return out;
}
Vec2 difference(const Values& y) { return y.segment<2>(kPositionB) - y.segment<2>(kPositionA); }

/// Tension N = k (l - l₀) + c l̇ along the line, l̇ = e · ḋ with e = d / l:
///
///   s_d = N e = k (1 - l₀/l) d + c (e · ḋ) e,   V = ½ k (l - l₀)²
class Spring final : public PairForceElement, public MeanForceElement {
 public:
  Spring(const std::string& name, MarkerLocation a, MarkerLocation b, const SpringData& spring)
      : PairForceElement(name, std::move(a), std::move(b), {kPositionA, kPositionB}, true),
        spring_(spring) {
    checked(name, "stiffness", spring.stiffness, 0);
    checked(name, "damping", spring.damping, 0);
    checked(name, "free length", spring.free_length, 0);
  }

  std::unique_ptr<ForceElement> clone() const override { return std::make_unique<Spring>(*this); }
  /// V is a function of |d|², and d̄ · (d₁ - d₀) is half the difference of |d|². Therefore, with
  /// the lengths l_a, l_b at the start and at the end of the step, s_d = k (1 - 2 l₀/(l_a + l_b))
  /// d̄ gives s_d · (d₁ - d₀) = V₁ - V₀. The damping force is taken at the mean state.
  void add_mean_force(const State& mean, const VectorXd& q0, const VectorXd& q1,
                      VectorXd& out) const override {
    add_to(mean_force(mean, q0, q1).s, out);
  }
  void add_mean_tangent(const State& mean, const VectorXd& q0, const VectorXd& q1, const Weights& w,
                        std::vector<Eigen::Triplet<double>>& out) const override {
    const PairForce force = mean_force(mean, q0, q1);
    append(w.q * force.s_y + w.v * force.s_rate, Square::Zero(), out);
  }

  Energies energies(const State& x) const override {
    pair().evaluate(x.t, x.q, x.v);
    const double stretch = difference(pair().y()).norm() - spring_.free_length;
    return {.strain = 0.5 * spring_.stiffness * stretch * stretch};
  }

 private:
  /// Returns the mean force; s_y is its derivative by the mean state, which moves half as far as
  /// the end of the step.
  PairForce mean_force(const State& mean, const VectorXd& q0, const VectorXd& q1) const {
    if (pair().shifts()) refuse_mean_force(name());
    const auto& [k, c, free_length] = spring_;
    pair().evaluate(mean.t, q0, mean.v);
    const double l0 = difference(pair().y()).norm();
    pair().evaluate(mean.t, q1, mean.v);
    const Vec2 d1 = difference(pair().y());
    const double l1 = d1.norm();
    pair().evaluate(mean.t, mean.q, mean.v);
    const Vec2 d = difference(pair().y());
    PairForce out;
    if (c > 0) {  // the damping force alone
      const SpringData damper{0, c, 0};
      fill_spring(damper, pair().y(), pair().rate(), out);
    }
    double share = 1;
    Eigen::Matrix2d by_d = k * Eigen::Matrix2d::Identity();
    if (free_length > 0) {
      if (!(l0 + l1 > 0) || !(l1 > 0)) refuse_to_meet();
      share = 1 - 2 * free_length / (l0 + l1);
      // ∂l₁ = d₁/l₁ · ∂d₁, ∂d₁ = 2 ∂d̄.
      by_d = k * share * Eigen::Matrix2d::Identity() +
             d * (4 * k * free_length / ((l0 + l1) * (l0 + l1)) / l1 * d1).transpose();
    }
    out.s += of_difference(Vec2(k * share * d));
    out.s_y += of_difference(by_d);
    return out;
  }

  [[noreturn]] void refuse_to_meet() const {
    throw Error::numerical("spring '" + name() +
                           "': its ends coincide, so that it has no direction");
  }

  void fill(const State&, const Values& y, const Values& rate, PairForce& out) const override {
    fill_spring(spring_, y, rate, out);
  }

  void fill_spring(const SpringData& spring, const Values& y, const Values& rate,
                   PairForce& out) const {
    const auto& [k, c, free_length] = spring;
    const Vec2 d = difference(y), d_t = difference(rate);
    const Eigen::Matrix2d one = Eigen::Matrix2d::Identity();
    if (free_length == 0 && c == 0) {  // the direction of the line is not needed
      out.s = out.conservative = of_difference(Vec2(k * d));
      out.s_y = of_difference(Eigen::Matrix2d(k * one));
      return;
    }
    const double l = d.norm();
    if (!(l > 0)) refuse_to_meet();
    const Vec2 e = d / l;
    const Eigen::Matrix2d e_d = (one - e * e.transpose()) / l;
    const double pull = k * (l - free_length), rate_of_l = e.dot(d_t);
    out.conservative = of_difference(Vec2(pull * e));
    out.s = of_difference(Vec2((pull + c * rate_of_l) * e));
    out.s_y = of_difference(Eigen::Matrix2d(k * e * e.transpose() + (pull + c * rate_of_l) * e_d +
                                            c * e * (e_d * d_t).transpose()));
    out.s_rate = of_difference(Eigen::Matrix2d(c * e * e.transpose()));
  }

  SpringData spring_;
};

/// The angle θ of an axis e and its derivatives θ_e = J e / |e|² and θ_ee, with J the rotation by
/// 90 degrees.
struct Turn {
  double angle;
  Vec2 by_e;
  Eigen::Matrix2d by_ee;

  explicit Turn(const Vec2& e) {
    const double x = e.x(), y = e.y(), square = e.squaredNorm();
    angle = std::atan2(y, x);
    by_e = Vec2(-y, x) / square;
    by_ee << 2 * x * y, y * y - x * x, y * y - x * x, -2 * x * y;
    by_ee /= square * square;
  }
};

/// Moment M = k φ + c φ̇ on φ = θ_b - θ_a - φ₀; V = ½ k φ². The two axes determine θ_b - θ_a up to
/// whole turns; their number is continued from the last accepted step.
class TorsionSpring final : public PairForceElement, public TurningForceElement {
 public:
  TorsionSpring(const std::string& name, MarkerLocation a, MarkerLocation b,
                const TorsionSpringData& spring)
      : PairForceElement(name, std::move(a), std::move(b), {MarkerPair::kAxisA, MarkerPair::kAxisB},
                         true),
        spring_(spring) {
    checked(name, "stiffness", spring.stiffness, 0);
    checked(name, "damping", spring.damping, 0);
    checked(name, "rest angle", spring.rest_angle, -1e6);
  }

  std::unique_ptr<ForceElement> clone() const override {
    return std::make_unique<TorsionSpring>(*this);
  }
  Energies energies(const State& x) const override {
    const double phi = turned(x) - spring_.rest_angle;
    return {.strain = 0.5 * spring_.stiffness * phi * phi};
  }
  double turned(const State& x) const override {
    pair().evaluate(x.t, x.q, x.v);
    return angle(x, Turn(pair().y().segment<2>(MarkerPair::kAxisA)),
                 Turn(pair().y().segment<2>(MarkerPair::kAxisB)));
  }

 private:
  double angle(const State& x, const Turn& a, const Turn& b) const {
    const double last = location() < x.turned.size()
                            ? x.turned[location()]
                            : spring_.start_angle.value_or(spring_.rest_angle);
    return last + std::remainder(b.angle - a.angle - last, 2 * std::numbers::pi);
  }

  void fill(const State& x, const Values& y, const Values& rate, PairForce& out) const override {
    const Turn a(y.segment<2>(MarkerPair::kAxisA)), b(y.segment<2>(MarkerPair::kAxisB));
    Values phi_y = Values::Zero();
    phi_y.segment<2>(MarkerPair::kAxisA) = -a.by_e;
    phi_y.segment<2>(MarkerPair::kAxisB) = b.by_e;
    Square phi_yy = Square::Zero();
    phi_yy.block<2, 2>(MarkerPair::kAxisA, MarkerPair::kAxisA) = -a.by_ee;
    phi_yy.block<2, 2>(MarkerPair::kAxisB, MarkerPair::kAxisB) = b.by_ee;
    const double elastic = spring_.stiffness * (angle(x, a, b) - spring_.rest_angle);
    const double moment = elastic + spring_.damping * phi_y.dot(rate);
    out.conservative = elastic * phi_y;
    out.s = moment * phi_y;
    out.s_rate = spring_.damping * phi_y * phi_y.transpose();
    out.s_y = spring_.stiffness * phi_y * phi_y.transpose() + moment * phi_yy +
              spring_.damping * phi_y * (phi_yy * rate).transpose();
  }

  TorsionSpringData spring_;
};

}  // namespace

std::unique_ptr<ForceElement> make_spring(std::string name, MarkerLocation a, MarkerLocation b,
                                          const SpringData& spring) {
  return std::make_unique<Spring>(std::move(name), std::move(a), std::move(b), spring);
}

std::unique_ptr<ForceElement> make_torsion_spring(std::string name, MarkerLocation a,
                                                  MarkerLocation b,
                                                  const TorsionSpringData& spring) {
  return std::make_unique<TorsionSpring>(std::move(name), std::move(a), std::move(b), spring);
}

}  // namespace flexmorph::fem
