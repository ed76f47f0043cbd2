// Shows that a steady start of case files is correct: levers and masses are in equilibrium with
// their springs, far from the free lengths; a plate that grows out of its hub does not swing; and
// cases without a steady start are refused with a reason.
#include <gtest/gtest.h>

#include <cmath>

#include "cases/assembly/build.h"
#include "cases/results/motion_columns.h"
#include "fem/dynamics/motion.h"
#include "fem/dynamics/starts/driven_frame.h"
#include "fem/dynamics/starts/start_parts.h"
#include "fem/solve/statics.h"
#include "tests/cases/scene/loaded_scenes.h"
#include "tests/cases/scenes.h"
#include "tests/io/scratch.h"
#include "tests/support/errors.h"

namespace flexmorph::cases {
namespace {

constexpr double kGravity = 9.81;

std::string timed(const std::string& start) {
  return "gravity = [0.0, -9.81]\n[time]\nend = 0.5\nstep = 1e-3\n" +
         (start.empty() ? "" : "start = \"" + start + "\"\n");
}
std::string lever(double rest_angle, double stiffness = 50) {
  return "\n[[rigid_body]]\nname = \"lever\"\nmass = 1.0\ninertia = 0.02\nsize = [1.0, 0.05]\n"
         "center = [0.5, 0.0]\n[[joint]]\ntype = \"revolute\"\nname = \"pivot\"\nb = \"lever\"\n"
         "[[spring]]\ntype = \"torsion\"\nname = \"coil\"\nb = \"lever\"\nstiffness = " +
         std::to_string(stiffness) + "\nrest_angle = " + std::to_string(rest_angle) + "\n";
}

/// Solves k (θ - θ_0) + m g l cos θ = 0 by Newton's method in one unknown, starting from θ_0.
double angle_of_lever(double rest_angle, double stiffness = 50) {
  double angle = rest_angle;
  for (int i = 0; i < 50; ++i)
    angle -= (stiffness * (angle - rest_angle) + 0.5 * kGravity * std::cos(angle)) /
             (stiffness - 0.5 * kGravity * std::sin(angle));
  return angle;
}

fem::State steady_start_of(Mechanism& m) {
  return fem::start_state(m.model, m.moving_roots, 0, m.motion.start, m.motion.body_poses);
}

TEST(SteadyStart, LeverHangsInItsSpring) {
  EXPECT_NEAR(angle_of_lever(-0.3), -0.390707, 1e-6);
  for (const double rest : {-0.3, 0.5, -1.5, -3.0}) {
    Mechanism m = build_mechanism(scene_of(timed("steady") + lever(rest)));
    const fem::State x = steady_start_of(m);
    EXPECT_NEAR(fem::frame_of(m.model.body("lever"), x).angle, angle_of_lever(rest), 1e-9) << rest;
    EXPECT_EQ(x.v.norm(), 0);
    // The lever stays there.
    const fem::MotionResult end = fem::integrate(m.model, m.moving_roots, m.motion, [](auto&) {});
    EXPECT_NEAR(fem::frame_of(m.model.body("lever"), end.final).angle, angle_of_lever(rest), 1e-9);
  }
}

TEST(SteadyStart, PreloadOfStaticsComesInSteps) {
  const Scene scene = scene_of("gravity = [0.0, -9.81]\n[static]\nsteps = 10\n" + lever(-3));
  Mechanism m = build_mechanism(scene);
  fem::State x =
      fem::start_state(m.model, m.moving_roots, 0, fem::Start::rigid, m.motion.body_poses);
  EXPECT_TRUE(fem::solve_static(m.model, x, {}).completed);
  const double angle = fem::frame_of(m.model.body("lever"), x).angle;
  EXPECT_NEAR(angle, -2.904641101904, 1e-10);
  EXPECT_NEAR(angle, angle_of_lever(-3), 1e-10);
}

// Reference: m g = k (l - l_0). The spring starts far from its free length.
TEST(SteadyStart, MassHangsInALinearSpring) {
  Mechanism m = build_mechanism(scene_of(
      timed("steady") +
      "\n[[rigid_body]]\nname = \"mass\"\nmass = 2.0\nsize = [0.1, 0.1]\nposition = [0.0, -0.2]\n"
      "[[joint]]\ntype = \"slider\"\na = \"ground\"\nangle_a = -1.5707963267948966\nb = \"mass\"\n"
      "angle_b = -1.5707963267948966\n"
      "[[spring]]\ntype = \"linear\"\na = \"ground\"\npoint_a = [0.0, 0.0]\nb = \"mass\"\n"
      "stiffness = 40.0\nfree_length = 1.0\n"));
  const fem::State x = steady_start_of(m);
  EXPECT_NEAR(fem::frame_of(m.model.body("mass"), x).origin.y(), -(1 + 2 * kGravity / 40), 1e-9);
}

void expect_refused(const std::string& text, const std::vector<std::string>& parts) {
  try {
    build_mechanism(scene_of(text));
    ADD_FAILURE() << "not refused: " << text;
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), Error::Kind::input);
    EXPECT_TRUE(testing::mentions_all(error.what(), parts));
  }
}

TEST(SteadyStart, WhatItDoesNotFitIsRefused) {
  expect_refused(timed("prestretched") + lever(-0.3),
                 {"case.toml:5:9: time.start = \"prestretched\"", "steady"});
  expect_refused(timed("steady") +
                     "\n[[rigid_body]]\nname = \"a\"\nmass = 1.0\nsize = [0.4, 0.1]\nposition = "
                     "[0.2, 0.0]\nangular_velocity = 4.0\n[[joint]]\ntype = \"revolute\"\nb = "
                     "\"a\"\npoint_b = [-0.2, 0.0]\n",
                 {"case.toml:5:9: time.start = \"steady\"", "1 degree", "0.8 m/s", "rigid"});
  // A body that falls along its slider has no equilibrium.
  Mechanism m = build_mechanism(
      scene_of(timed("steady") +
               "\n[[rigid_body]]\nname = \"a\"\nmass = 1.0\nsize = [0.4, 0.1]\n[[joint]]\ntype = "
               "\"slider\"\na = \"ground\"\nangle_a = 1.5707963267948966\nb = \"a\"\nangle_b = "
               "1.5707963267948966\n"));
  EXPECT_THROW(steady_start_of(m), Error);
}

// With a steady start the growing plate (uniform material on the elements of the case) follows its
// quasi-static deflection. With a prestretched start it begins without this deflection and swings
// about it.
TEST(SteadyStart, GrowingPlateDoesNotSwing) {
  const auto swing = [](const std::string& start) {
    Mechanism m = build_mechanism(read("rotating_plate_v01", {"time.start=" + start}));
    Mechanism still = build_mechanism(read("rotating_plate_v01"));
    double worst = 0, largest = 0;
    int n = 0;
    fem::integrate(m.model, m.moving_roots, m.motion, [&](const fem::MotionStep& step) {
      if (n++ % 10 != 0) return;
      const auto there =
          fem::start::steady_equilibrium(still.model, still.moving_roots, {}, step.x.t);
      const double quasi_static =
          tip_deflection(still.model, still.moving_roots[0], there.strained);
      worst = std::max(
          worst, std::abs(tip_deflection(step.model, m.moving_roots[0], step.x) - quasi_static) /
                     std::abs(quasi_static));
      largest = std::max(largest, std::abs(quasi_static));
    });
    EXPECT_GT(largest, 1e-4);
    return worst;
  };
  EXPECT_LT(swing("steady"), 0.05);
  EXPECT_GT(swing("prestretched"), 0.9);
}

// The tip deflection of a design of rotating_plate_v01, simulated on the design mesh, is compared
// with -0.399 mm of an independent quasi-static finite-element model of the same cells.
TEST(SteadyStart, DesignedPlateIsBentByCoriolisForces) {
  const Scene scene =
      read("rotating_plate_v01",
           {"time.start=steady", "design.start='" FLEXMORPH_DATA "/rotating_plate_v01.csv'"});
  Mechanism m = build_mechanism(scene, {.elements = {}, .refine = 1, .cells = 1});
  const mmc::BodyProblem problem = build_problems(scene).at(0);
  m.model.set_factors(m.model.bodies()[0],
                      mmc::dynamic_factors(problem, problem.design.components()));
  EXPECT_NEAR(tip_deflection(m.model, m.moving_roots[0], steady_start_of(m)), -0.399e-3,
              0.02 * 0.399e-3);
}

// Without time.start, a case with zero prescribed velocities starts at rest, a case with prescribed
// velocities starts steady, and a case whose drives leave free motion starts at the given
// positions.
TEST(AutomaticStart, FollowsThePrescribedVelocities) {
  const auto of = [](const std::string& name, const std::vector<std::string>& changes) {
    Mechanism m = build_mechanism(read(name, changes));
    return std::pair(m.motion.start, m.start_text);
  };
  const auto expect = [&](const std::string& name, std::vector<std::string> changes,
                          fem::Start start, const std::string& words) {
    changes.emplace_back("time.start=automatic");
    const auto [found, said] = of(name, changes);
    EXPECT_EQ(found, start) << name << ": " << said;
    EXPECT_NE(said.find(words), std::string::npos) << said;
  };
  expect("rotating_plate_v01", {}, fem::Start::steady, "steady");
  expect("four_bar", {}, fem::Start::at_rest, "at rest");
  expect("telescopic_crane", {"gravity=[3.0, -9.81]"}, fem::Start::rigid, "undetermined");
  Mechanism lever_of = build_mechanism(scene_of(timed("") + lever(-0.3)));
  EXPECT_EQ(lever_of.motion.start, fem::Start::rigid);
  EXPECT_TRUE(lever_of.start_text.empty());
}

// A plate in a static hub starts with its deflection under weight and keeps it. Reference: a
// cantilever without shear, whose deflection would be 0.3 %.
TEST(AutomaticStart, PlateInAStillHubHangsAsACantilever) {
  const double length = 0.5, width = 0.02, modulus = 1e9, density = 2700;
  Mechanism m = build_mechanism(scene_of(
      timed("") +
      "[[hub]]\nname = \"hub\"\nangular_velocity = 0.0\n[[body]]\nname = \"plate\"\nelement = "
      "\"ancf_plate\"\nterms = "
      "[\"inertia\", \"membrane\"]\nlength = 0.5\nwidth = 0.02\nthickness = 0.01\ndensity = "
      "2700.0\nyoungs_modulus = 1e9\npoisson_ratio = 0.0\nelements = [20, 1]\n[[joint]]\ntype = "
      "\"weld\"\nbody = \"plate\"\nedge = \"root\"\nto = \"hub\"\n"));
  EXPECT_EQ(m.motion.start, fem::Start::at_rest);
  const double sag = -density * kGravity * std::pow(length, 4) / (8 * modulus * width * width / 12);
  fem::integrate(m.model, m.moving_roots, m.motion, [&](const fem::MotionStep& step) {
    EXPECT_NEAR(tip_deflection(step.model, m.moving_roots[0], step.x), sag, 0.02 * std::abs(sag));
  });
}

}  // namespace
}  // namespace flexmorph::cases
