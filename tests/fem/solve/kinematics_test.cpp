// Shows that driven mechanisms follow their closed-form motion to round-off, forwards and
// backwards, and that the time and the joints are named where a motion is impossible.
#include "fem/solve/kinematics.h"

#include <gtest/gtest.h>

#include <numbers>

#include "tests/support/differences.h"
#include "tests/support/point_mechanisms.h"

namespace flexmorph::fem {
namespace {

using testing::add;
using testing::AngleDrive;
using testing::constant;
using testing::Course;
using testing::FourBar;
using testing::linear;
using testing::LinearRow;
using testing::Rod;
using Parts = std::vector<LinearRow::Part>;

/// The message at the end of the possible motion, and its time.
struct PathEnd {
  std::string text;
  double t = NAN;
  bool names(const std::string& joint) const {
    return text.find("'" + joint + "'") != std::string::npos;
  }
};
PathEnd end_of_path(Workspace& model, double until) {
  Kinematics motion(model, model.reference());
  try {
    motion.at(until);
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), Error::Kind::numerical);
    PathEnd out{error.what()};
    const size_t at = out.text.find("t = ");
    if (at != std::string::npos) out.t = std::stod(out.text.substr(at + 4));
    EXPECT_TRUE(motion.state().q.allFinite());
    EXPECT_NEAR(motion.state().t, out.t, 1e-6) << "the last state is the one before the end";
    return out;
  }
  ADD_FAILURE() << "the path was followed";
  return {};
}

// A crank rotates with varying speed through a revolution and back. Positions are compared with the
// intersection of circles, rates with differences of it (fourth order, h = 1e-3: 1e-10 for rates
// and 1e-8 for second derivatives of a motion with angular frequencies up to 20).
TEST(Kinematics, FourBarFollowsItsClosedForm) {
  const FourBar bar;
  const Course angle = [](double t) {
    return Motion{0.7 + 2 * std::numbers::pi * t + 0.3 * std::sin(5 * t),
                  2 * std::numbers::pi + 1.5 * std::cos(5 * t), -7.5 * std::sin(5 * t)};
  };
  Workspace model = bar.model(angle);
  const auto exact = [&](double t) { return bar.locations(angle(t).value); };
  Kinematics motion(model, model.reference());
  double position = 0, rate = 0, acceleration = 0;
  const auto look = [&](double t) {
    const State& x = motion.at(t);
    EXPECT_EQ(x.t, t);
    position = std::max(position, (x.q - exact(t)).lpNorm<Eigen::Infinity>());
    const auto near = [&](double s) { return exact(t + s); };
    rate = std::max(rate, (x.v - testing::first_difference(near, 1e-3)).lpNorm<Eigen::Infinity>());
    acceleration = std::max(
        acceleration, (x.a - testing::second_difference(near, 1e-3)).lpNorm<Eigen::Infinity>());
  };
  for (int i = 0; i <= 40; ++i) look(i * 0.03);
  for (int i = 40; i >= -10; --i) look(i * 0.035);
  EXPECT_LT(position, 1e-12 * bar.l);
  EXPECT_LT(rate, 1e-7);
  EXPECT_LT(acceleration, 1e-5);
}

// One call over ten revolutions must find its own substeps and stay on its branch.
TEST(Kinematics, KeepsToItsBranchOverLargeSteps) {
  const FourBar bar;
  const Course angle = linear(0.7, 2 * std::numbers::pi);
  Workspace model = bar.model(angle);
  Kinematics motion(model, model.reference(), {.largest_step = 10});
  EXPECT_LT((motion.at(10.4).q - bar.locations(angle(10.4).value)).lpNorm<Eigen::Infinity>(),
            1e-12);
}

// The number of steps can be limited, so that a very fast drive ends with an error.
TEST(Kinematics, FastDrivesAreGivenUp) {
  const FourBar bar;
  const Course angle = [](double t) { return Motion{0.7 + 1e5 * t, 1e5, 0}; };
  Workspace model = bar.model(angle);
  KinematicsSettings settings;
  settings.most_steps = 50;
  Kinematics motion(model, model.reference(), settings);
  try {
    motion.at(1);
    ADD_FAILURE() << "15 000 turns in 50 steps";
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find("50 steps"), std::string::npos) << error.what();
  }
  EXPECT_EQ(motion.n_steps(), 50);
  EXPECT_FALSE(motion.follow(1, 60));
  EXPECT_EQ(motion.n_steps(), 60);
  EXPECT_GT(motion.state().t, 0);
}

// x = t³ starts from rest, so that the prediction of the first step is zero.
TEST(Kinematics, StartsFromRest) {
  MatrixXd location(1, 2);
  location << 0.0, 0.5;
  Workspace model = testing::point_model(location);
  add<LinearRow>(model, "x", Parts{{0, 0}}, [](double t) {
    return Motion{t * t * t, 3 * t * t, 6 * t};
  });
  add<LinearRow>(model, "y", Parts{{0, 1}}, constant(0.5));
  Kinematics motion(model, model.reference());
  EXPECT_NEAR(motion.at(2).q[0], 8, 1e-12 * 8);
  EXPECT_NEAR(motion.at(2).v[0], 12, 1e-11);
  EXPECT_NEAR(motion.at(-1).a[0], -6, 1e-11);
}

// The rods are too short: the crank cannot pass the angle at which coupler and rocker are
// stretched.
TEST(Kinematics, UnreachablePathNamesTheTime) {
  const FourBar bar{.r = 0.3, .l = 0.35, .s = 0.25, .g = 0.45};
  const double speed = 1.3, end = (bar.limit_angle() - 0.5) / speed;
  Workspace model = bar.model(linear(0.5, speed));
  const PathEnd found = end_of_path(model, 5);
  EXPECT_NEAR(found.t, end, 1e-6) << found.text;
  EXPECT_TRUE(found.names("coupler") && found.names("rocker")) << found.text;
  // Backwards the limit is at the negative angle.
  const PathEnd before = end_of_path(model, -5);
  EXPECT_NEAR(before.t, (-bar.limit_angle() - 0.5) / speed, 1e-6) << before.text;
}

// A slider pulls a crank to the dead centre where crank and rod are stretched.
TEST(Kinematics, DeadCentreOfADrivenSlider) {
  const double r = 0.2, l = 0.5, x0 = 0.45, speed = 0.37;
  const double cosine = (r * r + x0 * x0 - l * l) / (2 * r * x0);
  MatrixXd locations(2, 2);
  locations << r * cosine, r * std::sqrt(1 - cosine * cosine), x0, 0.0;
  Workspace model = testing::point_model(locations);
  add<Rod>(model, "crank", 0, -1, constant(r));
  add<Rod>(model, "rod", 0, 1, constant(l));
  add<LinearRow>(model, "guide", Parts{{1, 1}}, constant(0));
  add<LinearRow>(model, "drive", Parts{{1, 0}}, linear(x0, speed));
  const PathEnd found = end_of_path(model, 3);
  EXPECT_NEAR(found.t, (r + l - x0) / speed, 1e-6) << found.text;
  EXPECT_TRUE(found.names("crank") && found.names("rod")) << found.text;
  EXPECT_NE(found.text.find("dead centre"), std::string::npos);
}

// Where a parallelogram is flat, it can continue as a parallelogram or crossed. The motion is
// regular there; only the determinant shows the change point.
TEST(Kinematics, ChangePointOfAParallelogram) {
  const FourBar bar{.r = 0.3, .l = 0.5, .s = 0.3, .g = 0.5};
  const double speed = 1.1, start = 0.8;
  Workspace model = bar.model(linear(start, -speed));
  const PathEnd found = end_of_path(model, 5);
  EXPECT_NEAR(found.t, start / speed, 1e-6) << found.text;
}

TEST(Kinematics, DriveThatJumpsIsNamed) {
  const FourBar bar;
  Workspace model = bar.model([](double t) { return Motion{t < 0.3 ? 0.7 : 1.4, 0, 0}; });
  const PathEnd found = end_of_path(model, 1);
  EXPECT_NEAR(found.t, 0.3, 1e-6) << found.text;
  EXPECT_TRUE(found.names("motor") && !found.names("rocker")) << found.text;
}

// A continuous motion is followed although the speed of a drive jumps.
TEST(Kinematics, PassesKinksOfADrive) {
  const FourBar bar;
  const Course angle = [](double t) {
    return t < 0.3 ? Motion{0.7, 0, 0} : Motion{0.7 + 3 * (t - 0.3), 3, 0};
  };
  Workspace model = bar.model(angle);
  Kinematics motion(model, model.reference());
  EXPECT_LT((motion.at(1).q - bar.locations(angle(1).value)).lpNorm<Eigen::Infinity>(), 1e-12);
}

// A second rocker rod between the same points is left out of the solution, but its residual is
// monitored.
TEST(Kinematics, RedundantRowsAreWatched) {
  const FourBar bar;
  Workspace model = bar.model(linear(0.7, 1));
  add<Rod>(model, "second", 1, -1, constant(bar.s), Vec2(bar.g, 0));
  Kinematics motion(model, model.reference());
  EXPECT_LT((motion.at(1).q - bar.locations(1.7)).lpNorm<Eigen::Infinity>(), 1e-12);

  Workspace growing = bar.model(linear(0.7, 1));
  add<Rod>(
      growing, "second", 1, -1,
      [&](double t) {
        const double late = std::max(0.0, t - 0.5);
        return Motion{bar.s + 0.1 * late * late, 0.2 * late, t > 0.5 ? 0.2 : 0.0};
      },
      Vec2(bar.g, 0));
  Kinematics stopped(growing, growing.reference());
  EXPECT_NO_THROW(stopped.at(0.5));
  EXPECT_THROW(stopped.at(1), Error);
}

TEST(Kinematics, FreedomsThatAreLeftAreRefused) {
  const FourBar bar;
  MatrixXd locations(2, 2);
  locations << 0.2, 0, 0.3, 0.4;
  Workspace model = testing::point_model(locations);
  add<Rod>(model, "crank", 0, -1, constant(0.2));
  add<Rod>(model, "coupler", 0, 1, constant(0.5));
  try {
    Kinematics motion(model, model.reference());
    FAIL() << "two degrees of freedom are left";
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), Error::Kind::input);
    EXPECT_NE(std::string(error.what()).find("2 degrees of freedom"), std::string::npos)
        << error.what();
  }
  Workspace driven = bar.model(linear(0.7, 1));
  Kinematics motion(driven, driven.reference());
  EXPECT_THROW(motion.at(NAN), Error);
  EXPECT_THROW(Kinematics(driven, driven.reference(), {.largest_step = 0}), Error);
}

}  // namespace
}  // namespace flexmorph::fem
