// Shows that the output of mechanisms is correct: columns against rigid-body mechanics, parts of
// the files of the motion, plots.
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <numbers>

#include "cases/assembly/build.h"
#include "cases/output/surface.h"
#include "cases/run/run.h"
#include "io/tables.h"
#include "tests/cases/program.h"
#include "tests/cases/run_json.h"
#include "tests/support/errors.h"

namespace flexmorph::test {
namespace {

namespace fs = std::filesystem;
// A rod that a motor turns about its end by more than one turn; its centre of mass is 0.3 m from
// this end. A pointer is driven equally. A plate in a hub is added so that the motion has a
// flexible body, too.
constexpr const char* kRod = R"toml(
title = "Driven rod"
gravity = [0.0, -9.81]

[time]
end = 0.5
step = 1e-3

[[drive]]
name = "wanted"
formula = "14*t + 0.2*sin(6*t)"

[[drive]]
name = "turn"
from = "trajectory"

[trajectory]
body = "rod"
angle = "wanted"
x = 1.0
y = 2.0

[[rigid_body]]
name = "rod"
mass = 2.0
inertia = 0.05
center = [0.3, 0.0]
size = [0.8, 0.1]
position = [1.0, 2.0]

[[rigid_body]]
name = "pointer"
mass = 0.1
inertia = 0.001
position = [1.0, 2.0]

[[hub]]
name = "wall"
position = [0.0, 0.0]
angular_velocity = 0.0

[[body]]
name = "flag"
element = "ancf_plate"
terms = ["inertia", "membrane"]
length = 0.2
width = 0.05
thickness = 0.01
density = 2700.0
youngs_modulus = 7e9
poisson_ratio = 0.3
elements = [2, 1]

[[joint]]
type = "weld"
body = "flag"
edge = "root"
to = "wall"

[[joint]]
type = "revolute"
name = "hinge"
point_a = [1.0, 2.0]
b = "rod"

[[joint]]
type = "angle_drive"
name = "motor"
b = "rod"
angle = "turn"

[[joint]]
type = "revolute"
a = "rod"
b = "pointer"

[[drive]]
name = "back"
formula = "-14*t - 0.2*sin(6*t)"

[[joint]]
type = "angle_drive"
name = "spin"
a = "pointer"
angle = "back"

[output]
motion_every = 0.1
)toml";

struct Turn {
  double angle, rate, acceleration;
  explicit Turn(double t)
      : angle(14 * t + 0.2 * std::sin(6 * t)),
        rate(14 + 1.2 * std::cos(6 * t)),
        acceleration(-7.2 * std::sin(6 * t)) {}
};

/// Returns whether the run wrote a plot and its report shows it.
bool is_in_report(const std::string& folder, const std::string& plot) {
  const std::string picture = contents_of(folder + "/plots/" + plot + ".svg");
  return !picture.empty() &&
         contains(contents_of(folder + "/report.html"), picture.substr(picture.find("<svg")));
}

size_t count(const std::string& text, const std::string& part) {
  size_t n = 0;
  for (size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) ++n;
  return n;
}

// Reference: the force is m (a - g) at the centre of mass. Accelerations of generalized-alpha in
// natural coordinates have an error of the size h² ω⁴ = 1e-6 · 15.2⁴ = 0.053 per second squared and
// metre of a body. At the start there is also a transient of first order in h, which decays as n
// 0.8ⁿ after n steps, to 1e-4 after 60 steps.
TEST(MechanismRun, ForcesOfADrivenRodAreThoseOfMechanics) {
  const Scratch scratch;
  const std::string folder = scratch / "out";
  const Ended ended = run(scratch, scratch.write("rod.toml", kRod), folder);
  ASSERT_EQ(ended.code, 0) << ended.err;
  const io::CsvTable motion = io::read_csv(folder + "/motion.csv");
  EXPECT_EQ(motion.columns,
            (Words{"time",          "flag.tip_deflection", "flag.length",  "rod.x",
                   "rod.y",         "rod.angle",           "pointer.x",    "pointer.y",
                   "pointer.angle", "rod.delta_x",         "rod.delta_y",  "rod.delta_angle",
                   "hinge.force_x", "hinge.force_y",       "hinge.moment", "motor.force_x",
                   "motor.force_y", "motor.moment",        "motor.power",  "spin.force_x",
                   "spin.force_y",  "spin.moment",         "spin.power",   "wall.force_x",
                   "wall.force_y",  "wall.moment",         "wall.power",   "energy.kinetic",
                   "energy.strain", "energy.potential",    "energy.error", "power.drive",
                   "power.feed",    "power.inflow"}));
  const auto column = [&](const char* name) { return motion.numbers(name); };
  const auto t = column("time"), fx = column("hinge.force_x"), fy = column("hinge.force_y"),
             moment = column("motor.moment"), power = column("motor.power"),
             angle = column("rod.angle"), all = column("power.drive"), spin = column("spin.moment"),
             spun = column("spin.power");
  // The hinge of the rod also carries the weight of the pointer, whose centre of mass lies at the
  // hinge.
  const double m = 2, l = 0.3, g = 9.81, I = 0.05, carried = 0.1;
  ASSERT_EQ(t.size(), 501u);
  for (size_t i = 0; i < t.size(); ++i) {
    const Turn turn(t[i]);
    const double s = std::sin(turn.angle), c = std::cos(turn.angle);
    const Vec2 along(c, s), across(-s, c);
    const Vec2 force = m * (l * (turn.acceleration * across - turn.rate * turn.rate * along)) +
                       (m + carried) * Vec2(0, g);
    EXPECT_NEAR(angle[i], turn.angle, 1e-9) << t[i];
    EXPECT_NEAR(power[i], moment[i] * turn.rate, 1e-9 * 100) << t[i];
    // The moment acts on the pointer, because b is the ground.
    EXPECT_NEAR(spun[i], spin[i] * turn.rate, 1e-9) << t[i];
    EXPECT_NEAR(all[i], power[i] + spun[i], 1e-9 * 100) << t[i];
    if (i < 60) continue;
    EXPECT_NEAR(fx[i], force.x(), 0.053 * m * l) << t[i];
    EXPECT_NEAR(fy[i], force.y(), 0.053 * m * l) << t[i];
    const double wanted = (I + m * l * l) * turn.acceleration + m * g * l * c;
    EXPECT_NEAR(moment[i], wanted, 0.053 * (I + m * l * l)) << t[i];
    EXPECT_NEAR(spin[i], 0.001 * turn.acceleration, 0.053 * 0.001) << t[i];
  }
  EXPECT_GT(angle.back(), 2 * std::numbers::pi);
  for (const char* name : {"hinge.moment", "motor.force_x", "motor.force_y", "rod.delta_x",
                           "rod.delta_y", "rod.delta_angle"})
    for (const double each : column(name)) EXPECT_NEAR(each, 0, 1e-9) << name;

  // Three bodies are written at six times from 0 to 0.5 s; the pointer has no size and is not
  // drawn.
  const std::string index = contents_of(folder + "/motion/motion.pvd");
  for (const auto& [part, times] :
       {std::pair{"part=\"0\"", 6u}, {"part=\"1\"", 6u}, {"part=\"2\"", 0u}})
    EXPECT_EQ(count(index, part), times) << part;
  const std::string rod = contents_of(folder + "/motion/motion_rod_00002.vtu");
  EXPECT_TRUE(contains(rod, "NumberOfPoints=\"4\" NumberOfCells=\"1\""));
  EXPECT_TRUE(contains(rod, "Name=\"body\""));
  for (const char* name : {"inputs", "mechanism", "error_rod", "joint_forces"})
    EXPECT_TRUE(is_in_report(folder, name)) << name;
  const std::string moments = contents_of(folder + "/plots/mechanism.svg");
  for (const char* title : {"t = 0 s", "t = 0.167 s", "t = 0.334 s", "t = 0.5 s"})
    EXPECT_TRUE(contains(moments, title)) << title;
}

TEST(MechanismRun, RigidBodiesAreDrawnAroundTheirCentres) {
  const Scratch scratch;
  const cases::Scene scene = cases::read_scene(io::CaseFile(scratch.write("rod.toml", kRod)));
  const cases::Mechanism mechanism = cases::build_mechanism(scene);
  fem::State x = mechanism.model.reference();
  const int at = mechanism.model.body("rod").first_dof;
  x.q.segment<4>(at) << 1, 2, 0, 1;  // upright
  const std::vector<Vec2> corners = cases::drawn_corners(scene.rigid_bodies[0], mechanism.model, x);
  ASSERT_EQ(corners.size(), 4u);
  const Vec2 wanted[] = {{1.05, 1.9}, {1.05, 2.7}, {0.95, 2.7}, {0.95, 1.9}};
  for (size_t k = 0; k < 4; ++k) EXPECT_LT((corners[k] - wanted[k]).norm(), 1e-15) << k;
  EXPECT_TRUE(cases::drawn_corners(scene.rigid_bodies[1], mechanism.model, x).empty());
}

// The disc has 24 sides; its area is the sum of its quads. A notch, a sixth of the disc, lies
// towards -x of its frame.
TEST(MechanismRun, HubsAreDiscsThatTurn) {
  fem::FrameMotion frame;
  frame.origin = Vec2(2, -1);
  frame.angle = 0.7;
  const double disc = 24 * 0.5 * 0.09 * std::sin(std::numbers::pi / 12);
  for (const bool notched : {false, true}) {
    const io::QuadMesh mesh = cases::disc_mesh(frame, 0.3, notched);
    const auto at = [&](int k) {
      return Vec2(mesh.points[2 * static_cast<size_t>(k)],
                  mesh.points[2 * static_cast<size_t>(k) + 1]);
    };
    double area = 0;
    Vec2 moment(0, 0);
    for (const auto& quad : mesh.quads)
      for (const size_t k : {1u, 2u}) {
        const Vec2 a = at(quad[k]) - at(quad[0]), b = at(quad[k + 1]) - at(quad[0]);
        const double piece = 0.5 * (a.x() * b.y() - a.y() * b.x());
        EXPECT_GT(piece, 0);
        area += piece;
        moment += piece * (a + b) / 3;
      }
    EXPECT_NEAR(area, notched ? disc * 20 / 24 : disc, 1e-12);
    if (!notched) {
      EXPECT_LT(moment.norm(), 1e-12);
    } else {
      EXPECT_NEAR(std::atan2(moment.y(), moment.x()), 0.7, 1e-12);
    }
  }
}

// Two designs on moving bars. The reference path of the platform is P (36), (37).
TEST(MechanismRun, PlatformShowsItsDesignsAndItsError) {
  const Scratch scratch;
  const std::string folder = scratch / "out";
  const Ended ended =
      run(scratch, "motion_platform", folder,
          {"time.end=0.02", "optimizer.max_iterations=2", "design.bar1.cells=[38, 10]",
           "design.bar2.cells=[75, 10]", "design.bar1.min_thickness=0.01",
           "design.bar2.min_thickness=0.01", "design.bar1.components=[10, 2]",
           "design.bar2.components=[10, 2]", "design.bar1.half_length=0.05",
           "design.bar2.half_length=0.05", "output.motion_every=0.02", "output.tolerance=1e-3"});
  ASSERT_EQ(ended.code, kTooFew) << ended.err;
  // The designs are assessed by the motion on their cells.
  const io::CsvTable motion = io::read_csv(folder + "/motion_verified.csv");
  const auto t = motion.numbers("time"), x = motion.numbers("platform.x"),
             y = motion.numbers("platform.y"), dx = motion.numbers("platform.delta_x"),
             dy = motion.numbers("platform.delta_y"), angle = motion.numbers("platform.angle"),
             turned = motion.numbers("platform.delta_angle");
  double largest = 0, when = 0;
  for (size_t i = 0; i < t.size(); ++i) {
    const double theta = -2 * std::numbers::pi * std::pow(t[i] - 0.5, 3) +
                         1.5 * std::numbers::pi * t[i] - std::numbers::pi / 4;
    EXPECT_NEAR(dx[i], x[i] - 0.5 * std::cos(std::numbers::pi - theta), 1e-14);
    EXPECT_NEAR(dy[i], y[i] - 0.5 * std::sin(std::numbers::pi - theta) - 0.4, 1e-14);
    EXPECT_EQ(turned[i], angle[i]);
    if (std::abs(dy[i]) > largest) largest = std::abs(dy[i]), when = t[i];
  }
  // The platform of 2 kg starts with 0.5 θ'' = 3π m/s² upwards, carried by its two bearings.
  EXPECT_NEAR(motion.numbers("at_C.force_y")[0] + motion.numbers("at_D.force_y")[0],
              -6 * std::numbers::pi, 0.02 * 6 * std::numbers::pi);
  const json written = run_json(folder);
  const auto& error = written["motion"]["platform_error"];
  EXPECT_EQ(error["body"], "platform");
  EXPECT_EQ(error["delta_y"].get<double>(), largest);
  EXPECT_EQ(error["delta_y_time"].get<double>(), when);
  const auto coarse = io::read_csv(folder + "/motion.csv").numbers("platform.delta_y");
  EXPECT_EQ(error["scene_mesh_delta_y"].get<double>(),
            std::abs(*std::max_element(coarse.begin(), coarse.end(), [](double a, double b) {
              return std::abs(a) < std::abs(b);
            })));
  const auto uniform =
      io::read_csv(folder + "/motion_verified_uniform.csv").numbers("platform.delta_x");
  double most = 0;
  for (const double each : uniform) most = std::max(most, std::abs(each));
  EXPECT_EQ(error["uniform_delta_x"].get<double>(), most);

  const std::string index = contents_of(folder + "/motion/motion.pvd");
  for (int part = 0; part < 7; ++part)
    EXPECT_EQ(count(index, "part=\"" + std::to_string(part) + "\""), 2u) << part;
  for (const char* bar : {"bar1_00001", "bar2_00002"}) {
    const std::string frame = contents_of(folder + "/motion/motion_" + bar + ".vtu");
    EXPECT_TRUE(contains(frame, "Name=\"density\"")) << bar;
    EXPECT_TRUE(contains(frame, "Name=\"body\"")) << bar;
  }
  for (const char* name : {"inputs.svg", "mechanism.svg", "error_platform.svg", "joint_forces.svg",
                           "start_bar1.svg", "start_bar2.svg", "design_bar1.png", "design_bar2.png",
                           "convergence_bar1.svg", "convergence_bar2.svg"})
    EXPECT_TRUE(fs::is_regular_file(folder + "/plots/" + name)) << name;
  EXPECT_TRUE(is_in_report(folder, "start_bar2"));
}

// A plate without a design moves together with a designed one; each has its own fields.
TEST(MechanismRun, PlatesWithoutADesignAreThereToo) {
  const Scratch scratch;
  std::string text = contents_of(std::string(FLEXMORPH_CASES) + "/motion_platform.toml");
  const size_t second = text.find("[[design]]\nbody = \"bar2\"");
  ASSERT_NE(second, std::string::npos);
  text.erase(second, text.find("[optimizer]") - second);
  const std::string folder = scratch / "out";
  const Ended ended =
      run(scratch, scratch.write("one.toml", text), folder,
          {"time.end=0.01", "optimizer.max_iterations=1", "design.cells=[38, 10]",
           "design.min_thickness=0.01", "design.components=[10, 2]", "design.half_length=0.05",
           "output.motion_every=0.01", "output.tolerance=1e-3"});
  ASSERT_TRUE(is_done(ended, folder));
  const std::string index = contents_of(folder + "/motion/motion.pvd");
  for (int part = 0; part < 7; ++part)
    EXPECT_EQ(count(index, "part=\"" + std::to_string(part) + "\""), 2u) << part;
  const std::string with = contents_of(folder + "/motion/motion_bar1_00001.vtu"),
                    without = contents_of(folder + "/motion/motion_bar2_00002.vtu");
  EXPECT_TRUE(contains(with, "Name=\"density\""));
  EXPECT_TRUE(contains(with, "Name=\"strain_energy_per_area\""));
  EXPECT_TRUE(contains(with, "Name=\"displacement\""));
  EXPECT_TRUE(contains(without, "Name=\"strain_energy_per_area\""));
  EXPECT_TRUE(contains(without, "Name=\"displacement\""));
  EXPECT_FALSE(contains(without, "Name=\"density\""));
}

TEST(MechanismRun, CheckDescribesTheMechanism) {
  const Scratch scratch;
  const std::string out = flexmorph(scratch, {"check", "motion_platform"}).out;
  const auto row = [](const std::string& text, const std::string& label) {
    const size_t at = text.find("\n  " + label + "  ");
    return at == std::string::npos ? "" : text.substr(at, text.find('\n', at + 1) - at);
  };
  EXPECT_TRUE(testing::mentions_all(row(out, "rigid bodies"),
                                    {"5", "platform, A, B, C, D", "20 unknowns", "2.4 kg"}));
  EXPECT_TRUE(testing::mentions_all(row(out, "degrees of freedom"), {" 3 ", " 0 "}));
  EXPECT_TRUE(testing::mentions_all(row(out, "trajectory"),
                                    {"platform", "'path_x'", "'path_y'", "0", "L1, L2, alpha1"}));
  EXPECT_TRUE(testing::mentions_all(row(out, "joints"), {"4 revolute, 4 weld, 1 angle_drive"}));
  EXPECT_TRUE(contains(row(out, "springs"), "none"));
  EXPECT_FALSE(contains(out.substr(out.find("\nabsent")), "rigid bodies"));
  const Ended spring =
      flexmorph(scratch, {"check", scratch.write("rod.toml", kRod), "--set",
                          "spring=[{b='rod', stiffness=10.0}, {type='torsion', b='pointer', "
                          "damping=0.1}, {b='pointer', stiffness=1.0}]"});
  EXPECT_TRUE(testing::mentions_all(row(spring.out, "springs"), {" 3", "2 linear", "1 torsion"}))
      << spring.err;
  // Without their two drives, rod and pointer rotate freely.
  EXPECT_TRUE(testing::mentions_all(row(spring.out, "degrees of freedom"), {" 2 ", " 0 "}));
  const std::string plate = flexmorph(scratch, {"check", "plate_pendulum"}).out;
  EXPECT_TRUE(contains(row(plate, "rigid bodies"), "none"));
}

}  // namespace
}  // namespace flexmorph::test
