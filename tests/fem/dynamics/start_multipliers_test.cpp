// Shows that joint forces are smooth from the second step on, because generalized-alpha starts with
// the accelerations of the smooth solution: for a bar that a drive rotates with an acceleration,
// with a second bar hinged to its end, and for an extending plate.
#include <gtest/gtest.h>

#include <cmath>

#include "fem/body_joints.h"
#include "fem/dynamics/motion.h"
#include "tests/support/models.h"
#include "tests/support/rigid_models.h"

namespace flexmorph::fem {
namespace {

// Largest third difference and largest absolute value of joint forces.
struct Alternation {
  double largest = 0, size = 0;
  void see(const std::vector<double>& force) {
    for (const double f : force) size = std::max(size, std::abs(f));
    for (size_t i = 2; i + 2 < force.size(); ++i)
      largest = std::max(largest,
                         std::abs(force[i + 2] - 3 * force[i + 1] + 3 * force[i] - force[i - 1]));
  }
};

/// Returns the largest third difference of all joint forces from the first step on, relative to the
/// largest force: it is 8 times a component that alternates from step to step, and (ω h)³ of a
/// smooth component.
double alternation(Workspace& model, std::span<const MovingRoot> moving_roots,
                   MotionSettings settings) {
  std::vector<std::vector<double>> forces;
  integrate(model, moving_roots, settings, [&](const MotionStep& step) {
    const auto n = static_cast<size_t>(step.x.lambda.size());
    forces.resize(n);
    for (size_t i = 0; i < n; ++i) forces[i].push_back(step.x.lambda[static_cast<Eigen::Index>(i)]);
  });
  Alternation all;
  for (const auto& each : forces) all.see(each);
  return all.largest / all.size;
}

TEST(StartOfMultipliers, PendulumIsSmooth) {
  Workspace model;
  testing::add_rigid(model, "a", {2.0, {0.5, 0}, 0.1}, Vec2(0, -9.81));
  testing::add_rigid(model, "b", {1.0, {0.4, 0}, 0.05}, Vec2(0, -9.81));
  model.add_joint(make_revolute("hook", {}, {"a"}));
  model.add_joint(make_revolute("elbow", {"a", {1.0, 0}, 0, {}}, {"b"}));
  model.add_joint(make_angle_drive("motor", {}, {"a"}, [](double t) {
    return Motion{0.3 + 2 * t + std::sin(3 * t), 2 + 3 * std::cos(3 * t), -9 * std::sin(3 * t)};
  }));
  MotionSettings settings;
  settings.end = 0.1;
  settings.step = 1e-3;
  settings.start = Start::rigid;
  settings.body_poses = [](double) {
    FrameMotion a, b;
    a.angle = 0.3;
    a.angle_rate = 5;
    b.origin = Vec2(std::cos(0.3), std::sin(0.3));
    b.origin_rate = 5 * Vec2(-std::sin(0.3), std::cos(0.3));
    b.angle = -0.5;
    b.angle_rate = -3;
    return std::vector<BodyPose>{{"a", a, 0}, {"b", b, 0}};
  };
  for (const double rho : {0.0, 0.5, 0.8, 0.95}) {
    settings.alpha.rho_inf = rho;
    EXPECT_LT(alternation(model, {}, settings), 1e-4) << rho;
  }
}

TEST(StartOfMultipliers, GrowingPlateIsSmooth) {
  testing::RotatingPlate p;
  testing::Scene scene = testing::make_scene(p);
  MotionSettings settings;
  settings.end = 0.1;
  settings.step = 1e-3;
  settings.start = Start::steady;
  EXPECT_LT(alternation(scene.model, scene.moving_roots, settings), 1e-4);
}

}  // namespace
}  // namespace flexmorph::fem
