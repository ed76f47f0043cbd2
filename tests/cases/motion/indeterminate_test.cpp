// Shows that mechanisms run correctly whose joints constrain more than the degrees of freedom of
// rigid bodies, but not more than those of flexible bodies, and mechanisms with redundant joints
// that are consistent.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "cases/assembly/build.h"
#include "cases/check/ready.h"
#include "fem/dynamics/starts/rigid_motion.h"
#include "fem/solve/statics.h"
#include "tests/io/scratch.h"
#include "tests/support/errors.h"

namespace flexmorph::cases {
namespace {

Scene scene_of(const std::string& text) {
  const Scratch scratch;
  return read_scene(io::CaseFile(scratch.write("case.toml", text)));
}

std::string joint(const std::string& type, const std::string& more) {
  return "\n[[joint]]\ntype = \"" + type + "\"\n" + more + "\n";
}

/// Returns a member of 1.2 m length, 0.02 m height and 0.03 m width.
std::string member(const std::string& name, int elements) {
  return "\n[[body]]\nname = \"" + name +
         "\"\nelement = \"ancf_beam\"\nterms = [\"ecm\"]\nlength = 1.2\nheight = 0.02\n"
         "width = 0.03\nyoungs_modulus = 7.2e9\npoisson_ratio = 0.3\nelements = " +
         std::to_string(elements) + "\n";
}

// A column and a beam, welded to each other at the corner, on two pins, with a load at 0.2 L of the
// beam (Lee's frame). Source: Lee, Manuel & Rossow (1968), J. Eng. Mech. Div. 94, 521-547. The
// reference value is the critical load 18.552 E I / L² for A L² = 43200 I: Schweizerhof & Wriggers
// (1986), Comput. Methods Appl. Mech. Eng. 59, 261-279.
TEST(Indeterminate, LeesFrameSnapsAtItsCriticalLoad) {
  const Scene scene = scene_of(
      "[static]\npath = \"arc_length\"\n" + member("column", 20) +
      "position = [0.0, 0.0]\nangle = 1.5707963267948966\n" + member("beam", 20) +
      "\n[[rigid_body]]\nname = \"corner\"\nmass = 1.0\ninertia = 1.0\nposition = [0.0, 1.2]\n" +
      joint("weld",
            "body = \"column\"\nedge = \"free_end\"\nto = \"corner\"\nangle = 1.5707963267948966") +
      joint("weld", "body = \"beam\"\nedge = \"root\"\nto = \"corner\"") +
      joint("pin", "body = \"column\"\npoint = [0.0, 0.0]") +
      joint("pin", "body = \"beam\"\npoint = [1.2, 0.0]") +
      "\n[[load]]\ntype = \"point\"\nbody = \"beam\"\npoint = [0.24, 0.0]\nforce = [0.0, "
      "-2500.0]\n");
  require_buildable(PreparedCase(scene));
  EXPECT_TRUE(fem::RigidMotion(rigid_kinematics(scene)).is_indeterminate());
  Mechanism m = build_mechanism(scene);
  fem::State x =
      fem::start_state(m.model, m.moving_roots, 0, fem::Start::rigid, m.motion.body_poses);
  m.model.scale_loads(0);
  fem::StaticSettings settings;
  settings.path = fem::StaticSettings::Path::arc_length;
  settings.first_step = settings.largest_step = 0.02;
  settings.max_steps = 2000;
  double critical = 0;
  fem::solve_static(m.model, x, settings, [&](const fem::StaticStep& step) {
    const bool snaps = step.factor < critical;
    critical = std::max(critical, step.factor);
    return !snaps;
  });
  const double EI = 7.2e9 * 0.03 * std::pow(0.02, 3) / 12;
  EXPECT_NEAR(critical * 2500 * 1.2 * 1.2 / EI / 18.552, 1, 0.01);
}

/// Returns cranks of 0.2 m on pivots 0.5 m apart, upright at the start; the first is driven.
std::string cranks(int n, const std::string& law) {
  std::string out = "[time]\nend = 0.5\nstep = 1e-3\n[[drive]]\nname = \"turn\"\nformula = \"" +
                    law + "\"\n" +
                    joint("angle_drive", "name = \"motor\"\nb = \"crank0\"\nangle = \"turn\"");
  for (int i = 0; i < n; ++i) {
    const std::string k = std::to_string(i), at = "[" + std::to_string(0.5 * i) + ", 0.0]";
    out += "\n[[rigid_body]]\nname = \"crank" + k +
           "\"\nmass = 0.5\nsize = [0.2, 0.03]\nposition = " + at +
           "\nangle = 1.5707963267948966\n" +
           joint("revolute",
                 "name = \"foot" + k + "\"\npoint_a = " + at + "\nb = \"crank" + k + "\"") +
           joint("revolute", "name = \"pin" + k + "\"\na = \"crank" + k +
                                 "\"\npoint_a = [0.2, 0.0]\nb = \"coupler\"\npoint_b = " + at);
  }
  return out;
}
const char* const kCoupler =
    "\n[[body]]\nname = \"coupler\"\nelement = \"ancf_plate\"\nterms = [\"inertia\", "
    "\"membrane\"]\nlength = 1.0\nwidth = 0.04\nthickness = 0.01\ndensity = 2700\n"
    "youngs_modulus = 7e9\npoisson_ratio = 0.3\nelements = [8, 1]\nposition = [0.0, 0.2]\n";

// The third crank is redundant for rigid bodies: all cranks turn by equal angles, and the coupler
// keeps its orientation.
TEST(Indeterminate, ParallelogramOfThreeCranks) {
  const Scene scene = scene_of(cranks(3, "pi/2 + 3*t^2") + kCoupler);
  require_buildable(PreparedCase(scene));
  Mechanism m = build_mechanism(scene);
  EXPECT_EQ(m.motion.start, fem::Start::at_rest);
  double worst = 0;
  fem::integrate(m.model, m.moving_roots, m.motion, [&](const fem::MotionStep& step) {
    const double angle = std::numbers::pi / 2 + 3 * step.x.t * step.x.t;
    const Vec2 wanted = Vec2(0.75, 0) + 0.2 * Vec2(std::cos(angle), std::sin(angle));
    const Vec2 point = fem::point_position(step.model.body("coupler"), step.x, {0.75, 0}).head<2>();
    worst = std::max(worst, (point - wanted).norm());
  });
  EXPECT_LT(worst, 1e-5);  // inertia bends the coupler by m a / k = 1 kg 3 m/s² / 3e5 N/m
}

// Two motors that turn against each other stretch the coupler, which a rigid coupler would not
// allow.
TEST(Indeterminate, DrivesMayContradictTheRigidModel) {
  const Scene scene =
      scene_of(cranks(3, "pi/2 - 0.001*sin(3*t)") + kCoupler +
               "\n[[drive]]\nname = \"back\"\nformula = \"pi/2 + 0.001*sin(3*t)\"\n" +
               joint("angle_drive", "name = \"other\"\nb = \"crank2\"\nangle = \"back\""));
  require_buildable(PreparedCase(scene));
  Mechanism m = build_mechanism(scene);
  EXPECT_EQ(m.motion.start, fem::Start::rigid);
  const fem::MotionResult end =
      fem::integrate(m.model, m.moving_roots, m.motion, [](const fem::MotionStep&) {});
  EXPECT_GT(end.start_change, 1e-4);
  // Quasi-static reference: the distance of 1 m between the outer pins shrinks by 2 r Δφ.
  const double strain = -2 * 0.2 * 0.001 * std::sin(1.5), EA = 7e9 * 0.04 * 0.01;
  EXPECT_NEAR(m.model.energies(end.final).strain / (0.5 * EA * strain * strain), 1, 0.05);
}

// The third crank of a rigid parallelogram is redundant, and consistent.
TEST(Indeterminate, RigidParallelogramOfThreeCranks) {
  const Scene scene = scene_of(cranks(3, "pi/2 + 3*t^2") +
                               "\n[[rigid_body]]\nname = \"coupler\"\nmass = 1.0\nsize = [1.0, "
                               "0.04]\nposition = [0.0, 0.2]\n");
  require_buildable(PreparedCase(scene));
  Mechanism m = build_mechanism(scene);
  double worst = 0;
  fem::integrate(m.model, m.moving_roots, m.motion, [&](const fem::MotionStep& step) {
    const double angle = std::numbers::pi / 2 + 3 * step.x.t * step.x.t;
    const Vec2 wanted = 0.2 * Vec2(std::cos(angle), std::sin(angle));
    const Vec2 origin = step.x.q.segment<2>(step.model.body("coupler").first_dof);
    worst = std::max(worst, (origin - wanted).norm());
  });
  EXPECT_LT(worst, 1e-9);
}

// One pin is given two times. The motion is that with one pin.
TEST(Indeterminate, FlexibleBodyOnAPinThatIsGivenTwice) {
  const auto end = [](const std::string& more) {
    const Scene scene = scene_of(cranks(2, "pi/2 + 3*t^2") + kCoupler + more);
    require_buildable(PreparedCase(scene));
    Mechanism m = build_mechanism(scene);
    const fem::MotionResult motion =
        fem::integrate(m.model, m.moving_roots, m.motion, [](const fem::MotionStep&) {});
    return Vec2(fem::point_position(m.model.body("coupler"), motion.final, {1.0, 0}).head<2>());
  };
  const Vec2 once = end(""),
             twice = end(joint("revolute",
                               "name = \"again\"\na = \"crank1\"\npoint_a = "
                               "[0.2, 0.0]\nb = \"coupler\"\npoint_b = [0.5, 0.0]"));
  EXPECT_LT((once - twice).norm(), 1e-9);
}

std::string strip_between_hubs(const std::string& location) {
  return "[time]\nend = 0.5\nstep = 1e-3\n[[drive]]\nname = \"left\"\nformula = "
         "\"0.01*sin(pi*t)^2\"\n[[drive]]\nname = \"right\"\nformula = \"-0.01*sin(pi*t)^2\"\n"
         "[[hub]]\nname = \"a\"\nangle = \"left\"\n[[hub]]\nname = \"b\"\nangle = \"right\"\n"
         "position = " +
         location +
         "\n[[body]]\nname = \"strip\"\nelement = \"ancf_plate\"\nterms = [\"inertia\", "
         "\"membrane\"]\nlength = 0.5\nwidth = 0.03\nthickness = 0.01\ndensity = 2700\n"
         "youngs_modulus = 7e9\npoisson_ratio = 0.3\nelements = [12, 1]\n" +
         joint("weld", "body = \"strip\"\nedge = \"root\"\nto = \"a\"") +
         joint("weld", "body = \"strip\"\nedge = \"free_end\"\nto = \"b\"");
}

// Ends rotated by ±θ bend a beam into a parabola of height θ L/4. The clamped edges, which cannot
// contract, and the tension stiffen the beam by less than 2 %, which is the tolerance.
TEST(Indeterminate, PlateBetweenTwoHubs) {
  const Scene scene = scene_of(strip_between_hubs("[0.5, 0.0]"));
  require_buildable(PreparedCase(scene));
  Mechanism m = build_mechanism(scene);
  const fem::MotionResult end =
      fem::integrate(m.model, m.moving_roots, m.motion, [](const fem::MotionStep&) {});
  const double height = fem::point_position(m.model.body("strip"), end.final, {0.25, 0}).y();
  EXPECT_NEAR(height / (0.01 * 0.5 / 4), 1, 0.02);
}

TEST(Indeterminate, PlateThatDoesNotReachItsHub) {
  try {
    require_buildable(PreparedCase(scene_of(strip_between_hubs("[0.52, 0.0]"))));
    FAIL() << "not refused";
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), Error::Kind::input);
    EXPECT_TRUE(testing::mentions_all(error.what(), {"0.02 m"}));
  }
}

}  // namespace
}  // namespace flexmorph::cases
