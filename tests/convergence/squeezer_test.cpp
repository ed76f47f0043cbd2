// Shows that Andrews' squeezing mechanism, seven rigid bodies with one degree of freedom, driven by
// a motor against a spring, converges with order 2 of generalized-alpha to a published reference
// solution.
//
// Data and reference: Hairer & Wanner (1996), Solving Ordinary Differential Equations II, VII.7,
// and the Test Set for IVP Solvers (Mazzia & Magherini 2008), problem "andrews". Some of the angles
// there are relative: here every body has its own frame.
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <array>
#include <cmath>
#include <iostream>
#include <numbers>

#include "fem/dynamics/integrators/generalized_alpha.h"
#include "fem/dynamics/integrators/minimal_coordinates.h"
#include "tests/support/rates.h"
#include "tests/support/rigid_models.h"

namespace flexmorph::fem {
namespace {

/// The generalized coordinates of the test set [rad].
struct Angles {
  double beta, theta, gamma, phi, delta, omega, epsilon;

  /// Returns the angles of the frames of bodies 1 to 7.
  std::array<double, 7> frames() const {
    return {beta, beta + theta, gamma, phi + delta, delta, omega + epsilon, epsilon};
  }
};

constexpr Angles kStart = {-0.0617138900142764496358948458001, 0,
                           0.455279819163070380255912382449,   0.222668390165885884674473185609,
                           0.487364979543842550225598953530,   -0.222668390165885884674473185609,
                           1.23054744454982119249735015568};
constexpr Angles kEnd = {15.81077119629904,   -15.75637105984298, 0.04082224013073101,
                         -0.5347301163226948, 0.5244099658805304, 0.5347301163226948,
                         1.048080741042263};  // at 0.03 s

const Vec2 kA(-0.06934, -0.00227), kB(-0.03635, 0.03273), kC(0.014, 0.072);
constexpr double kRr = 0.007, kRa = 0.00092, kD = 0.028, kDa = 0.0115, kE = 0.02, kEa = 0.01421,
                 kZf = 0.02, kFa = 0.01421, kU = 0.04, kUa = 0.01228, kUb = 0.00449, kSs = 0.035,
                 kSa = 0.01874, kSb = 0.01043, kSc = 0.018, kSd = 0.02, kZt = 0.04, kTa = 0.02308,
                 kTb = 0.00916;

std::string name(int body) { return std::string("K").append(std::to_string(body)); }
MarkerLocation on(int body, const Vec2& point = {0, 0}) {
  return {.body = name(body), .point = point};
}

/// Points of the bodies in their frames: bodies 2, 3, 4 and 6 meet in F.
const Vec2 kF2(-kD, 0), kF3(0, -kSs), kF4(0, -kE), kF6(kZf, 0), kD3(kSd, -kSc), kE5(kZt, 0),
    kH7(0, -kU);

Workspace squeezer() {
  const RigidSection sections[7] = {
      {0.04325, {kRa, 0}, 2.194e-6},    {0.00365, {-kDa, 0}, 4.410e-7},
      {0.02373, {kSb, -kSa}, 5.255e-6}, {0.00706, {0, -(kE - kEa)}, 5.667e-7},
      {0.07050, {kTb, -kTa}, 1.169e-5}, {0.00706, {kZf - kFa, 0}, 5.667e-7},
      {0.05498, {kUb, -kUa}, 1.912e-5}};
  Workspace model;
  for (int k = 1; k <= 7; ++k) testing::add_rigid(model, name(k), sections[k - 1]);
  model.add_joint(make_revolute("O", {}, on(1)));
  model.add_joint(make_revolute("crank", on(1, {kRr, 0}), on(2)));
  model.add_joint(make_revolute("B", {.point = kB}, on(3)));
  model.add_joint(make_revolute("A5", {.point = kA}, on(5)));
  model.add_joint(make_revolute("A7", {.point = kA}, on(7)));
  model.add_joint(make_revolute("E", on(5, kE5), on(4)));
  model.add_joint(make_revolute("H", on(7, kH7), on(6)));
  model.add_joint(make_revolute("F3", on(2, kF2), on(3, kF3)));
  model.add_joint(make_revolute("F4", on(2, kF2), on(4, kF4)));
  model.add_joint(make_revolute("F6", on(2, kF2), on(6, kF6)));
  model.add_force_element(make_torque("motor", on(1), 0.033));
  model.add_force_element(make_spring("spring", {.point = kC}, on(3, kD3), {4530, 0, 0.07785}));
  return model;
}

State start(const Model& model) {
  const auto angle = kStart.frames();
  const auto turned = [&](int body, const Vec2& v) {
    return Vec2(Eigen::Rotation2Dd(angle[static_cast<size_t>(body - 1)]) * v);
  };
  const Vec2 points[7] = {{0, 0}, turned(1, {kRr, 0}), kB, kA + turned(5, kE5),
                          kA,     kA + turned(7, kH7), kA};
  State x = model.reference();
  for (int k = 1; k <= 7; ++k)
    testing::put(model, name(k), {points[k - 1], angle[static_cast<size_t>(k - 1)]}, x);
  return x;
}

constexpr double kEndTime = 0.03;

/// Returns the errors of the seven angles at the end, up to full turns.
VectorXd errors_of(const Model& model, const State& x) {
  VectorXd out(7);
  for (int k = 1; k <= 7; ++k)
    out[k - 1] = std::remainder(
        testing::angle_of(model, name(k), x) - kEnd.frames()[static_cast<size_t>(k - 1)],
        2 * std::numbers::pi);
  return out;
}

VectorXd errors(double h) {
  Workspace model = squeezer();
  State x = start(model);
  AlphaSettings settings;
  settings.tolerance = 1e-14;
  GeneralizedAlpha alpha(model, settings);
  alpha.make_consistent(x);
  const int n = static_cast<int>(std::lround(kEndTime / h));
  for (int k = 1; k <= n; ++k) alpha.advance(x, kEndTime * k / n, [](const State&) {});
  return errors_of(model, x);
}

// The published start satisfies the joints and has the published accelerations.
TEST(Squeezer, StartsAsPublished) {
  Workspace model = squeezer();
  State x = start(model);
  Constraints c;
  model.constraints(x, c);
  EXPECT_LT(c.value.cwiseAbs().maxCoeff(), 1e-15);
  GeneralizedAlpha alpha(model, {});
  alpha.make_consistent(x);
  const auto spin = [&](int body) {  // without velocity: u × ü
    const int at = model.body(name(body)).first_dof;
    return x.q[at + 2] * x.a[at + 3] - x.q[at + 3] * x.a[at + 2];
  };
  EXPECT_NEAR(spin(1) / 14222.4439199541138705911625887, 1, 1e-12);
  EXPECT_NEAR((spin(2) - spin(1)) / -10666.8329399655854029433719415, 1, 1e-12);
  // The mechanism starts at rest at a dead centre: no body behind F accelerates.
  for (const int body : {3, 4, 5, 6, 7}) EXPECT_NEAR(spin(body), 0, 1e-8);
}

// The order is 2. If this term of the error is extrapolated, eight digits of the published angles
// (of up to 15.8 rad) are reproduced, as far as the tolerance of Newton's method permits.
TEST(Squeezer, ConvergesToThePublishedSolution) {
  std::vector<VectorXd> e;
  const auto rate = testing::fit_rate({1e-5, 5e-6, 2.5e-6}, [&](double h) {
    return e.emplace_back(errors(h)).lpNorm<Eigen::Infinity>();
  });
  EXPECT_NEAR(rate.order(), 2, 0.02) << rate.table();
  EXPECT_LT(rate.error.back(), 3e-5) << rate.table();
  EXPECT_LT(((4 * e[1] - e[0]) / 3).lpNorm<Eigen::Infinity>(), 2e-7);
  EXPECT_LT(((4 * e[2] - e[1]) / 3).lpNorm<Eigen::Infinity>(), 5e-8);
}

// The explicit method passes the dead centres and six turns of the crank. Its error follows the
// tolerance down to the accuracy of the published digits and the accumulated round-off.
TEST(Squeezer, FollowsThePublishedSolutionInMinimalCoordinates) {
  std::vector<double> error;
  for (const double tolerance : {1e-6, 1e-8, 1e-10, 1e-12}) {
    Workspace model = squeezer();
    State x = start(model);
    MinimalCoordinates scheme(model, {tolerance});
    scheme.make_consistent(x);
    double drift = 0;
    Constraints c;
    scheme.advance(x, kEndTime, [&](const State& y) {
      model.constraints(y, c);
      drift = std::max(drift, c.value.lpNorm<Eigen::Infinity>());
    });
    error.push_back(errors_of(model, x).lpNorm<Eigen::Infinity>());
    const StepCounts& n = scheme.counts();
    std::cout << "tolerance " << tolerance << ": error " << error.back() << ", drift " << drift
              << " m, " << n.steps << " steps, " << n.rejected << " rejected, " << n.evaluations
              << " evaluations, " << n.newton << " Newton, " << n.partitions << " partitions\n";
    EXPECT_LT(drift, 1e-15);
    EXPECT_GT(n.partitions, 6);
  }
  EXPECT_LT(error[1], 1e-2 * error[0] * 10);
  EXPECT_LT(error[2], 1e-2 * error[1] * 10);
  EXPECT_LT(error[3], 1e-8);
}

}  // namespace
}  // namespace flexmorph::fem
