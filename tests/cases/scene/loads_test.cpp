// Loads of case files, constant or driven, that turn with their body or not, on rigid bodies, beams
// and plates: motions against closed forms, deflections against textbooks, the balance of energy.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "cases/assembly/build.h"
#include "fem/solve/statics.h"
#include "io/files.h"
#include "tests/cases/scene/loaded_scenes.h"
#include "tests/support/rates.h"

namespace flexmorph::cases {
namespace {

constexpr double kPi = std::numbers::pi;

/// A body of 2 kg and 0.5 kg m^2 that flies from the origin.
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
  double error = 0, defect = 0;
};

/// The largest error of what a motion shows.
Followed follow(const Scene& scene, const std::function<double(const fem::MotionStep&)>& error) {
  Mechanism m = build_mechanism(scene);
  Followed out;
  out.defect = fem::integrate(m.model, m.growths, m.motion, [&](const fem::MotionStep& step) {
                 out.error = std::max(out.error, error(step));
               }).energy_defect;
  return out;
}

/// Errors and defects of energy are of order 2 in the step.
void expect_order_two(const std::string& text,
                      const std::function<double(const fem::MotionStep&)>& error,
                      const Changes& changes = {}) {
  testing::Rate errors, defects;
  for (const double h : {0.02, 0.01, 0.005}) {
    Changes all = changes;
    all.push_back("time.step=" + io::to_text(h));
    const Followed found = follow(scene_of(text, all), error);
    for (auto [rate, value] : {std::pair{&errors, found.error}, {&defects, found.defect}}) {
      rate->step.push_back(h);
      rate->error.push_back(value);
    }
  }
  EXPECT_NEAR(errors.order(), 2, 0.1) << errors.table();
  EXPECT_GT(defects.order(), 1.9) << defects.table();
  EXPECT_LT(defects.error.back(), 1e-3) << defects.table();
}

double angle_miss(const fem::State& x, double angle) {
  return std::abs(std::remainder(std::atan2(x.q[3], x.q[2]) - angle, 2 * kPi));
}

// T = 3 sin 4t on 0.5 kg m^2: the angle is the double integral, 6/4 (t - sin(4t)/4).
TEST(Loads, DrivenTorqueTurnsARigidBody) {
  expect_order_two(
      kFlying + drive("T", "3*sin(4*t)") + load("torque", "body = \"body\"\ntorque = \"T\""),
      [](const fem::MotionStep& s) {
        const double t = s.x.t;
        return angle_miss(s.x, 1.5 * (t - std::sin(4 * t) / 4));
      });
}

// A force that begins at 0.31415 s, between two steps, and swings: x is its double integral. In the
// same motion a constant number stands beside it.
TEST(Loads, DrivenForceMovesARigidBody) {
  const double t0 = 0.31415, w = 7;
  const std::string text = kFlying + drive("F", "step(t - 0.31415)*cos(7*(t - 0.31415))") +
                           load("point", "body = \"body\"\nforce = [\"F\", -3.0]");
  expect_order_two(text, [=](const fem::MotionStep& s) {
    const double t = s.x.t, tau = std::max(0.0, t - t0);
    return (s.x.q.head<2>() - Vec2((1 - std::cos(w * tau)) / (2 * w * w), -0.75 * t * t)).norm();
  });
  // Energy-momentum steps take the mean of a step: the balance is exact for a linear force.
  const Scene scene = scene_of(
      kFlying + drive("F", "3*t - 1") + load("point", "body = \"body\"\nforce = [\"F\", 0]"),
      {"time.integrator=energy_momentum"});
  EXPECT_LT(follow(scene, [](const fem::MotionStep&) { return 0.0; }).defect, 1e-12);
}

// A force that turns with a body that spins at w: its velocity is F/(m w) (sin wt, 1 - cos wt).
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

// Off the centre of mass it turns the body evenly: M = F d, whatever the angle.
TEST(Loads, TurningForceOffTheCentreTurnsEvenly) {
  const Scene scene = scene_of(kFlying + load("point",
                                              "body = \"body\"\npoint = [0.0, 0.25]\nforce = "
                                              "[-4.0, 0.0]\nturns = true"));
  const Followed found = follow(scene, [](const fem::MotionStep& s) {
    return angle_miss(s.x, 0.5 * (4 * 0.25 / 0.5) * s.x.t * s.x.t);
  });
  EXPECT_LT(found.error, 1e-4);
  EXPECT_LT(found.defect, 1e-4);
}

// A mass of 3 kg at 0.4 m on a body that turns about its centre: I = 0.5 + 3 0.4^2, and the weight
// of the mass alone has a moment.
TEST(Loads, PointMassOnARigidBodyIsPartOfItsInertia) {
  const std::string text =
      "gravity = [0.0, -9.81]\n" + kFlying +
      "\n[[joint]]\ntype = \"revolute\"\nname = \"pivot\"\na = \"ground\"\npoint_a = [0, 0]\nb = "
      "\"body\"\n\n[[point_mass]]\nbody = \"body\"\npoint = [0.4, 0.0]\nmass = 3.0\n";
  const Scene scene = scene_of(
      text, {"rigid_body.body.velocity=", "rigid_body.body.angular_velocity=", "time.end=0.01"});
  Mechanism m = build_mechanism(scene);
  double first = 0, weight = 0;
  fem::integrate(m.model, m.growths, m.motion, [&](const fem::MotionStep& s) {
    if (s.x.t > 0) return;
    first = s.x.a[3];  // of the axis (1, 0)
    const auto wrench = s.model.joint_wrench(0, "body", Vec3::Zero(), s.x);
    const auto other = s.model.joint_wrench(1, "body", Vec3::Zero(), s.x);
    weight = wrench.force.y() + other.force.y();
  });
  const double inertia = 0.5 + 3 * 0.16, alpha = -3 * 9.81 * 0.4 / inertia;
  EXPECT_NEAR(first, alpha, 1e-12 * 10);
  EXPECT_NEAR(weight, 5 * 9.81 + 3 * 0.4 * alpha, 1e-11 * 50);  // d/dt of the momentum
}

// A pendulum that hangs at rest: the pivot holds m g(t).
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

// The defect of the balance falls with the square of the step while material flows: what drives
// loads and gravity is power on the unknowns alone.
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
    testing::Rate defects;
    for (const double h : {2e-3, 1e-3, 5e-4}) {
      defects.step.push_back(h);
      defects.error.push_back(
          follow(scene_of(top + kPlate + f + loads, {"time.step=" + io::to_text(h)}),
                 [](const fem::MotionStep&) { return 0.0; })
              .defect);
    }
    EXPECT_NEAR(defects.order(), 2, 0.25) << top << loads << defects.table();
    EXPECT_LT(defects.error.back(), 1e-3) << top << loads << defects.table();
  }
}

// Loads that follow a plate in space are power, too: a pressure and an edge moment.
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
    testing::Rate defects;
    for (const double h : {2e-3, 1e-3, 5e-4}) {
      defects.step.push_back(h);
      defects.error.push_back(follow(scene_of(plate + drive("f", "40*sin(20*t)") + loads,
                                              {"time.step=" + io::to_text(h)}),
                                     [](const fem::MotionStep&) { return 0.0; })
                                  .defect);
    }
    EXPECT_NEAR(defects.order(), 2, 0.3) << loads << defects.table();
    EXPECT_LT(defects.error.back(), 2e-3) << loads << defects.table();
  }
}

// Equivalent static loads take a force as it is at their time.
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

// Starts are equilibria under what loads are at t = 0: under a force along the plate it is as long
// as Hooke says, and stays so while the force does.
TEST(Loads, PrestretchedStartsHaveTheLoadOfTheStart) {
  const Scene scene =
      scene_of(kPlate + drive("f", "100 + 0*t") +
                   load("edge", "body = \"plate\"\nedge = \"free_end\"\nforce = [\"f\", 0]"),
               {"time.start=prestretched", "hub.hub.angular_velocity=0", "body.plate.flow=",
                "body.plate.element=ancf_plate", "body.plate.poisson_ratio=0", "time.end=0.05"});
  // S (1 + e) (1 + 2 e + ...) : force per length 100 = E h e (1 + e/2) (1 + e) of Green's strain.
  double lambda = 1;
  for (int k = 0; k < 50; ++k) lambda = std::sqrt(1 + 2 * 100 / (1e7 * 0.01 * lambda));
  const Followed found = follow(scene, [&](const fem::MotionStep& s) {
    return std::abs(fem::point_position(s.model.body("plate"), s.x, {0.4, 0}).x() - 0.4 * lambda);
  });
  EXPECT_LT(found.error, 1e-10);
}

struct BadLoad {
  std::string text, words;
};
TEST(Loads, AreRefusedWithTheirPlace) {
  const std::string f = drive("f", "t");
  const std::vector<BadLoad> wrong = {
      {kFlying + load("point", "body = \"body\"\nforce = [\"f\", 0]"),
       "load.force = [\"f\", 0]: a drive: this case has none"},
      {kFlying + f + load("point", "body = \"body\"\nforce = [\"g\", 0]"), "a drive is 'f'"},
      {kFlying + load("point", "body = \"body\"\nforce = [1]"),
       "a list of 2: a force is a finite number [N], or the name of a drive"},
      {kFlying + load("point", "body = \"bode\"\nforce = [1, 0]"), "a body"},
      {kFlying + load("surface", "body = \"body\"\nforce = [1, 0]"), "that is a rigid body"},
      {kFlying + load("torque", "body = \"body\"\ntorque = 1\npoint = [0, 1]"),
       "a torque turns all of a rigid body"},
      {kFlying + "\n[[point_mass]]\nbody = \"body\"\nmass = 1.0\n", "point_mass.point is missing"},
      {kPlate + load("line", "body = \"plate\"\nforce = [1, 0]"), "this load acts on a beam"},
      {kCantilever + load("surface", "body = \"rod\"\nforce = [1, 0]"),
       "a beam is loaded by \"point\", \"line\" or \"torque\""},
      {kPlate + "\n[[point_mass]]\nbody = \"plate\"\nmass = 1.0\n",
       "a point mass is `at` the \"free_end\" or at a `point`"},
      {"gravity = [\"f\", \"no\"]\n" + kPlate + f, "a drive is 'f'"},
      {"[time]\nend = 1\nintegrator = \"energy_momentum\"\n" +
           kFlying.substr(kFlying.find("[[rigid_body]]")) +
           load("point", "body = \"body\"\nforce = [1, 0]\nturns = true"),
       "a load that follows the body needs integrator = \"generalized_alpha\""},
      {kCantilever + load("point", "body = \"rod\"\npoint = [1, 0]\nforce = [\"f\", 0]"),
       "a drive: this case has none"},
  };
  for (const auto& [text, words] : wrong)
    EXPECT_TRUE(contains(complaint(text), words)) << complaint(text) << "\n" << words;
}

}  // namespace
}  // namespace flexmorph::cases
