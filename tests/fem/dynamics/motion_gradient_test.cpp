// Shows that gradients of motions, through starts, steps, changes of meshes and projections, agree
// with differences of whole motions.

#include "fem/dynamics/gradients/motion_gradient.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "fem/body_weld.h"
#include "fem/elements/ancf_beam.h"
#include "fem/terms.h"
#include "tests/support/differences.h"
#include "tests/support/models.h"
#include "tests/support/rates.h"

namespace flexmorph::fem {
namespace {

using testing::RotatingPlate;
using testing::ShapeSet;

/// Returns a random direction in the factors of a body, proportional to the factors.
ScaleFactorGradient random_direction(const ScaleFactors& factors, unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  ScaleFactorGradient out;
  out.stiffness = factors.stiffness;
  out.mass = factors.mass;
  for (VectorXd* x : {&out.stiffness, &out.mass})
    for (double& each : *x) each *= normal(random);
  return out;
}

double product(const ScaleFactorGradient& a, const ScaleFactorGradient& b) {
  return a.stiffness.dot(b.stiffness) + a.mass.dot(b.mass);
}

/// A rotating, extending plate of cells or of cubic elements with factors from void to material.
struct Growing {
  testing::Scene scene;
  MotionSettings settings;
  std::vector<MotionObjective> objectives;

  Growing(ShapeSet shapes, double speed, Start start) {
    RotatingPlate p;
    p.shapes = shapes;
    p.speed = speed;
    p.longest = 1.0;
    p.nx = shapes == ShapeSet::q4 ? 20 : 10;
    p.ny = shapes == ShapeSet::q4 ? 4 : 1;
    p.factors.grid = {0, -0.05, 1.0, 0.1, 40, 4};
    const int n = p.factors.grid.n_cells();
    p.factors.stiffness.resize(n);
    p.factors.mass.resize(n);
    for (int c = 0; c < n; ++c) {
      // A soft band along the middle has factors over the decades between void and material.
      const bool middle = c % 4 == 1 && c % 3 != 0;
      p.factors.stiffness[c] = middle ? std::pow(10.0, -0.5 - c % 5 * 0.5) : 0.8 + 0.02 * (c % 7);
      p.factors.mass[c] = middle ? 0.05 : 0.9;
    }
    p.section.youngs_modulus = 1e8;
    scene = testing::make_scene(p);
    if (shapes == ShapeSet::q4) {
      MovingRoot& g = scene.moving_roots[0];
      g.cell = 0.025;
      g.max_length = 1.3 * g.cell;
      g.min_length = 0.25 * g.cell;
    }
    settings.end = 0.2;
    settings.step = 4e-3;
    settings.start = start;
    settings.stops = {0.05, 0.1, 0.15, 0.2};
    using Times = MotionObjective::Times;
    objectives = {
        {measure_strain_energy(), Times::stops, 1},
        {measure_deflection("plate", p.tip(), scene.moving_roots[0].hub), Times::steps, 8},
        {measure_joint_force("root", "plate"), Times::steps, 4},
    };
  }

  std::vector<double> values(const ScaleFactorGradient& direction, double by) const {
    Workspace model = scene.model;
    ScaleFactors moved = scene.model.bodies()[0].factors;
    moved.stiffness += by * direction.stiffness;
    moved.mass += by * direction.mass;
    model.set_factors(model.bodies()[0], moved);
    return motion_values(model, scene.moving_roots, settings, objectives);
  }
  MotionGradients gradients(int checkpoints = 0) const {
    return motion_gradients(scene.model, scene.moving_roots, settings, objectives,
                            {.checkpoints = checkpoints, .parameters = {}});
  }
};

class EveryMotion : public ::testing::TestWithParam<std::tuple<ShapeSet, double, Start>> {};

// Central differences of fourth order are accurate to at least six digits.
TEST_P(EveryMotion, HasTheGradientThatDifferencesSay) {
  const auto [shapes, speed, start] = GetParam();
  const Growing motion(shapes, speed, start);
  const MotionGradients found = motion.gradients();
  const ScaleFactorGradient direction = random_direction(motion.scene.model.bodies()[0].factors, 5);
  const auto along = [&](double by) {
    const std::vector<double> v = motion.values(direction, by);
    return VectorXd(Eigen::Map<const VectorXd>(v.data(), static_cast<Eigen::Index>(v.size())));
  };
  const VectorXd there = along(0), differences = testing::first_difference(along, 2e-3);
  for (size_t k = 0; k < motion.objectives.size(); ++k) {
    const auto i = static_cast<Eigen::Index>(k);
    EXPECT_NEAR(found.of[k].value, there[i], 1e-12 * there[i]);
    EXPECT_NEAR(product(found.of[k].d_factors[0], direction), differences[i],
                2e-6 * std::abs(differences[i]))
        << "objective " << k;
  }
}

INSTANTIATE_TEST_SUITE_P(Gradients, EveryMotion,
                         ::testing::Values(std::tuple(ShapeSet::q4, 0.0, Start::rigid),
                                           std::tuple(ShapeSet::q4, 0.5, Start::rigid),
                                           std::tuple(ShapeSet::q4, 0.5, Start::prestretched),
                                           std::tuple(ShapeSet::q4, -0.5, Start::prestretched),
                                           std::tuple(ShapeSet::h16, 0.5, Start::prestretched),
                                           std::tuple(ShapeSet::h16, -0.5, Start::prestretched),
                                           std::tuple(ShapeSet::q4, 0.5, Start::steady),
                                           std::tuple(ShapeSet::q4, -0.5, Start::steady),
                                           std::tuple(ShapeSet::h16, 0.5, Start::steady)));

// Lines of nodes are inserted at 0.5 m/s and removed at -0.5 m/s; forces are balanced after each
// change.
TEST(MotionGradient, HasTaylorRemaindersOfOrderTwoThroughChangesOfTheMesh) {
  for (const double speed : {0.5, -0.5}) {
    const Growing motion(ShapeSet::h16, speed, Start::prestretched);
    const MotionGradients found = motion.gradients();
    EXPECT_GE(found.motion.events.size(), 1U) << speed;
    const ScaleFactorGradient direction =
        random_direction(motion.scene.model.bodies()[0].factors, 7);
    for (size_t k = 0; k < motion.objectives.size(); ++k) {
      const double slope = product(found.of[k].d_factors[0], direction);
      const testing::Rate remainder =
          testing::fit_rate({1e-2, 3e-3, 1e-3, 3e-4, 1e-4, 3e-5, 1e-5}, [&](double by) {
            return std::abs(motion.values(direction, by)[k] - found.of[k].value - by * slope);
          });
      EXPECT_NEAR(remainder.order(), 2, 0.05) << speed << ", objective " << k << '\n'
                                              << remainder.table();
    }
  }
}

// A beam that is welded across the free end of the plate moves with it; the gradient includes the
// forces in the weld.
TEST(MotionGradient, PassesThroughAWeldBetweenBodies) {
  for (const Start start : {Start::rigid, Start::prestretched, Start::steady}) {
    Growing motion(ShapeSet::h16, 0, start);
    static constexpr double kOmega = 2 * std::numbers::pi, kTip = 0.5;
    // The relative round-off of values after Newton's method is 1e-12; weights of
    // first_difference() are (8 + 8 + 1 + 1)/12.
    constexpr double kStep = 2e-3, kRoundOff = 1.5e-12;
    const PlaneSection light{0.001, 1e8, 0.3, 2700};
    std::vector<std::unique_ptr<Term>> terms;
    terms.push_back(make_inertia(light));
    terms.push_back(make_beam_ecm(light));
    Workspace& model = motion.scene.model;
    model.add_body("beam", std::make_unique<AncfBeam>(0.2, 0.04, 3), light, std::move(terms));
    model.add_joint(make_body_weld("corner", {"plate", "free_end"}, {"beam", "root"},
                                   0.5 * std::numbers::pi, WeldMode::edge));
    motion.settings.body_poses = [](double t) {
      const Vec2 e(std::cos(kOmega * t), std::sin(kOmega * t)), n(-e.y(), e.x());
      FrameMotion f;
      f.origin = kTip * e;
      f.origin_rate = kTip * kOmega * n;
      f.origin_acceleration = -kTip * kOmega * kOmega * e;
      f.angle = kOmega * t + 0.5 * std::numbers::pi;
      f.angle_rate = kOmega;
      return std::vector<BodyPose>{{"beam", f, 0}};
    };
    motion.settings.end = 0.05;
    motion.settings.stops = {0.02, 0.05};
    motion.objectives.push_back(
        {measure_joint_force("corner", "beam"), MotionObjective::Times::steps, 4});
    const MotionGradients found = motion.gradients();
    const ScaleFactorGradient direction = random_direction(model.bodies()[0].factors, 5);
    const auto along = [&](double by) {
      const std::vector<double> v = motion.values(direction, by);
      return VectorXd(Eigen::Map<const VectorXd>(v.data(), static_cast<Eigen::Index>(v.size())));
    };
    const VectorXd there = along(0), differences = testing::first_difference(along, kStep);
    for (size_t k = 0; k < motion.objectives.size(); ++k) {
      const auto i = static_cast<Eigen::Index>(k);
      EXPECT_NEAR(found.of[k].value, there[i], 1e-12 * there[i]);
      EXPECT_NEAR(product(found.of[k].d_factors[0], direction), differences[i],
                  2e-6 * std::abs(differences[i]) + kRoundOff * there[i] / kStep)
          << "objective " << k;
    }
  }
}

// Stored states and states recomputed from checkpoints give equal gradients to the accuracy of the
// solutions.
TEST(MotionGradient, IsTheSameWithCheckpoints) {
  const Growing motion(ShapeSet::q4, 0.5, Start::prestretched);
  const MotionGradients kept = motion.gradients(), parts = motion.gradients(4);
  // The adjoint of a step is solved to 2e-13 of its right side with the present factor. Over 50
  // steps that is 1e-11, and up to ten times as much where an error is transferred through the next
  // steps.
  constexpr double kAllowed = 1e-10;
  for (size_t k = 0; k < kept.of.size(); ++k) {
    const ScaleFactorGradient &a = kept.of[k].d_factors[0], &b = parts.of[k].d_factors[0];
    EXPECT_EQ(kept.of[k].value, parts.of[k].value);
    EXPECT_LT((a.stiffness - b.stiffness).norm(), kAllowed * a.stiffness.norm());
    EXPECT_LT((a.mass - b.mass).norm(), kAllowed * a.mass.norm());
  }
}

}  // namespace
}  // namespace flexmorph::fem
