// Shows that linear momentum, angular momentum and energy are conserved while material is stored in
// a free body, leaves it or returns, and that the matrices are derivatives of the residual.
#include "fem/material_reservoir.h"

#include <gtest/gtest.h>

#include <cmath>

#include "fem/dynamics/integrators/generalized_alpha.h"
#include "fem/dynamics/total_momentum.h"
#include "fem/loads.h"
#include "fem/solve/assembly.h"
#include "fem/terms.h"
#include "tests/support/differences.h"
#include "tests/support/energy_rate.h"
#include "tests/support/models.h"
#include "tests/support/rigid_models.h"

namespace flexmorph::fem {
namespace {

using testing::first_difference;
using Kind = MaterialReservoir::Kind;

struct Boom {
  Kind kind;
  Vec2 outlet;
  double angle;
  Vec2 at;
  WeldMode mode = WeldMode::edge;
  testing::ShapeSet shapes = testing::ShapeSet::h16;
};

/// Returns a free body with booms whose roots oscillate through the material and 0.5 m of stored
/// material for each boom.
Workspace satellite(const std::vector<Boom>& booms, const VectorXd& gravity = {}) {
  Workspace model;
  PlaneSection soft{0.01, 1e8, 0.3, 2700};
  soft.youngs_modulus = 1e6;
  std::vector<MaterialReservoir> all;
  for (const Boom& boom : booms)
    all.push_back({.kind = boom.kind,
                   .outlet = boom.outlet,
                   .angle = boom.angle,
                   .at = boom.at,
                   .width = 0.1,
                   .area_density = soft.density * soft.thickness,
                   .length = [root = testing::swinging_line(0, 0.05, 1.3).drive](double t) {
                     const Motion m = root(t);
                     return Motion{0.5 + m.value, m.rate, m.acceleration};
                   }});
  std::vector<std::unique_ptr<Term>> own;
  const RigidSection section{20, {0.1, 0.02}, 0.3};
  own.push_back(make_rigid_inertia(section));
  if (gravity.size() > 0) own.push_back(make_rigid_gravity(section, gravity));
  for (const MaterialReservoir& stored : all) {
    own.push_back(make_reservoir_inertia(stored));
    if (gravity.size() > 0) own.push_back(make_reservoir_weight(stored, gravity));
  }
  model.add_body("hub", std::make_unique<RigidBody>(0.2, true), {}, std::move(own));
  model.add_joint(make_unit_axis("axis", "hub"));
  for (size_t i = 0; i < booms.size(); ++i) {
    const Boom& boom = booms[i];
    const std::string name = "boom " + std::to_string(i);
    std::vector<std::unique_ptr<Term>> terms;
    terms.push_back(make_inertia(soft));
    terms.push_back(make_membrane(soft));
    if (gravity.size() > 0) terms.push_back(make_gravity(soft, gravity));
    std::vector<MaterialLine> lines = {testing::swinging_line(0, 0.05, 1.3), {0.15, {}}, {0.3, {}}};
    model.add_body(name,
                   std::make_unique<AncfPlate>(2, boom.shapes, std::move(lines),
                                               testing::uniform_lines(-0.05, 0.05, 2)),
                   soft, std::move(terms));
    model.add_joint(make_edge_weld("weld " + name, name, "root",
                                   {.body = "hub", .point = boom.outlet, .angle = boom.angle},
                                   boom.mode));
    model.add_force_element(make_outlet("outlet " + name, "hub", name, all[i]));
  }
  return model;
}

std::vector<std::vector<Boom>> satellites() {
  const Boom coil{Kind::coil, {0.3, 0.05}, 0, {0.3, 0.05}},
      far_coil{Kind::coil, {-0.3, 0.1}, 2.5, {0.1, -0.2}, WeldMode::direction},
      rod{Kind::rod, {0.3, 0.05}, 0.2, {0.3, 0.05}},
      far_rod{Kind::rod, {0, 0.4}, 1.6, {0.1, 0.2}, WeldMode::full, testing::ShapeSet::h12};
  return {{coil}, {far_coil}, {rod}, {far_rod}, {coil, far_coil}, {rod, far_rod}, {coil, far_rod}};
}

/// Returns the state in which slightly bent and stretched booms are at their outlets, and
/// everything moves and rotates with the body.
State moving(Workspace& model, const std::vector<Boom>& booms, double t) {
  model.prepare(t);
  State x = model.reference();
  x.t = t;
  const testing::Pose pose{{0.4, -0.3}, 0.7, {0.2, 0.5}, 1.9};
  std::srand(5);
  x.q += 1e-3 * VectorXd::Random(model.n_dofs());
  const Eigen::Rotation2Dd turn(pose.angle);
  for (size_t i = 0; i < booms.size(); ++i) {
    const Body& plate = model.body("boom " + std::to_string(i));
    for (int k = 0; k < plate.element->n_vectors(); ++k) {
      const int at = plate.first_dof + 2 * k;
      const bool is_position = plate.element->is_position(k);
      Vec2 r = x.q.segment<2>(at);
      if (is_position) r.x() -= 0.05 * std::sin(1.3 * t);  // moves the root to the outlet
      r = Eigen::Rotation2Dd(booms[i].angle) * r;
      if (is_position) r += booms[i].outlet;
      r = turn * r;
      x.v.segment<2>(at) = pose.angle_rate * Vec2(-r.y(), r.x());
      if (is_position) x.v.segment<2>(at) += pose.velocity;
      x.q.segment<2>(at) = r;
      if (is_position) x.q.segment<2>(at) += pose.r;
    }
  }
  x.v += 1e-2 * VectorXd::Random(model.n_dofs());
  testing::put(model, "hub", pose, x);
  assemble(model, x);
  return x;
}

// The time derivative of the total momentum vanishes in the motion that the equations of motion
// begin, for material that flows out or in with any acceleration, to the round-off of a difference
// (the bent booms have accelerations of 1e7).
TEST(MaterialReservoir, KeepsLinearAndAngularMomentum) {
  for (const auto& booms : satellites())
    for (const double t : {0.3, 1.5, 3.1}) {  // outward, inward, and outward with growing speed
      Workspace model = satellite(booms);
      State x = moving(model, booms, t);
      GeneralizedAlpha alpha(model, {});
      alpha.project_velocity(x);
      alpha.make_consistent(x);
      const auto momentum = [&](double dt) {
        State y = x;
        y.t += dt;
        y.q += dt * x.v + 0.5 * dt * dt * x.a;
        y.v += dt * x.a;
        model.prepare(y);
        const TotalMomentum all = total_momentum(model, y);
        return Vec3(all.linear.x(), all.linear.y(), all.angular);
      };
      const Vec3 rate = first_difference(momentum, 1e-4);
      EXPECT_GT(momentum(0).norm(), 1);
      EXPECT_LT(rate.norm(), 5e-10 * momentum(0).norm()) << booms.size() << " booms, t = " << t;
    }
}

// For a coil at the outlet, material that leaves is accelerated to the feed speed s; the reaction
// on the body is -ρA s².
TEST(MaterialReservoir, OutletReactsWithTheMomentumThatLeaves) {
  const std::vector<Boom> booms = {{Kind::coil, {0.3, 0}, 0, {0.3, 0}}};
  Workspace model = satellite(booms);
  State x = moving(model, booms, 0.3);
  const Body& hub = model.body("hub");
  VectorXd force = VectorXd::Zero(model.n_dofs());
  model.force_elements()[0]->bind(std::vector<BodyView>{
      {&hub.name, hub.element.get(), hub.first_dof},
      {&model.bodies()[1].name, model.bodies()[1].element.get(), model.bodies()[1].first_dof}});
  model.force_elements()[0]->add_force(x, force);
  // The reaction is -ρA s² along the outlet (positive here, because forces are on the left side of
  // the equations), except for the stretch of the root, which the 5 % allow for.
  const double s = -testing::swinging_line(0, 0.05, 1.3).drive(0.3).rate;
  const PlaneSection plate{0.01, 1e8, 0.3, 2700};
  const Vec2 along(std::cos(0.7), std::sin(0.7));
  EXPECT_NEAR(force.segment<2>(hub.first_dof).dot(along),
              plate.density * plate.thickness * 0.1 * s * s,
              0.05 * plate.density * plate.thickness * 0.1 * s * s);
}

TEST(MaterialReservoir, MatrixIsTheDerivativeOfTheResidual) {
  for (const auto& booms : satellites()) {
    Workspace model = satellite(booms, Vec2(0.4, -9.81));
    State x = moving(model, booms, 0.4);
    x.a.setRandom();
    x.lambda = VectorXd::Random(model.n_constraints());
    const VectorXd direction = VectorXd::Random(model.n_dofs());
    const Weights w{0.9, 1.7, 2.3};
    const auto residual = [&](double by) {
      State y = x;
      y.q += by * w.q * direction;
      y.v += by * w.v * direction;
      y.a += by * w.a * direction;
      Constraints at;
      model.constraints(y, at);
      VectorXd force;
      model.force(y, force);
      model.add_constraint_force(at, y.lambda, force);
      return force;
    };
    Constraints c;
    model.constraints(x, c);
    SparseMatrix kkt;
    model.kkt(x, c, w, 1, kkt);
    VectorXd right = VectorXd::Zero(kkt.rows());
    right.head(model.n_dofs()) = direction;
    const VectorXd difference = first_difference(residual, 1e-3);
    EXPECT_LT((VectorXd(kkt * right).head(model.n_dofs()) - difference).norm(),
              1e-8 * difference.norm());
  }
}

// For any motion, a solution or not, the energy changes by the work of the forces on the unknowns
// and by the powers of feeding, of entering material and of the outlets.
TEST(MaterialReservoir, EnergyChangesByThePowers) {
  for (const auto& booms : satellites())
    for (const bool heavy : {false, true}) {
      Workspace model = satellite(booms, heavy ? VectorXd(Vec2(0.4, -9.81)) : VectorXd());
      const testing::SmoothMotion motion = testing::any_motion(model);
      const testing::EnergyRate e = testing::energy_rate(model, motion, 0.4);
      // e.work contains the forces of the outlets.
      const double missing = e.rate - e.work - e.powers.total();
      EXPECT_LT(std::abs(missing), 1e-8 * (std::abs(e.rate) + std::abs(e.work)));
    }
}

TEST(MaterialReservoir, RefusesWhatItCannotBe) {
  MaterialReservoir stored{
      .width = 0.1, .area_density = 0, .length = [](double) { return Motion{}; }};
  EXPECT_THROW(make_reservoir_inertia(stored), Error);
  EXPECT_THROW(make_outlet("outlet", "hub", "boom", stored), Error);
  stored.area_density = 1;
  EXPECT_THROW(make_reservoir_weight(stored, Vec3(0, 0, 1)), Error);
  Workspace model;
  model.add_body("still", std::make_unique<RigidBody>(1), {}, {});
  EXPECT_THROW(make_reservoir_inertia(stored)->prepare(*model.body("still").element, {}, true),
               Error);
  EXPECT_THROW(model.add_force_element(make_outlet("outlet", "still", "still", stored)), Error);
}

}  // namespace
}  // namespace flexmorph::fem
