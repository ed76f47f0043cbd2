// Shows that loads of case files on rigid bodies, beams and plates are correct, constant or driven,
// with fixed or following direction: motions against closed forms, deflections against textbook
// formulas, and the energy balance.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "cases/assembly/build.h"
#include "fem/solve/statics.h"
#include "io/files.h"
#include "tests/cases/scene/loaded_scenes.h"
#include "tests/support/errors.h"
#include "tests/support/rates.h"

namespace flexmorph::cases {
namespace {

/// A body of 2 kg and 0.5 kg m^2 that moves freely from the origin.
const std::string kFlying = R"toml(
[time]
end = 1.0
step = 0.01
start = "rigid"

[[rigid_body]]
name = "body"
mass = 2.0
inertia = 0.5
size = [0.2, 0.1]
velocity = [0.0, 0.0]
angular_velocity = 0.0
)toml";

struct Followed {
  double error = 0, energy_error = 0;
};

/// Returns the largest value of `error` during a motion, and the energy error.
Followed follow(const Scene& scene, const std::function<double(const fem::MotionStep&)>& error) {
  Mechanism m = build_mechanism(scene);
  Followed out;
  out.energy_error =
      fem::integrate(m.model, m.moving_roots, m.motion, [&](const fem::MotionStep& step) {
        out.error = std::max(out.error, error(step));
      }).energy_error;
  return out;
}

/// Expects that errors of the motion and energy errors are of order 2 in the step.
void expect_order_two(const std::string& text,
                      const std::function<double(const fem::MotionStep&)>& error,
                      const Changes& changes = {}) {
  testing::Rate errors, energy_errors;
  for (const double h : {0.02, 0.01, 0.005}) {
    Changes all = changes;
    all.push_back("time.step=" + io::to_text(h));
    const Followed found = follow(scene_of(text, all), error);
    for (auto [rate, value] :
         {std::pair{&errors, found.error}, {&energy_errors, found.energy_error}}) {
      rate->step.push_back(h);
      rate->error.push_back(value);
    }
  }
  EXPECT_NEAR(errors.order(), 2, 0.1) << errors.table();
  EXPECT_GT(energy_errors.order(), 1.9) << energy_errors.table();
  EXPECT_LT(energy_errors.error.back(), 1e-3) << energy_errors.table();
}

double angle_miss(const fem::State& x, double angle) {
  return std::abs(std::remainder(std::atan2(x.q[3], x.q[2]) - angle, 2 * std::numbers::pi));
}

// Reference: T = 3 sin 4t on 0.5 kg m^2 turns the body by the double integral, 6/4 (t - sin(4t)/4).
TEST(Loads, DrivenTorqueTurnsARigidBody) {
  expect_order_two(
      kFlying + drive("T", "3*sin(4*t)") + load("torque", "body = \"body\"\ntorque = \"T\""),
      [](const fem::MotionStep& s) {
        const double t = s.x.t;
        return angle_miss(s.x, 1.5 * (t - std::sin(4 * t) / 4));
      });
}

// An oscillating force begins at 0.31415 s, between two steps. Reference: x is its double integral.
// The y component is a constant force.
TEST(Loads, DrivenForceMovesARigidBody) {
  const double t0 = 0.31415, w = 7;
  const std::string text = kFlying + drive("F", "step(t - 0.31415)*cos(7*(t - 0.31415))") +
                           load("point", "body = \"body\"\nforce = [\"F\", -3.0]");
  expect_order_two(text, [=](const fem::MotionStep& s) {
    const double t = s.x.t, tau = std::max(0.0, t - t0);
    return (s.x.q.head<2>() - Vec2((1 - std::cos(w * tau)) / (2 * w * w), -0.75 * t * t)).norm();
  });
  // Energy-momentum steps use the mean value of a step, therefore the balance is exact for a linear
  // force.
  const Scene scene = scene_of(
      kFlying + drive("F", "3*t - 1") + load("point", "body = \"body\"\nforce = [\"F\", 0]"),
      {"time.integrator=energy_momentum"});
  EXPECT_LT(follow(scene, [](const fem::MotionStep&) { return 0.0; }).energy_error, 1e-12);
}

// A force that turns with a body rotating at w. Reference: the velocity is F/(m w) (sin wt, 1 - cos
// wt).
TEST(Loads, TurningForceCarriesASpinningBodyAlongACircle) {
  const double w = 3;
  expect_order_two(kFlying + load("point", "body = \"body\"\nforce = [4.0, 0.0]\nturns = true"),
                   [=](const fem::MotionStep& s) {
                     const double t = s.x.t;
                     const Vec2 v(std::sin(w * t), 1 - std::cos(w * t));
                     return (s.x.v.head<2>() - 4 / (2 * w) * v).norm();
                   },
                   {"rigid_body.body.angular_velocity=3"});
}

// The force acts away from the centre of mass and turns with the body, therefore its moment M = F d
// is constant.
TEST(Loads, TurningForceOffTheCentreTurnsEvenly) {
  const Scene scene = scene_of(kFlying + load("point",
                                              "body = \"body\"\npoint = [0.0, 0.25]\nforce = "
                                              "[-4.0, 0.0]\nturns = true"));
  const Followed found = follow(scene, [](const fem::MotionStep& s) {
    return angle_miss(s.x, 0.5 * (4 * 0.25 / 0.5) * s.x.t * s.x.t);
  });
  EXPECT_LT(found.error, 1e-4);
  EXPECT_LT(found.energy_error, 1e-4);
}

// A mass of 3 kg at 0.4 m on a body that rotates about its centre. Reference: I = 0.5 + 3 0.4^2,
// and only the weight of the mass has a moment.
TEST(Loads, PointMassOnARigidBodyIsPartOfItsInertia) {
  const std::string text =
      "gravity = [0.0, -9.81]\n" + kFlying +
      "\n[[joint]]\ntype = \"revolute\"\nname = \"pivot\"\na = \"ground\"\npoint_a = [0, 0]\nb = "
      "\"body\"\n\n[[point_mass]]\nbody = \"body\"\npoint = [0.4, 0.0]\nmass = 3.0\n";
  const Scene scene = scene_of(
      text, {"rigid_body.body.velocity=", "rigid_body.body.angular_velocity=", "time.end=0.01"});
  Mechanism m = build_mechanism(scene);
  double first = 0, weight = 0;
  fem::integrate(m.model, m.moving_roots, m.motion, [&](const fem::MotionStep& s) {
    if (s.x.t > 0) return;
    first = s.x.a[3];  // derivative of the axis (1, 0)
    const auto wrench = s.model.joint_wrench(0, "body", Vec3::Zero(), s.x);
    const auto other = s.model.joint_wrench(1, "body", Vec3::Zero(), s.x);
    weight = wrench.force.y() + other.force.y();
  });
  const double inertia = 0.5 + 3 * 0.16, alpha = -3 * 9.81 * 0.4 / inertia;
  EXPECT_NEAR(first, alpha, 1e-12 * 10);
  EXPECT_NEAR(weight, 5 * 9.81 + 3 * 0.4 * alpha, 1e-11 * 50);  // rate of change of the momentum
}

// A static pendulum hangs vertically; the reaction of its pivot is m g(t).
TEST(Loads, DrivenGravityIsHeldByThePivot) {
  const std::string text =
      "gravity = [0.0, \"g\"]\n" + kFlying + drive("g", "-9.81*(1 + 0.5*sin(20*t))") +
      "\n[[joint]]\ntype = \"revolute\"\nname = \"pivot\"\na = \"ground\"\npoint_a = [0, 0.5]\nb = "
      "\"body\"\npoint_b = [0.0, 0.5]\n";
  const Scene scene =
      scene_of(text, {"rigid_body.body.velocity=", "rigid_body.body.angular_velocity="});
  EXPECT_NEAR((*scene.gravity)[1], -9.81, 1e-15);
  const Followed found = follow(scene, [&](const fem::MotionStep& s) {
    double force = 0;
    for (size_t i = 0; i < s.model.joints().size(); ++i)
      force += s.model.joint_wrench(i, "body", Vec3::Zero(), s.x).force.y();
    return std::abs(force - 2 * 9.81 * (1 + 0.5 * std::sin(20 * s.x.t)));
  });
  EXPECT_LT(found.error, 1e-9);
}

// The energy error decreases with the square of the step while material flows, for driven loads and
// gravity: their power acts on the unknowns only.
TEST(Loads, BalanceOfEnergyHoldsWhileMaterialFlows) {
  const std::string f = drive("f", "20*sin(9*t)");
  const std::vector<std::pair<std::string, std::string>> all = {
      {"gravity = [\"f\", -3.0]\n", ""},
      {"gravity = [\"f\", 0]\n",
       "\n[[point_mass]]\nbody = \"plate\"\npoint = [0.4, 0.02]\nmass = 0.1\n"},
      {"", load("surface", "body = \"plate\"\nforce = [0.0, \"f\"]")},
      {"", load("surface", "body = \"plate\"\nforce = [0.0, \"f\"]\nturns = true")},
      {"",
       load("edge", "body = \"plate\"\nedge = \"free_end\"\nforce = [1.0, \"f\"]\nturns = true")},
      {"", load("point", "body = \"plate\"\npoint = [0.3, 0.01]\nforce = [1.0, \"f\"]")},
      {"", load("torque", "body = \"plate\"\npoint = [0.4, 0.0]\ntorque = \"f\"")}};
  for (const auto& [top, loads] : all) {
    testing::Rate energy_errors;
    for (const double h : {2e-3, 1e-3, 5e-4}) {
      energy_errors.step.push_back(h);
      energy_errors.error.push_back(
          follow(scene_of(top + kPlate + f + loads, {"time.step=" + io::to_text(h)}),
                 [](const fem::MotionStep&) { return 0.0; })
              .energy_error);
    }
    EXPECT_NEAR(energy_errors.order(), 2, 0.25) << top << loads << energy_errors.table();
    EXPECT_LT(energy_errors.error.back(), 1e-3) << top << loads << energy_errors.table();
  }
}

// The energy balance also contains the power of loads that follow a plate in space: a pressure and
// an edge moment.
TEST(Loads, BalanceOfEnergyHoldsUnderLoadsThatFollowAPlate) {
  const std::string plate = R"toml(
[time]
end = 0.1
rho_inf = 0.9

[[body]]
name = "plate"
element = "ancf_plate"
space = "space"
terms = ["inertia", "membrane", "bending"]
length = 0.4
width = 0.1
thickness = 0.01
density = 1000.0
youngs_modulus = 1e6
poisson_ratio = 0.3
elements = [3, 1]

[[joint]]
type = "clamp"
body = "plate"
edges = ["root"]
)toml";
  for (const std::string& loads :
       {load("pressure", "body = \"plate\"\npressure = \"f\""),
        load("edge_moment", "body = \"plate\"\nedge = \"free_end\"\nmoment = 0.2")}) {
    testing::Rate energy_errors;
    for (const double h : {2e-3, 1e-3, 5e-4}) {
      energy_errors.step.push_back(h);
      energy_errors.error.push_back(follow(scene_of(plate + drive("f", "40*sin(20*t)") + loads,
                                                    {"time.step=" + io::to_text(h)}),
                                           [](const fem::MotionStep&) { return 0.0; })
                                        .energy_error);
    }
    EXPECT_NEAR(energy_errors.order(), 2, 0.3) << loads << energy_errors.table();
    EXPECT_LT(energy_errors.error.back(), 2e-3) << loads << energy_errors.table();
  }
}

// An equivalent static load contains the force at its own time.
TEST(Loads, EquivalentStaticLoadsHaveTheForceOfTheirTime) {
  const Scene scene =
      scene_of(kPlate + drive("f", "20*t") +
               load("edge", "body = \"plate\"\nedge = \"free_end\"\nforce = [1.0, \"f\"]"));
  for (const double t : {0.05, 0.1}) {
    const auto forces = applied_forces(scene, "plate", t);
    ASSERT_EQ(forces.size(), 1u);
    EXPECT_NEAR(forces[0].force.y(), 0.1 * 20 * t, 1e-15);
  }
}

// The prestretched start is an equilibrium under the loads at t = 0: under a force along the plate
// its length follows from Hooke's law, and remains constant because the force is constant.
TEST(Loads, PrestretchedStartsHaveTheLoadOfTheStart) {
  const Scene scene =
      scene_of(kPlate + drive("f", "100 + 0*t") +
                   load("edge", "body = \"plate\"\nedge = \"free_end\"\nforce = [\"f\", 0]"),
               {"time.start=prestretched", "hub.hub.angular_velocity=0", "body.plate.flow=",
                "body.plate.element=ancf_plate", "body.plate.poisson_ratio=0", "time.end=0.05"});
  // The force per length is 100 = E h e (1 + e/2) (1 + e) for Green's strain.
  double lambda = 1;
  for (int k = 0; k < 50; ++k) lambda = std::sqrt(1 + 2 * 100 / (1e7 * 0.01 * lambda));
  const Followed found = follow(scene, [&](const fem::MotionStep& s) {
    return std::abs(fem::point_position(s.model.body("plate"), s.x, {0.4, 0}).x() - 0.4 * lambda);
  });
  EXPECT_LT(found.error, 1e-10);
}

struct BadLoad {
  std::string text;
  std::vector<std::string> parts;
};
TEST(Loads, AreRefusedWithTheirLocation) {
  const std::string f = drive("f", "t");
  const std::vector<BadLoad> wrong = {
      {kFlying + load("point", "body = \"body\"\nforce = [\"f\", 0]"),
       {"load.force = [\"f\", 0]", "drive"}},
      {kFlying + f + load("point", "body = \"body\"\nforce = [\"g\", 0]"),
       {"load.force = [\"g\", 0]", "'f'"}},
      {kFlying + load("point", "body = \"body\"\nforce = [1]"),
       {"load.force = [1]", "list of 2", "[N]"}},
      {kFlying + load("point", "body = \"bode\"\nforce = [1, 0]"), {"load.body = \"bode\""}},
      {kFlying + load("surface", "body = \"body\"\nforce = [1, 0]"),
       {"load.body = \"body\"", "rigid body"}},
      {kFlying + load("torque", "body = \"body\"\ntorque = 1\npoint = [0, 1]"),
       {"load.point = [0, 1]", "torque"}},
      {kFlying + "\n[[point_mass]]\nbody = \"body\"\nmass = 1.0\n",
       {"point_mass.point", "missing"}},
      {kPlate + load("line", "body = \"plate\"\nforce = [1, 0]"),
       {"load.type = \"line\"", "beams"}},
      {kCantilever + load("surface", "body = \"rod\"\nforce = [1, 0]"),
       {"load.type = \"surface\"", "point", "line", "torque"}},
      {kPlate + "\n[[point_mass]]\nbody = \"plate\"\nmass = 1.0\n",
       {"point_mass", "free_end", "`point`"}},
      {"gravity = [\"f\", \"no\"]\n" + kPlate + f, {"gravity = [\"f\", \"no\"]", "'f'"}},
      {"[time]\nend = 1\nintegrator = \"energy_momentum\"\n" +
           kFlying.substr(kFlying.find("[[rigid_body]]")) +
           load("point", "body = \"body\"\nforce = [1, 0]\nturns = true"),
       {"load.type = \"point\"", "time.integrator", "generalized_alpha"}},
      {kCantilever + load("point", "body = \"rod\"\npoint = [1, 0]\nforce = [\"f\", 0]"),
       {"load.force = [\"f\", 0]", "drive"}},
  };
  for (const auto& [text, parts] : wrong) {
    const std::string said = complaint(text);
    EXPECT_TRUE(contains(said, "case.toml:"));
    EXPECT_TRUE(testing::mentions_all(said, parts));
  }
}

}  // namespace
}  // namespace flexmorph::cases
