// Shows that the motion platform of P section 4.3 follows the closed form of its inverse
// kinematics.

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "cases/assembly/build.h"
#include "fem/dynamics/starts/rigid_motion.h"
#include "fem/solve/diagnosis.h"
#include "tests/cases/scenes.h"
#include "tests/support/errors.h"
#include "tests/support/rates.h"

namespace flexmorph::cases {
namespace {

const Vec2 kA(-0.4, 0), kB(0.4, 0), kToC(-0.15, 0), kToD(0.15, 0);

/// Returns the position of the platform at time t, P (36), (37).
Vec2 center(double t) {
  const double theta = -2 * std::numbers::pi * std::pow(t - 0.5, 3) + 1.5 * std::numbers::pi * t -
                       std::numbers::pi / 4;
  return {0.5 * std::cos(std::numbers::pi - theta), 0.5 * std::sin(std::numbers::pi - theta) + 0.4};
}
Vec2 bar1(double t) { return center(t) + kToC - kA; }
Vec2 bar2(double t) { return center(t) + kToD - kB; }
/// Length of the bar between the bearings; 0.05 m of each end lie in the bearings.
double length1(double t) { return bar1(t).norm() - 0.1; }
double length2(double t) { return bar2(t).norm() - 0.1; }

class MotionPlatform : public ::testing::Test {
 protected:
  const Scene scene_ = read("motion_platform");
};

TEST_F(MotionPlatform, LengthsAndAngleAreThoseOfInverseKinematics) {
  const auto l1 = scene_.motion_of({"L1"}), l2 = scene_.motion_of({"L2"}),
             angle = scene_.motion_of({"alpha1"});
  EXPECT_NEAR(l1(0).value, std::hypot(0.25, 0.4) - 0.1, 1e-12);
  EXPECT_NEAR(angle(0).value, std::atan2(0.4, -0.25), 1e-12);
  for (int i = 0; i <= 997; ++i) {
    const double t = i / 997.0;
    EXPECT_NEAR(l1(t).value, length1(t), 1e-12) << t;
    EXPECT_NEAR(l2(t).value, length2(t), 1e-12) << t;
    EXPECT_NEAR(angle(t).value, std::atan2(bar1(t).y(), bar1(t).x()), 1e-12) << t;
  }
  // Rates and accelerations are the derivatives of the values: the quintics are smooth up to the
  // second derivative.
  const double d = 1e-4;
  for (double t = 0.01; t < 0.99; t += 0.0371) {
    EXPECT_NEAR(l1(t).rate, (length1(t + d) - length1(t - d)) / (2 * d), 1e-7);
    EXPECT_NEAR(l1(t).acceleration, (length1(t + d) - 2 * length1(t) + length1(t - d)) / (d * d),
                1e-5);
  }
  // The largest length is 0.8717 m, which is 0.9717 m minus 0.1 m in the bearings. Both bars have
  // the same limits because of symmetry.
  for (const char* bar : {"bar1", "bar2"}) {
    EXPECT_NEAR(scene_.body(bar).longest(scene_.time.end), 0.8717, 5e-5);
    EXPECT_NEAR(scene_.body(bar).shortest(scene_.time.end), std::hypot(0.25, 0.4) - 0.1, 1e-10);
  }
}

TEST_F(MotionPlatform, RigidModelFollowsThePathAndIsDetermined) {
  const fem::RigidKinematics rigid = rigid_kinematics(scene_);
  fem::RigidMotion motion(rigid);
  EXPECT_EQ(motion.degrees_of_freedom(), 0);
  EXPECT_EQ(fem::undriven_degrees_of_freedom(rigid), 3);

  for (int i = 0; i <= 200; ++i) {
    const double t = i / 200.0;
    const fem::State& x = motion.at(t);
    const fem::FrameMotion platform = rigid.frame("platform", x);
    EXPECT_LT((platform.origin - center(t)).norm(), 1e-10) << t;
    EXPECT_NEAR(platform.angle, 0, 1e-10) << t;
    fem::Workspace model(rigid.model());
    const fem::Diagnosis found = fem::diagnose(model, x);
    EXPECT_TRUE(found.is_independent()) << t;
    EXPECT_EQ(found.degrees_of_freedom(), 0) << t;
  }
}

TEST_F(MotionPlatform, WeldedEndsOfDesignsAreSolid) {
  try {
    read("motion_platform", {"design.bar2.solid=[]"});
    ADD_FAILURE() << "not refused";
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), Error::Kind::input);
    EXPECT_TRUE(testing::mentions_all(
        error.what(), {"design.bar2", "welded", "'bar2'", "[[design.solid]]", "free_end"},
        shipped("motion_platform") + ":"));
  }
}

/// Returns the largest distance of the platform from the rigid path if the stiffness of the plates
/// is multiplied by `stiffness`.
double largest_error(double stiffness, double end) {
  Scene scene = read("motion_platform", {"time.step=2e-3"});
  for (Body& b : scene.bodies) b.youngs_modulus *= stiffness;
  Mechanism mechanism = build_mechanism(scene);
  mechanism.motion.end = end;
  double worst = 0;
  fem::integrate(mechanism.model, mechanism.moving_roots, mechanism.motion,
                 [&](const fem::MotionStep& step) {
                   const fem::FrameMotion f = fem::frame_of(step.model.body("platform"), step.x);
                   worst = std::max(worst, (f.origin - center(step.x.t)).norm());
                 });
  return worst;
}

// In the limit of stiff bars the platform follows the rigid path: its distance from the path
// decreases with 1/E.
TEST_F(MotionPlatform, StiffLimitIsTheRigidMotion) {
  const double end = 0.3;
  double before = largest_error(10, end);
  EXPECT_GT(before, 1e-6);
  for (const double stiffness : {1e2, 1e3, 1e4}) {
    const double error = largest_error(stiffness, end);
    EXPECT_NEAR(before / error, 10, 0.5) << stiffness;
    before = error;
  }
}

/// Returns the times at which a length crosses a value upwards (sign 1) or downwards (-1).
std::vector<double> crossings(double (*length)(double), double value, int sign) {
  std::vector<double> out;
  const auto past = [&](double t) { return sign * (length(t) - value) > 0; };
  constexpr int kLooks = 1000;
  for (int i = 0; i < kLooks; ++i) {
    double a = i / double(kLooks), b = (i + 1) / double(kLooks);
    if (past(a) || !past(b)) continue;
    for (int k = 0; k < 60; ++k) (past(0.5 * (a + b)) ? b : a) = 0.5 * (a + b);
    out.push_back(b);
  }
  return out;
}

/// Returns the insertions and removals (time, change) that follow from the length law, in order of
/// time.
std::vector<std::pair<double, fem::MeshChange>> demanded(double (*length)(double), double start,
                                                         int elements) {
  constexpr double kMaximum = 0.1, kMinimum = 0.03;
  std::vector<std::pair<double, fem::MeshChange>> out;
  std::vector<double> inner(static_cast<size_t>(elements - 1), start / elements);
  double t = 0;
  const auto rest = [&] {
    double sum = 0;
    for (const double l : inner) sum += l;
    return sum;
  };
  while (true) {
    double next = 2;
    fem::MeshChange change{};
    for (const double up : crossings(length, rest() + kMaximum, 1))
      if (up > t + 1e-9 && up < next) next = up, change = fem::MeshChange::insertion;
    if (!inner.empty() && kMinimum + inner.front() < 0.9 * kMaximum)
      for (const double down : crossings(length, rest() + kMinimum, -1))
        if (down > t + 1e-9 && down < next) next = down, change = fem::MeshChange::removal;
    if (next > 1 - 1e-9) return out;
    if (change == fem::MeshChange::insertion)
      inner.insert(inner.begin(), 0.5 * kMaximum);
    else
      inner.erase(inner.begin());
    out.emplace_back(t = next, change);
  }
}

TEST_F(MotionPlatform, ChangesOfTheMeshAreWhatTheLengthsDemandAndDoNoHarm) {
  Mechanism mechanism = build_mechanism(scene_);
  double kinetic = 0, largest_momentum = 0;
  const fem::MotionResult r = fem::integrate(
      mechanism.model, mechanism.moving_roots, mechanism.motion, [&](const fem::MotionStep& step) {
        kinetic = std::max(kinetic, step.energies.kinetic);
        largest_momentum = std::max(largest_momentum, step.model.momentum(step.x).norm());
      });
  for (const auto& [bar, want] :
       {std::pair{"bar1", demanded(length1, length1(0), scene_.body("bar1").elements[0])},
        std::pair{"bar2", demanded(length2, length2(0), scene_.body("bar2").elements[0])}}) {
    size_t k = 0;
    double last = -1;
    fem::MeshChange before{};
    for (const fem::MeshEvent& e : r.events) {
      if (e.body != bar) continue;
      ASSERT_LT(k, want.size()) << bar;
      EXPECT_NEAR(e.time, want[k].first, 1e-9) << bar;
      EXPECT_EQ(e.change, want[k].second) << bar << " at " << e.time;
      if (k > 0 && e.change != before) {
        EXPECT_GT(e.time - last, 0.02) << bar;
      }
      last = e.time;
      before = e.change;
      ++k;
      EXPECT_LT(std::abs(e.after.total() - e.before.total()), 1e-4 * kinetic);
      EXPECT_LT((e.momentum_after - e.momentum_before).norm(), 1e-6 * largest_momentum);
    }
    EXPECT_EQ(k, want.size()) << bar;
    EXPECT_GT(k, 8u);
  }
  // The energy balance includes the work of the drives.
  EXPECT_LT(r.energy_error, 2e-4);
  EXPECT_LT(r.constraint_drift, 1e-12);
}

/// Returns the acceleration of the platform at the start.
Vec2 first_acceleration(const std::string& start) {
  Mechanism mechanism = build_mechanism(read("motion_platform", {"time.start=" + start}));
  mechanism.motion.end = mechanism.motion.step;
  std::optional<Vec2> out;
  fem::integrate(mechanism.model, mechanism.moving_roots, mechanism.motion,
                 [&](const fem::MotionStep& step) {
                   if (!out)
                     out = fem::frame_of(step.model.body("platform"), step.x).origin_acceleration;
                 });
  return *out;
}

// The path begins with θ'' = 6 π, that is with an acceleration of 3 π m/s² upwards. Bars that are
// prestretched by the inertia forces of the rigid motion give the platform this acceleration.
// Unstrained bars do not, and vibrate.
TEST_F(MotionPlatform, PrestretchedBarsCarryThePlatformFromTheFirstMoment) {
  const Vec2 rigid(0, 3 * std::numbers::pi);
  EXPECT_LT((first_acceleration("prestretched") - rigid).norm(), 1e-3 * rigid.norm());
  EXPECT_GT((first_acceleration("rigid") - rigid).norm(), 0.1 * rigid.norm());
}

// Before the first change of a mesh the energy error is of second order, the order of the
// integrator.
TEST_F(MotionPlatform, EnergyBalanceIsOfSecondOrder) {
  const auto energy_error = [](double h) {
    Mechanism mechanism =
        build_mechanism(read("motion_platform", {"time.step=" + std::to_string(h)}));
    mechanism.motion.end = 0.1;
    double worst = 0;
    fem::integrate(
        mechanism.model, mechanism.moving_roots, mechanism.motion,
        [&](const fem::MotionStep& step) { worst = std::max(worst, std::abs(step.energy_error)); });
    return worst;
  };
  const testing::Rate rate = testing::fit_rate({4e-3, 2e-3, 1e-3}, energy_error);
  EXPECT_NEAR(rate.order(), 2, 0.1) << rate.table();
}

}  // namespace
}  // namespace flexmorph::cases
