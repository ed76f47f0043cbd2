// Shows that given velocities of mechanisms are kept to round-off or refused with the joints that
// contradict them, that velocities which are not given have the least kinetic energy, and that free
// mechanisms keep their momentum.
#include <gtest/gtest.h>

#include <cmath>

#include "cases/assembly/build.h"
#include "fem/dynamics/starts/driven_frame.h"
#include "tests/io/scratch.h"
#include "tests/support/errors.h"

namespace flexmorph::cases {
namespace {

std::string rigid(const std::string& name, const std::string& more) {
  return "\n[[rigid_body]]\nname = \"" + name + "\"\nmass = 2.0\nsize = [0.4, 0.1]\n" + more + "\n";
}
std::string joint(const std::string& type, const std::string& more) {
  return "\n[[joint]]\ntype = \"" + type + "\"\n" + more + "\n";
}
/// Returns a revolute joint between points of two rigid bodies; the ground is "ground".
std::string pin(const std::string& a, const std::string& at_a, const std::string& b,
                const std::string& at_b) {
  return joint("revolute",
               "a = \"" + a + "\"\npoint_a = " + at_a + "\nb = \"" + b + "\"\npoint_b = " + at_b);
}
std::string plate(const std::string& name, const std::string& more = "length = 0.5",
                  const std::string& element = "ancf_plate") {
  return "\n[[body]]\nname = \"" + name + "\"\nelement = \"" + element +
         "\"\nterms = [\"inertia\", \"membrane\"]\nwidth = 0.05\n"
         "thickness = 0.01\ndensity = 2700.0\nyoungs_modulus = 1e9\npoisson_ratio = 0.3\n"
         "elements = [3, 1]\n" +
         more + "\n";
}
std::string beam(const std::string& name) {
  return "\n[[body]]\nname = \"" + name +
         "\"\nelement = \"ancf_beam\"\nterms = [\"inertia\", \"ecm\"]\nlength = 0.5\nwidth = 0.05\n"
         "height = 0.01\ndensity = 2700.0\nyoungs_modulus = 1e9\npoisson_ratio = 0.3\n"
         "elements = 3\n";
}
std::string weld(const std::string& body, const std::string& edge, const std::string& to,
                 const std::string& more) {
  return joint("weld",
               "body = \"" + body + "\"\nedge = \"" + edge + "\"\nto = \"" + to + "\"\n" + more);
}

const std::string kHub = rigid("hub", "position = [0.3, -0.2]\nangle = 0.4\nSPEED");
const std::string kTwoPlates =
    plate("left") + plate("right") + weld("left", "root", "hub", "point = [0.2, 0.0]") +
    weld("right", "root", "hub", "point = [-0.2, 0.0]\nangle = 3.141592653589793");
const std::string kGrowing =
    "length = 0.5\n[body.flow]\nspeed = 0.2\nmax_length = 0.2\nmin_length = 0.05";
const std::string kPendulum = pin("ground", "[0.0, 0.0]", "a", "[-0.2, 0.0]");
const std::string kTwoLinks = kPendulum + pin("a", "[0.2, 0.0]", "b", "[-0.2, 0.0]");
/// A parallelogram with cranks of 0.2 m and pivots 1 m apart.
const std::string kCranks = rigid("a", "position = [0.0, 0.2]\nangle = 1.5707963267948966\nSPEED") +
                            rigid("b", "position = [1.0, 0.2]\nangle = 1.5707963267948966") +
                            pin("ground", "[0.0, 0.0]", "a", "[-0.2, 0.0]") +
                            pin("ground", "[1.0, 0.0]", "b", "[-0.2, 0.0]");
const std::string kCoupler = rigid("rod", "position = [0.5, 0.4]") +
                             pin("a", "[0.2, 0.0]", "rod", "[-0.5, 0.0]") +
                             pin("b", "[0.2, 0.0]", "rod", "[0.5, 0.0]");

struct Case {
  const char* name;
  std::string text;
  bool free = false;                      ///< True if momentum is conserved.
  std::vector<std::string> refused = {};  ///< Parts of the message if the case is refused.
};

std::string with(std::string text, const std::string& speed) {
  for (size_t at; (at = text.find("SPEED")) != std::string::npos;) text.replace(at, 5, speed);
  return text;
}

const Case kCases[] = {
    {"pinned_rod", rigid("a", "position = [0.2, 0.0]\nangular_velocity = 4.0") + kPendulum},
    {"pinned_rod_by_its_velocity",
     rigid("a", "position = [0.2, 0.0]\nvelocity = [0.0, 0.8]") + kPendulum},
    {"body_that_flies", rigid("a", "velocity = [1.0, 0.0]"), true},
    {"body_that_tumbles",
     rigid("a", "center = [0.1, 0.02]\nvelocity = [1.0, -0.5]\nangular_velocity = 3.0"), true},
    {"hub_with_two_plates", with(kHub, "angular_velocity = 6.283185307179586") + kTwoPlates, true},
    {"hub_with_two_plates_flies",
     with(kHub, "velocity = [0.5, 0.1]\nangular_velocity = -2.0") + kTwoPlates, true},
    {"hub_with_growing_plates",
     with(kHub, "angular_velocity = 6.283185307179586") +
         plate("left", kGrowing, "ale_ancf_plate") + plate("right", kGrowing, "ale_ancf_plate") +
         weld("left", "root", "hub", "point = [0.2, 0.0]") +
         weld("right", "root", "hub", "point = [-0.2, 0.0]\nangle = 3.141592653589793")},
    {"hub_with_a_beam",
     with(kHub, "velocity = [1.0, 0.0]\nangular_velocity = 2.0") + beam("arm") +
         weld("arm", "root", "hub", "point = [0.2, 0.0]"),
     true},
    {"plate_with_a_tip",
     with(kHub, "angular_velocity = 1.5") + rigid("tip", "position = [1.07, 0.12]\nangle = 0.4") +
         plate("arm") + weld("arm", "root", "hub", "point = [0.2, 0.0]") +
         weld("arm", "free_end", "tip", "point = [-0.2, 0.0]"),
     true},
    {"double_pendulum_both", rigid("a", "position = [0.2, 0.0]\nangular_velocity = 1.0") +
                                 rigid("b", "position = [0.6, 0.0]\nangular_velocity = -2.0") +
                                 kTwoLinks},
    {"double_pendulum_second", rigid("a", "position = [0.2, 0.0]") +
                                   rigid("b", "position = [0.6, 0.0]\nangular_velocity = 3.0") +
                                   kTwoLinks},
    {"four_bar_by_its_crank", with(kCranks, "angular_velocity = 2.0") + kCoupler},
    {"four_bar_by_its_coupler", with(kCranks, "") +
                                    rigid("rod", "position = [0.5, 0.4]\nvelocity = [-0.7, 0.0]") +
                                    pin("a", "[0.2, 0.0]", "rod", "[-0.5, 0.0]") +
                                    pin("b", "[0.2, 0.0]", "rod", "[0.5, 0.0]")},
    {"slider_crank",
     rigid("crank", "angle = 1.0471975511965976") + rigid("block", "velocity = [0.3, 0.0]") +
         pin("ground", "[0.0, 0.0]", "crank", "[0.0, 0.0]") +
         joint("slider", "a = \"ground\"\npoint_a = [0.0, 0.0]\nb = \"block\"") +
         joint("distance", "a = \"crank\"\npoint_a = [0.2, 0.0]\nb = \"block\"\ndistance = 0.5")},
    {"driven_and_given_alike",
     rigid("a", "position = [0.2, 0.0]\nangular_velocity = 2.0") + kPendulum +
         "\n[[drive]]\nname = \"turn\"\nformula = \"2*t\"\n" +
         joint("angle_drive", "name = \"motor\"\nb = \"a\"\nangle = \"turn\"")},
    {"gear", rigid("a", "angular_velocity = 1.0") + rigid("b", "position = [0.7, 0.0]") +
                 pin("ground", "[0.0, 0.0]", "a", "[0.0, 0.0]") +
                 pin("ground", "[0.7, 0.0]", "b", "[0.0, 0.0]") +
                 joint("gear", "name = \"mesh\"\na = \"a\"\nb = \"b\"\nteeth = [20, 40]")},
    {"springs_hold_no_velocity",
     rigid("a", "velocity = [1.0, 0.0]") + rigid("b", "position = [1.0, 0.0]") +
         "\n[[spring]]\ntype = \"linear\"\na = \"a\"\nb = \"b\"\nstiffness = 10.0\n",
     true},
    {"pinned_plate_between_cranks",
     with(kCranks, "angular_velocity = 2.0") + plate("rod", "length = 1.0\nposition = [0.0, 0.4]") +
         joint("revolute", "a = \"a\"\npoint_a = [0.2, 0.0]\nb = \"rod\"\npoint_b = [0.0, 0.0]") +
         joint("revolute", "a = \"b\"\npoint_a = [0.2, 0.0]\nb = \"rod\"\npoint_b = [1.0, 0.0]")},
    {"against_a_pin",
     rigid("a", "position = [0.2, 0.0]\nvelocity = [1.0, 0.0]") + kPendulum,
     false,
     {"rigid_body.a.velocity = [1, 0]", "revolute", "1 m/s"}},
    {"against_a_pin_by_all_of_it",
     rigid("a", "position = [0.2, 0.0]\nvelocity = [0.5, 0.0]") + kPendulum,
     false,
     {"rigid_body.a.velocity = [0.5, 0]", "0.5 m/s"}},
    {"against_a_drive",
     rigid("a", "position = [0.2, 0.0]\nangular_velocity = 4.0") + kPendulum +
         "\n[[drive]]\nname = \"turn\"\nformula = \"2*t\"\n" +
         joint("angle_drive", "name = \"motor\"\nb = \"a\"\nangle = \"turn\""),
     false,
     {"rigid_body.a.angular_velocity = 4", "'motor'"}},
    {"against_each_other",
     rigid("a", "position = [0.2, 0.0]\nangular_velocity = 1.0") +
         rigid("b", "position = [0.6, 0.0]\nvelocity = [0.0, 5.0]\nangular_velocity = 0.0") +
         kTwoLinks,
     false,
     {"rigid_body.a.angular_velocity = 1", "b.velocity = [0, 5]"}},
    {"zero_is_a_velocity",
     rigid("a", "position = [0.2, 0.0]\nangular_velocity = 0.0") + kPendulum +
         "\n[[drive]]\nname = \"turn\"\nformula = \"2*t\"\n" +
         joint("angle_drive", "name = \"motor\"\nb = \"a\"\nangle = \"turn\""),
     false,
     {"rigid_body.a.angular_velocity = 0", "'motor'"}},
};

Scene rigid_scene_of(const std::string& text) {
  const Scratch scratch;
  return read_scene(io::CaseFile(
      scratch.write("case.toml", "[time]\nend = 0.05\nstep = 1e-3\nstart = \"rigid\"\n" + text)));
}

fem::State start_of(Mechanism& m) {
  fem::State x = fem::start_state(m.model, m.moving_roots, 0, m.motion.start, m.motion.body_poses);
  const auto integrator = fem::make_integrator(m.model, {});
  integrator->project_velocity(x);
  integrator->make_consistent(x);
  return x;
}

void PrintTo(const Case& c, std::ostream* out) { *out << c.name; }

std::vector<Case> free_ones() {
  std::vector<Case> out;
  for (const Case& c : kCases)
    if (c.free) out.push_back(c);
  return out;
}

class GivenVelocities : public ::testing::TestWithParam<Case> {};
class FreeMechanisms : public ::testing::TestWithParam<Case> {};

TEST_P(GivenVelocities, AreKeptOrRefused) {
  const Case& c = GetParam();
  const Scene scene = rigid_scene_of(c.text);
  if (!c.refused.empty()) {
    try {
      build_mechanism(scene);
      FAIL() << "not refused";
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), Error::Kind::input);
      EXPECT_TRUE(testing::mentions_all(error.what(), c.refused));
      EXPECT_NE(std::string(error.what()).find("case.toml:"), std::string::npos) << error.what();
    }
    return;
  }
  Mechanism m = build_mechanism(scene);
  const fem::State x = start_of(m);
  int given = 0;
  for (const RigidBody& b : scene.rigid_bodies) {
    const fem::FrameMotion frame = fem::frame_of(m.model.body(b.name), x);
    if (b.velocity) {
      EXPECT_LT((frame.origin_rate - *b.velocity).norm(), 1e-12) << b.name;
    }
    if (b.angular_velocity) {
      EXPECT_NEAR(frame.angle_rate, *b.angular_velocity, 1e-12) << b.name;
    }
    given += b.velocity.has_value() + b.angular_velocity.has_value();
  }
  EXPECT_GT(given, 0);
  fem::Constraints rows;
  m.model.constraints(x, rows);
  VectorXd rate = rows.rate;
  for (const auto& entry : rows.jacobian) rate[entry.row()] += entry.value() * x.v[entry.col()];
  EXPECT_LT(rate.norm(), 1e-11);
}

TEST_P(FreeMechanisms, KeepTheirMomentum) {
  const Case& c = GetParam();
  for (const char* integrator : {"generalized_alpha", "energy_momentum"}) {
    const Scene scene = rigid_scene_of(c.text);
    Mechanism m = build_mechanism(scene);
    m.motion.integrator = integrator;
    Vec2 first(0, 0);
    double worst = 0, largest = 0;
    fem::integrate(m.model, m.moving_roots, m.motion, [&](const fem::MotionStep& step) {
      const Vec2 now = m.model.momentum(step.x).head<2>();
      if (step.x.t == 0) first = now;
      largest = std::max(largest, std::sqrt(step.energies.kinetic));  // for unit masses, m v
      worst = std::max(worst, (now - first).norm());
    });
    EXPECT_LT(worst, 1e-10 * std::max(first.norm(), largest)) << integrator;
  }
}

INSTANTIATE_TEST_SUITE_P(Mechanisms, GivenVelocities, ::testing::ValuesIn(kCases),
                         [](const auto& info) { return std::string(info.param.name); });

INSTANTIATE_TEST_SUITE_P(Mechanisms, FreeMechanisms, ::testing::ValuesIn(free_ones()),
                         [](const auto& info) { return std::string(info.param.name); });

// Reference: two links of mass m, half-length a and inertia J in line; the first rotates with w₁,
// the second with the given w₂ = 3. The kinetic energy T is least for
//   T = ½ (J + m a²) w₁² + ½ m (2a w₁ + a w₂)² + ½ J w₂²,   w₁ = -2 m a² w₂ / (J + 5 m a²).
TEST(Starts, WhatIsNotGivenHasTheLeastKineticEnergy) {
  const Scene scene = rigid_scene_of(kCases[10].text);
  ASSERT_STREQ(kCases[10].name, "double_pendulum_second");
  Mechanism m = build_mechanism(scene);
  const fem::State x = start_of(m);
  const double a = 0.2, mass = 2, J = mass * (0.4 * 0.4 + 0.1 * 0.1) / 12;
  EXPECT_NEAR(fem::frame_of(m.model.body("a"), x).angle_rate,
              -2 * mass * a * a * 3 / (J + 5 * mass * a * a), 1e-7);
}

// A hub and two plates rotate as one body. Reference: T = ½ J ω² with J about the hub by Steiner's
// theorem.
TEST(Starts, PlatesTurnWithTheirHub) {
  const Scene scene = rigid_scene_of(kCases[4].text);
  Mechanism m = build_mechanism(scene);
  const fem::State x = start_of(m);
  const double plate = 2700 * 0.01 * 0.05 * 0.5, middle = 0.2 + 0.25;
  const double J = 2.0 * (0.4 * 0.4 + 0.1 * 0.1) / 12 +
                   2 * plate * ((0.5 * 0.5 + 0.05 * 0.05) / 12 + middle * middle);
  const double w = 6.283185307179586;
  EXPECT_NEAR(m.model.energies(x).kinetic / (0.5 * J * w * w), 1, 1e-9);
}

}  // namespace
}  // namespace flexmorph::cases
