// Shows that rigid bodies and plates form one model: its matrix is the derivative of its residual,
// and a plate on a driven body moves like a plate in a driven hub.
#include <gtest/gtest.h>

#include <cmath>
#include <iostream>

#include "fem/dynamics/integrators/generalized_alpha.h"
#include "fem/dynamics/motion.h"
#include "fem/loads.h"
#include "fem/terms.h"
#include "tests/support/differences.h"
#include "tests/support/models.h"
#include "tests/support/rigid_models.h"

namespace flexmorph::fem {
namespace {

using testing::first_difference;
using testing::ShapeSet;

/// Returns a plate welded to a rigid body that has a hinge and an angle drive, or to a hub with
/// that motion.
Workspace plate_on_body(WeldMode mode, bool driven_hub = false) {
  Workspace model;
  PlaneSection soft{0.01, 1e8, 0.3, 2700};
  soft.youngs_modulus = 1e6;
  std::vector<std::unique_ptr<Term>> terms;
  terms.push_back(make_inertia(soft));
  terms.push_back(make_membrane(soft));
  terms.push_back(make_gravity(soft, Vec2(0, -9.81)));
  std::vector<MaterialLine> lines = {
      testing::swinging_line(0, 0.02, 1.3), {0.1, {}}, {0.2, {}}, {0.3, {}}};
  const auto add_plate = [&] {
    model.add_body("plate",
                   std::make_unique<AncfPlate>(2, ShapeSet::h16, lines,
                                               testing::uniform_lines(-0.05, 0.05, 1)),
                   soft, std::move(terms));
  };
  const auto alpha = [](double t) { return Motion{0.8 * t * t, 1.6 * t, 1.6}; };
  if (driven_hub) {
    add_plate();
    model.add_joint(make_weld(
        "weld", "plate", "root",
        [alpha](double t) {
          FrameMotion f;
          const Motion a = alpha(t);
          f.angle = a.value;
          f.angle_rate = a.rate;
          f.angle_acceleration = a.acceleration;
          f.origin = 0.2 * Vec2(std::cos(a.value), std::sin(a.value));
          const Vec2 n(-f.origin.y(), f.origin.x());
          f.origin_rate = a.rate * n;
          f.origin_acceleration = a.acceleration * n - a.rate * a.rate * f.origin;
          return f;
        },
        mode));
    return model;
  }
  testing::add_rigid(model, "hub", {2, {0.1, 0.02}, 0.3}, Vec2(0, -9.81));
  add_plate();
  model.add_joint(make_revolute("hinge", {}, {.body = "hub"}));
  model.add_joint(
      make_edge_weld("weld", "plate", "root", {.body = "hub", .point = {0.2, 0}}, mode));
  model.add_joint(make_angle_drive("drive", {}, {.body = "hub"}, alpha));
  return model;
}

// Both hubs have the same rotation, so that both plates must have the same motion, to the
// accumulated error of Newton's method over 40 steps.
TEST(PlateOnABody, MovesAsInADrivenHub) {
  for (const WeldMode mode : {WeldMode::edge, WeldMode::direction, WeldMode::full}) {
    VectorXd plates[2], rates[2];
    double torque = 0;
    for (const bool driven : {false, true}) {
      Workspace model = plate_on_body(mode, driven);
      AlphaSettings settings;
      settings.tolerance = 1e-14;
      GeneralizedAlpha alpha(model, settings);
      State x = model.reference();
      const Body& plate = model.body("plate");
      for (int k = 0; k < plate.element->n_vectors(); ++k)
        if (plate.element->is_position(k)) x.q[plate.first_dof + 2 * k] += 0.2;
      alpha.project_velocity(x);
      alpha.make_consistent(x);
      for (int k = 1; k <= 40; ++k) alpha.advance(x, 5e-3 * k, [](const State&) {});
      plates[driven] = x.q.segment(plate.first_dof, plate.n_dofs());
      rates[driven] = x.v.segment(plate.first_dof, plate.n_dofs());
      if (!driven) torque = x.lambda[model.first_row(3)];
    }
    EXPECT_LT((plates[0] - plates[1]).cwiseAbs().maxCoeff(), 1e-11);
    EXPECT_LT((rates[0] - rates[1]).cwiseAbs().maxCoeff(), 1e-8);
    EXPECT_GT(std::abs(torque), 0.1);
  }
}

// The weld acts on plate and hub with opposite forces and opposite moments about any point.
TEST(PlateOnABody, WeldActsAndReacts) {
  for (const WeldMode mode : {WeldMode::edge, WeldMode::direction, WeldMode::full}) {
    Workspace model = plate_on_body(mode);
    GeneralizedAlpha alpha(model, {});
    State x = model.reference();
    const Body& plate = model.body("plate");
    for (int k = 0; k < plate.element->n_vectors(); ++k)
      if (plate.element->is_position(k)) x.q[plate.first_dof + 2 * k] += 0.2;
    alpha.project_velocity(x);
    alpha.make_consistent(x);
    for (int k = 1; k <= 20; ++k) alpha.advance(x, 5e-3 * k, [](const State&) {});
    const Wrench on_plate = model.joint_wrench(2, "plate", {0.3, -0.7, 0}, x),
                 on_hub = model.joint_wrench(2, "hub", {0.3, -0.7, 0}, x);
    EXPECT_GT(on_plate.force.norm(), 1);
    EXPECT_LT((on_plate.force + on_hub.force).norm(), 1e-12 * on_plate.force.norm());
    EXPECT_LT((on_plate.moment + on_hub.moment).norm(), 1e-12 * on_plate.moment.norm());
    // The drive acts on the hub with a moment that does not depend on the reference point, and
    // without a force.
    const Wrench motor = model.joint_wrench(3, "hub", {-2, 1, 0}, x);
    EXPECT_NEAR(motor.moment.z(), x.lambda[model.first_row(3)], 1e-9);
    EXPECT_LT(motor.force.norm(), 1e-12);
  }
}

// Both plates must also agree while the plate slides out of its hub and one line is inserted.
TEST(PlateOnABody, GrowsAsOutOfADrivenHub) {
  testing::RotatingPlate plate;
  plate.speed = 1;
  plate.nx = 6;
  plate.ny = 1;
  plate.tip_mass = 0;
  VectorXd plates[2];
  size_t events = 0;
  for (const bool driven : {false, true}) {
    testing::Scene scene = testing::make_scene(plate);
    if (!driven) {
      // The plate is welded to a rotating rigid hub instead.
      Workspace model;
      Body& old = scene.model.bodies()[0];
      std::vector<std::unique_ptr<Term>> terms;
      for (BodyTerm& term : old.terms) terms.push_back(std::move(term.term));
      model.add_body("plate", std::move(old.element), plate.section, std::move(terms));
      testing::add_rigid(model, "hub", {2, {0.1, 0.02}, 0.3});
      model.add_joint(make_edge_weld("root", "plate", "root", {.body = "hub"}, plate.weld));
      model.add_joint(make_revolute("axis", {}, {.body = "hub"}));
      model.add_joint(make_angle_drive("drive", {}, {.body = "hub"}, [plate](double t) {
        return Motion{plate.omega * t, plate.omega, 0};
      }));
      scene.model = std::move(model);
    }
    MotionSettings settings;
    settings.end = 0.12;
    settings.step = 2e-3;
    settings.start = Start::rigid;
    settings.alpha.tolerance = 1e-14;
    const MotionResult result =
        integrate(scene.model, scene.moving_roots, settings, [](const MotionStep&) {});
    events = result.events.size();
    const Body& body = scene.model.body("plate");
    plates[driven] = result.final.q.segment(body.first_dof, body.n_dofs());
    EXPECT_LT(result.constraint_drift, 1e-12);
  }
  EXPECT_EQ(events, 1U);
  ASSERT_EQ(plates[0].size(), plates[1].size());
  const double apart = (plates[0] - plates[1]).cwiseAbs().maxCoeff();
  std::cout << "plates on body and in driven hub are " << apart << " apart\n";
  EXPECT_LT(apart, 1e-10);
}
/// Returns a model with joints and force elements of many kinds; its constraints are not satisfied.
Workspace zoo() {
  Workspace model = plate_on_body(WeldMode::direction);
  testing::add_rigid(model, "tip", {0.5, {0.1, -0.2}, 0.04}, Vec2(0, -9.81));
  testing::add_rigid(model, "slide", {0.7, {0, 0.1}, 0.1});
  const MarkerLocation tip{.body = "tip", .point = {0.1, 0.1}, .angle = 0.4};
  model.add_joint(make_revolute("r", {.body = "plate", .point = {0.3, 0.05}}, tip));
  model.add_joint(make_slider("s", {.body = "hub", .point = {0, 0.2}}, {.body = "slide"}));
  model.add_joint(make_distance("d", tip, {.body = "slide", .point = {0.2, 0}}, [](double) {
    return Motion{0.4, 0, 0};
  }));
  model.add_force_element(make_spring("k", tip, {.point = {1, 1}}, {20, 3, 0.5}));
  model.add_force_element(make_torsion_spring("t", tip, {.body = "slide"}, {2, 0.3, 0.1}));
  model.add_force_element(make_torque("m", {.body = "slide"}, 0.7));
  model.add_force_element(make_point_force("f", {.body = "plate", .point = {0.25, 0}}, Vec2(1, 2)));
  return model;
}

TEST(Zoo, MatrixIsTheDerivativeOfTheResidual) {
  Workspace model = zoo();
  State x = model.reference();
  x.q += 0.1 * VectorXd::Random(model.n_dofs());
  x.v.setRandom();
  x.a.setRandom();
  x.lambda.setRandom();
  x.t = 0.4;
  model.prepare(x);
  const VectorXd direction = VectorXd::Random(model.n_dofs()),
                 multipliers = VectorXd::Random(model.n_constraints());
  const Weights w{0.9, 1.7, 2.3};
  const double scale = 0.3;
  Constraints c;
  const auto residual = [&](double by) {
    State y = x;
    y.q += by * w.q * direction;
    y.v += by * w.v * direction;
    y.a += by * w.a * direction;
    y.lambda += by / scale * multipliers;
    Constraints at;
    model.constraints(y, at);
    VectorXd force;
    model.force(y, force);
    model.add_constraint_force(at, y.lambda, force);
    VectorXd out(model.n_dofs() + model.n_constraints());
    out << scale * force, at.value / w.q;
    return out;
  };
  model.constraints(x, c);
  SparseMatrix kkt;
  model.kkt(x, c, w, scale, kkt);
  VectorXd right(kkt.rows());
  right << direction, multipliers;
  const VectorXd difference = first_difference(residual, 1e-3);
  EXPECT_LT((kkt * right - difference).norm(), 1e-8 * difference.norm());
}

// All bodies move with one velocity; the momentum is this velocity times their mass.
TEST(Zoo, MomentumIsThatOfItsBodies) {
  Workspace model = zoo();
  model.prepare(0.0);
  State x = model.reference();
  x.v.setConstant(0);
  const Vec2 velocity(0.3, -0.8);
  for (const Body& b : model.bodies())
    for (int k = 0; k < b.element->n_vectors(); ++k)
      if (b.element->is_position(k)) x.v.segment<2>(b.first_dof + 2 * k) = velocity;
  const PlaneSection s{0.01, 1e8, 0.3, 2700};
  const double mass = 2 + 0.5 + 0.7 + s.density * s.thickness * 0.3 * 0.1;
  // The root line oscillates, so that material flows through nodes without velocity.
  const Vec3 all = model.momentum(x);
  State still = x;
  still.v.setZero();
  const Vec3 flow = model.momentum(still);
  EXPECT_LT((all - flow - mass * Vec3(velocity.x(), velocity.y(), 0)).norm(), 1e-13);
}

}  // namespace
}  // namespace flexmorph::fem
