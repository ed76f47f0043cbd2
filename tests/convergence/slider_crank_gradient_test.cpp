// Shows the published sensitivities of a slider-crank with a spring and a damper: the integral of
// its kinetic energy over ten seconds, and its derivatives by stiffness and damping, from the
// adjoint of a motion of rigid bodies and joints.
//
// Data and published numbers: example idasSlCrank_FSA_dns of SUNDIALS' IDAS, Hindmarsh et al.
// (2005). There angles and the slider's position are the unknowns of an index-2 form, and
// derivatives come from forward sensitivity equations.
#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <numbers>

#include "fem/dynamics/gradients/motion_gradient.h"
#include "tests/support/differences.h"
#include "tests/support/rigid_models.h"

namespace flexmorph::fem {
namespace {

/// Crank (angle q about the origin) and rod (angle p), whose end is the slider at (x, 0):
/// x = cos p + a cos q, sin p = -a sin q.
constexpr double kCrank = 0.5;       // a [m]; the rod has length 1
constexpr double kCrankInertia = 1;  // about the origin [kg m²]
constexpr double kSlider = 1;        // [kg]
constexpr double kRodInertia = 2;    // [kg m²]; the rod has no mass
constexpr double kFreeLength = 1;    // of the spring between the middles of both links [m]
constexpr double kForce = 1;         // works on x + cos p [N]
constexpr double kEnd = 10;          // from rest at q = π/2 [s]
constexpr double kStiffness = 1;     // [N/m]
constexpr double kDamping = 1;       // [N s/m]
constexpr double kPublished[] = {3.3366157997761721, 0.33346, -0.36375};  // G, dG/dk, dG/dc

/// The kinetic energy of a model as an objective.
class KineticEnergy final : public MotionMeasure {
 public:
  double value(Workspace& model, const State& x) const override {
    return model.energies(x).kinetic;
  }
  void add_gradient(Workspace& model, const State& x, double weight, StateGradient& by_state,
                    std::vector<ScaleFactorGradient>&) const override {
    // M q̇ is the change of the forces by accelerations of that size.
    State at = x;
    VectorXd with, without;
    at.a = x.v;
    model.force(at, with);
    at.a.setZero();
    model.force(at, without);
    by_state.v += weight * (with - without);
  }
};

struct SliderCrank {
  Workspace model;
  MotionSettings settings;
  std::vector<MotionObjective> objectives;

  SliderCrank(double stiffness, double damping, double step) {
    testing::add_rigid(model, "crank", {1, {0, 0}, kCrankInertia});
    // Slider and rod are one body: mass at the slider, inertia of the rod.
    testing::add_rigid(model, "rod", {kSlider, {0, 0}, kRodInertia});
    model.add_joint(make_revolute("hinge", {}, {.body = "crank"}));
    model.add_joint(make_revolute("pin", {.body = "crank", .point = {kCrank, 0}},
                                  {.body = "rod", .point = {-1, 0}}));
    model.add_joint(make_point_drive("guide", {.body = "rod"},
                                     [](double) {
                                       return std::vector<Motion>{{0, 0, 0}};
                                     },
                                     {1}));
    add_spring(model, {stiffness, damping, kFreeLength});
    // The force works on δ(x + cos p), the point of the rod's frame opposite to the pin.
    model.add_force_element(
        make_point_force("force", {.body = "rod", .point = {1, 0}}, Vec2(kForce, 0)));
    const double q = std::numbers::pi / 2, p = std::asin(-kCrank * std::sin(q));
    settings.body_poses = [=](double) {
      return std::vector<BodyPose>{
          {"crank", {.angle = q}},
          {"rod", {.origin = {std::cos(p) + kCrank * std::cos(q), 0}, .angle = p}}};
    };
    settings.end = kEnd;
    settings.step = step;
    settings.start = Start::rigid;
    settings.alpha.tolerance = 1e-14;
    objectives = {{std::make_shared<KineticEnergy>(), MotionObjective::Times::steps, 1}};
  }

  /// Returns G; objectives are means over time.
  double value() const { return kEnd * motion_values(model, {}, settings, objectives).at(0); }
  /// Returns (G, dG/dk, dG/dc).
  Vec3 gradient() const {
    const MotionGradient found =
        motion_gradients(
            model, {}, settings, objectives,
            {.checkpoints = 0,
             .parameters = {by_spring({1, 0, kFreeLength}), by_spring({0, 1, kFreeLength})}})
            .of.at(0);
    return kEnd * Vec3(found.value, found.by_parameters[0], found.by_parameters[1]);
  }

 private:
  static void add_spring(Model& to, const SpringData& data) {
    to.add_force_element(make_spring("spring", {.body = "crank", .point = {kCrank / 2, 0}},
                                     {.body = "rod", .point = {-0.5, 0}}, data));
  }
  /// Returns the derivative by one coefficient: the force is linear in k and in c, so that it is
  /// the force of a spring with this coefficient equal to one.
  ForceSlope by_spring(const SpringData& one) const {
    Model alone = model;
    add_spring(alone, one);
    return [alone, n = alone.n_dofs()](const State& x, const VectorXd& psi) {
      VectorXd force = VectorXd::Zero(n);
      alone.force_elements().back()->add_force(x, force);
      return force.dot(psi);
    };
  }
};

/// Returns G of the mechanism described by the angle of its crank alone,
///
///   I(q) q̈ + ½ I'(q) q̇² = Q,   I = J₁ + m₂ x'² + J₂ p'²,   Q = F (x' - sin p p') - N l',
///   N = k (l - l₀) + c l' q̇
///
/// by the classical Runge-Kutta method. T may be a complex type, so that an imaginary part of k or
/// c gives the derivative.
template <class T>
T energy_by_crank_angle(T k, T c, int n_steps) {
  using Three = Eigen::Matrix<T, 3, 1>;  // q, q̇, G
  const double a = kCrank;
  const auto rate = [&](const Three& y) {
    const T sq = std::sin(y[0]), cq = std::cos(y[0]), sp = -a * sq, cp = std::sqrt(1.0 - sp * sp);
    const T p1 = -a * cq / cp, p2 = (a * sq + sp * p1 * p1) / cp;
    const T x = cp + a * cq, x1 = -sp * p1 - a * sq, x2 = -cp * p1 * p1 - sp * p2 - a * cq;
    const T inertia = kCrankInertia + kSlider * x1 * x1 + kRodInertia * p1 * p1;
    const T half_rate = kSlider * x1 * x2 + kRodInertia * p1 * p2;  // ½ I'
    // From the middle of the crank to that of the rod.
    const T dx = x - 0.5 * cp - 0.5 * a * cq, dy = -0.5 * sp - 0.5 * a * sq;
    const T dx1 = x1 + 0.5 * sp * p1 + 0.5 * a * sq, dy1 = -0.5 * cp * p1 - 0.5 * a * cq;
    const T l = std::sqrt(dx * dx + dy * dy), l1 = (dx * dx1 + dy * dy1) / l;
    const T tension = k * (l - kFreeLength) + c * l1 * y[1];
    const T work = kForce * (x1 - sp * p1) - tension * l1;
    return Three(y[1], (work - half_rate * y[1] * y[1]) / inertia, 0.5 * inertia * y[1] * y[1]);
  };
  const double h = kEnd / n_steps;
  Three y(std::numbers::pi / 2, 0.0, 0.0);
  for (int i = 0; i < n_steps; ++i) {
    const Three k1 = rate(y), k2 = rate(y + 0.5 * h * k1), k3 = rate(y + 0.5 * h * k2),
                k4 = rate(y + h * k3);
    y += h / 6 * (k1 + 2.0 * k2 + 2.0 * k3 + k4);
  }
  return y[2];
}

/// Returns (G, dG/dk, dG/dc).
Vec3 by_crank_angle() {
  using Complex = std::complex<double>;
  constexpr double kSmall = 1e-30;
  const Complex by_k = energy_by_crank_angle(Complex(kStiffness, kSmall), Complex(kDamping), 20000),
                by_c = energy_by_crank_angle(Complex(kStiffness), Complex(kDamping, kSmall), 20000);
  return {by_k.real(), by_k.imag() / kSmall, by_c.imag() / kSmall};
}

// Errors of a step h are even in it, except for those of the start: extrapolation from two steps
// leaves 1e-8. The error of the published G is 2.7e-6, as its tolerances of 1e-6 permit; its
// derivatives have five digits.
TEST(SliderCrank, HasThePublishedSensitivities) {
  const Vec3 exact = by_crank_angle();
  const Vec3 coarse = SliderCrank(kStiffness, kDamping, 1.0 / 400).gradient(),
             fine = SliderCrank(kStiffness, kDamping, 1.0 / 800).gradient();
  const Vec3 limit = (4 * fine - coarse) / 3;
  for (int i = 0; i < 3; ++i) {
    EXPECT_NEAR(limit[i] / exact[i], 1, 1e-7);
    EXPECT_NEAR(limit[i] / kPublished[i], 1, i == 0 ? 1e-5 : 1e-4);
  }
}

// The adjoint is the derivative of the steps that were made, for any step size, also with force
// elements that count turns: the crank makes full revolutions.
TEST(SliderCrank, HasTheGradientThatDifferencesSay) {
  const auto make = [](double k, double c) {
    SliderCrank out(k, c, 0.02);
    out.model.add_force_element(make_torsion_spring(
        "torsion", {}, {.body = "crank"}, {.stiffness = 0.05, .damping = 0.1, .rest_angle = 1.5}));
    out.model.add_force_element(make_torque("motor", {.body = "crank"}, 2));
    return out;
  };
  SliderCrank moved = make(kStiffness, kDamping);
  const State end = integrate(moved.model, {}, moved.settings, [](const MotionStep&) {}).final;
  EXPECT_GT(end.turned[0], std::numbers::pi / 2 + 2 * std::numbers::pi);
  const Vec3 found = make(kStiffness, kDamping).gradient();
  const auto by_k = [&](double d) { return make(kStiffness + d, kDamping).value(); };
  const auto by_c = [&](double d) { return make(kStiffness, kDamping + d).value(); };
  const double dk = testing::first_difference(by_k, 3e-3),
               dc = testing::first_difference(by_c, 3e-3);
  EXPECT_EQ(found[0], by_k(0));
  EXPECT_NEAR(found[1] / dk, 1, 1e-6);
  EXPECT_NEAR(found[2] / dc, 1, 1e-6);
}

}  // namespace
}  // namespace flexmorph::fem
