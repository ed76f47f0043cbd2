// Shows that drives of case files are read from formulas, tables and CSV files and refused with
// their location; and that a driven scene moves as an equivalent scene with constant speeds or with
// the inertia force of its frame, and changes its mesh in both directions as its length requires.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "cases/assembly/build.h"
#include "cases/check/check.h"
#include "tests/cases/scene/breathing_scene.h"
#include "tests/support/errors.h"

namespace flexmorph::cases {
namespace {

TEST_F(Drives, AreReadFromFormulasTablesAndFiles) {
  const Scene s = read();
  ASSERT_EQ(s.drives.size(), 3u);
  EXPECT_EQ(s.drives[0].words, "L0 + swing*sin(2*pi*t)");
  EXPECT_EQ(s.drives[1].words, "table of 6 points");
  EXPECT_EQ(s.drives[2].words, "'side.csv', column 'y', 21 points");
  EXPECT_EQ(s.hubs[0].turn.drive, "turn");
  EXPECT_EQ(s.hubs[0].angle, 0);
  EXPECT_EQ(s.hubs[0].position, Vec2(0.45, 0));
  const fem::Motion length = s.drives[0].motion(0.3);
  EXPECT_NEAR(length.value, 0.45 + 0.2 * std::sin(0.6 * std::numbers::pi), 1e-15);
  EXPECT_NEAR(length.rate, 0.4 * std::numbers::pi * std::cos(0.6 * std::numbers::pi), 1e-14);
  EXPECT_NEAR(length.acceleration,
              -0.8 * std::numbers::pi * std::numbers::pi * std::sin(0.6 * std::numbers::pi), 1e-13);
  EXPECT_NEAR(s.drives[1].motion(0.75).value, 0.6, 1e-14);
  // The error of the quintic spline of 21 points is h^6 times a factor of order 1e-2.
  EXPECT_NEAR(s.drives[2].motion(0.333).value, std::sin(0.333), 1e-9);
  EXPECT_NEAR(s.drives[2].motion(0.333).rate, std::cos(0.333), 1e-7);
}

// A start evaluates a drive slightly before t = 0, an integrator up to a rounding error beyond the
// end.
TEST_F(Drives, GoOnAsParabolasBeyondTheRun) {
  const Scene s = read({"drive.out.formula=\"0.45 + t^2.5\""});
  const fem::Motion before = s.drives[0].motion(-1e-4), end = s.drives[0].motion(1),
                    after = s.drives[0].motion(1 + 1e-3);
  EXPECT_EQ(before.value, 0.45);
  EXPECT_NEAR(after.value, end.value + 1e-3 * end.rate + 0.5e-6 * end.acceleration, 1e-15);
  EXPECT_NEAR(after.rate, end.rate + 1e-3 * end.acceleration, 1e-15);
  EXPECT_EQ(after.acceleration, end.acceleration);
}

TEST_F(Drives, LengthsOfABodyFollowTheirDrive) {
  const Scene s = read();
  const Body& plate = s.bodies[0];
  EXPECT_NEAR(plate.longest(1), 0.65, 1e-10);
  EXPECT_NEAR(plate.shortest(1), 0.25, 1e-10);
  EXPECT_NEAR(plate.length_at(0.75), 0.25, 1e-15);
  // The extremes lie between the samples, at the stationary points of t sin(t).
  const Scene odd =
      read({"time.end=9", "hub.angle=0", "hub.angular_velocity=0", "hub.position=[0, 0]",
            "drive=[{name=\"out\", formula=\"0.45 + 0.1/9*t*sin(t)\"}]"});
  // Solutions of t + tan t = 0: 2.028757838110434, 4.913180439434884, 7.978665712413241.
  EXPECT_NEAR(odd.bodies[0].longest(9),
              0.45 + 0.1 / 9 * 7.978665712413241 * std::sin(7.978665712413241), 1e-10);
  EXPECT_NEAR(odd.bodies[0].shortest(9),
              0.45 + 0.1 / 9 * 4.913180439434884 * std::sin(4.913180439434884), 1e-10);
}

TEST_F(Drives, AreRefusedWithTheirLocation) {
  const std::vector<std::pair<Changes, std::vector<std::string>>> wrong = {
      {{"drive.out.formula=\"L0 + swung*t\""}, {"character 6", "'swung'"}},
      {{"drive.out.formula=\"0.45 + t*\""}, {"character 10", "'('"}},
      {{"drive.out.formula=\"0.45/(1 - t)\""}, {"value", "t = 1 s", "infinite"}},
      {{"drive.out.formula=\"0.45 + sqrt(t)\""}, {"rate", "t = 0 s", "infinite"}},
      {{"time.end=1e15"}, {"1e+18", "2.15e+09"}},
      {{"drive.out.formula=3"}, {"formula", "quotes"}},
      {{"drive.out.table=[[0, 0]]"}, {"drive.out", "formula", "table", "csv", "from"}},
      {{"drive.turn.table=[[0, 0], [0.5, 1], [1, 2]]"}, {"points", "4", "3"}},
      {{"drive.turn.table=[[0, 0], [0.5, 1], [0.5, 2], [1, 3]]"}, {"row 3", "0.5 s", "0.5 s"}},
      {{"drive.turn.table=[[0, 0], [0.5, 1], [0.7, 2], [0.9, 3]]"}, {"time.end = 1 s", "0.9 s"}},
      {{"drive.turn.table=[[0, 0], [0.5, 1, 2]]"}, {"list", "2 numbers"}},
      {{"drive.side.csv=\"nowhere.csv\""}, {"nowhere.csv"}},
      {{"drive.side.column=z"}, {"'side.csv'", "'z'", "'time', 'y', 'note'"}},
      {{"drive.side.column=note"}, {"drive.side.csv", "side.csv:2", "number"}},
      {{"drive.side.name=out"}, {"another", "'out'"}},
      {{"constants.pi=3"}, {"reserved"}},
      {{"constants.L0=long"}, {"constant", "number"}},
      {{"hub.angle=turns"}, {"'out', 'turn', 'side'", "'turn'", "'turn'"}},
      {{"hub.angular_velocity=1"}, {"drive", "angle"}},
      {{"hub.position=[\"side\"]"}, {"list of 2", "'out', 'turn', 'side'"}},
      {{"time.start=hub_at_rest"}, {"hub.position", "time.start", "hub_at_rest"}},
      {{"body.flow.speed=0.1"}, {"`speed`", "`length`"}},
      {{"body.length=0.4"}, {"body.flow.length", "0.45 m", "'plate'", "0.4 m"}},
      {{"constants.swing=0.44"}, {"body.flow.length", "min_length", "0.01 m"}},
      {{"body.flow.min_length=0.045"}, {"0.9", "max_length"}},
      {{"drive.extra=1"}, {"out, turn, side"}},
  };
  for (const auto& [changes, parts] : wrong) {
    const std::string message = complaint(changes);
    EXPECT_TRUE(testing::mentions_all(message, parts,
                                      location_in(message, scratch_ / "breathing.toml", changes)));
    EXPECT_EQ(message.find('\n'), std::string::npos) << message;
  }
  // For an error in the file itself the message contains file, line and key.
  std::string text = kBreathing;
  text.replace(text.find("L0 + swing"), 10, "L0 + twist");
  try {
    read({}, text);
    FAIL();
  } catch (const Error& e) {
    EXPECT_TRUE(contains(e.what(), "breathing.toml:11:11: drive.out.formula = "));
    EXPECT_TRUE(testing::mentions_all(e.what(), {"character 6", "'twist'"}));
  }
}

TEST_F(Drives, AreShownByCheck) {
  const std::string out = check_case(scratch_.write("breathing.toml", kBreathing), {}, false);
  const auto line = [&](const std::string& start) {
    const size_t at = out.find("\n  " + start);
    return at == std::string::npos ? "" : out.substr(at, out.find('\n', at + 1) - at);
  };
  EXPECT_TRUE(
      testing::mentions_all(line("drive out "), {"L0 + swing*sin(2*pi*t)", "0.25", "0.65"}));
  EXPECT_TRUE(testing::mentions_all(line("drive side "), {"'side.csv'", "'y'", "21", "0.841471"}));
  EXPECT_TRUE(testing::mentions_all(out, {"drive 'out'", "0.25", "0.65 m"}));
}

struct Course {
  fem::MotionResult result;
  std::vector<double> times;
  std::vector<Vec2> tips;  // in the axes of the hub
};

Course run(const Scene& scene) {
  Mechanism m = build_mechanism(scene);
  Course out;
  out.result = fem::integrate(m.model, m.moving_roots, m.motion, [&](const fem::MotionStep& step) {
    out.times.push_back(step.x.t);
    const Body& body = scene.bodies[0];
    const fem::FrameMotion hub = m.moving_roots[0].hub.at(step.model, step.x);
    const Vec2 tip =
        fem::point_position(step.model.body(body.name), step.x,
                            {body.longest(scene.time.end), body.low() + 0.5 * body.width})
            .head<2>();
    out.tips.push_back(fem::rotation(hub.angle).transpose() * (tip - hub.origin));
  });
  return out;
}

// Reference times follow from arcsines. The root lies at m = 0.65 - L. While the length increases,
// the first element reaches 0.1 m at L = 0.5, 0.55, 0.6, and a line is inserted 0.05 m from the
// root; L = 0.65 is reached at the turning point between two steps. While it decreases, lines lie
// at 0.1, 0.15, ... and are removed 0.03 m from the root, at L = 0.58, 0.53, ..., the last one at
// 0.4 m. When it increases again, the first line lies at 0.45 m.
TEST_F(Drives, InsertAndRemoveLinesAsTheLengthGoesUpAndDown) {
  const Scene scene = read({"hub.angle=0", "hub.angular_velocity=1", "hub.position=[0, 0]"});
  const Course course = run(scene);
  const std::vector<fem::MeshEvent>& events = course.result.events;
  const auto rising = [](double length) {
    return std::asin((length - 0.45) / 0.2) / (2 * std::numbers::pi);
  };
  std::vector<std::pair<double, fem::MeshChange>> expected;
  for (const double length : {0.5, 0.55, 0.6})
    expected.emplace_back(rising(length), fem::MeshChange::insertion);
  for (const double length : {0.58, 0.53, 0.48, 0.43, 0.38, 0.33, 0.28})
    expected.emplace_back(0.5 - rising(length), fem::MeshChange::removal);
  for (const double length : {0.3, 0.35, 0.4})
    expected.emplace_back(1 + rising(length), fem::MeshChange::insertion);
  ASSERT_EQ(events.size(), expected.size());
  for (size_t i = 0; i < events.size(); ++i) {
    EXPECT_NEAR(events[i].time, expected[i].first, 1e-9) << i;
    EXPECT_EQ(events[i].change, expected[i].second) << i;
    const bool opposite = i > 0 && events[i].change != events[i - 1].change;
    if (opposite) {
      EXPECT_GT(events[i].time - events[i - 1].time, 0.02);
    }
  }
}

// The driven scene has the mesh and the motion of the scene with constant speeds. The equations are
// equal up to round-off, which a stiff plate amplifies to less than 1e-9 in 200 steps.
TEST_F(Drives, OfConstantSpeedAreConstantSpeeds) {
  std::string text = kBreathing;
  const std::string by_drive = "length = \"out\"";
  text.replace(text.find(by_drive), by_drive.size(), "speed = 0.3");
  const Scene constant = read(
      {"time.end=0.2", "hub.position=[0, 0]", "hub.angle=0.1", "hub.angular_velocity=2"}, text);
  const Scene driven = read({"time.end=0.2", "hub.position=[0, 0]",
                             "drive=[{name=\"out\", formula=\"L0 + 0.3*t\"}, {name=\"turn\", "
                             "formula=\"0.1 + 2*t\"}]"});
  const Course a = run(constant), b = run(driven);
  ASSERT_EQ(a.result.events.size(), 1u);
  ASSERT_EQ(b.result.events.size(), 1u);
  EXPECT_NEAR(a.result.events[0].time, b.result.events[0].time, 1e-12);
  ASSERT_EQ(a.tips.size(), b.tips.size());
  for (size_t i = 0; i < a.tips.size(); ++i) EXPECT_LT((a.tips[i] - b.tips[i]).norm(), 1e-9) << i;
}

// Equivalence of acceleration and gravity: a hub that is accelerated upwards at 9.81 m/s^2 bends
// its plate as its weight does.
TEST_F(Drives, OfPositionsActLikeGravity) {
  const auto with = [](const std::string& position, const std::string& gravity) {
    return Changes{"time.end=0.1",
                   "time.start=rigid",
                   "hub.angle=0",
                   "hub.angular_velocity=0",
                   "drive=[{name=\"out\", formula=\"0.45\"}, {name=\"side\", formula=\"0\"}, "
                   "{name=\"up\", formula=\"9.81/2*t^2\"}]",
                   "hub.position=" + position,
                   "gravity=" + gravity};
  };
  const Course lifted = run(read(with("[\"side\", \"up\"]", "[0, 0]")));
  const Course heavy = run(read(with("[0, 0]", "[0, -9.81]")));
  ASSERT_EQ(lifted.tips.size(), heavy.tips.size());
  EXPECT_LT(heavy.tips.back().y(), -1e-3);
  for (size_t i = 0; i < heavy.tips.size(); ++i)
    EXPECT_LT((lifted.tips[i] - heavy.tips[i]).norm(), 1e-9) << i;
}

// A plate that is pushed out of a static hub and drawn back, L(t), is stretched by its own inertia.
// Reference: the quasi-static end displacement u = -ρ L̈ L² / (2 E). Waves travel along the plate
// in L/c = 2 ms; the jump of the third derivative at the start excites 2π / (π c / (2 L)) = 1 % of
// the largest stretch.
TEST_F(Drives, OfLengthsAccelerateTheMaterial) {
  const Scene scene = read(
      {"hub.angle=0", "hub.angular_velocity=0", "hub.position=[0, 0]", "body.poisson_ratio=0"});
  const Course course = run(scene);
  const auto stretch = [&](double t) {
    const fem::Motion length = scene.drives[0].motion(t);
    return -2700 * length.acceleration * length.value * length.value / (2 * 1e8);
  };
  double largest = 0;
  for (const double t : course.times) largest = std::max(largest, stretch(t));
  EXPECT_GT(largest, 2e-5);
  for (size_t i = 0; i < course.tips.size(); ++i) {
    const double t = course.times[i];
    EXPECT_NEAR(course.tips[i].x() - scene.bodies[0].length_at(t), stretch(t), 0.02 * largest) << t;
    EXPECT_NEAR(course.tips[i].y(), 0, 1e-12);
  }
}

// A line drive with a linear function `at` equals a line drive with a constant speed.
TEST_F(Drives, OfFreeLinesMoveThemThroughTheMaterial) {
  const std::string sleeve = contents_of(std::string(FLEXMORPH_CASES) + "/elastic_sleeve.toml");
  const std::string drive = "\n[[drive]]\nname = \"slide\"\nformula = \"0.42 + 0.5*t\"\n";
  const std::string joint = "\n[[joint]]\ntype = \"line_drive\"\nbody = \"strip\"\nline = 3\n";
  const Changes brief = {"time.end=0.02"};
  const Scene driven = read(brief, sleeve + joint + "at = \"slide\"\n" + drive);
  const Scene constant = read(brief, sleeve + joint + "speed = 0.5\n");
  const auto end = [](const Scene& scene) {
    Mechanism m = build_mechanism(scene);
    return fem::integrate(m.model, m.moving_roots, m.motion, [](const fem::MotionStep&) {}).final.q;
  };
  EXPECT_LT((end(driven) - end(constant)).cwiseAbs().maxCoeff(), 1e-9);
  for (const auto& [change, parts] :
       {std::pair<std::string, std::vector<std::string>>{"drive.formula=\"0.4 + t\"",
                                                         {"joint.1.at", "0.4 m", "0.42 m"}},
        {"joint.1.speed=1", {"joint.1.speed", "`speed`", "`at`"}}}) {
    try {
      read({change}, sleeve + joint + "at = \"slide\"\n" + drive);
      FAIL();
    } catch (const Error& e) {
      EXPECT_TRUE(testing::mentions_all(e.what(), parts));
    }
  }
}

// A plate extends from the point (0.1, 0) of a tool along its axis: the point (m, n) of the plate
// is (0.1 + m, n) in the axes of the tool, which follows a path. Three struts of driven lengths
// hold the plate.
TEST_F(Drives, FromATrajectoryAreLengthsToPointsOfPlatesToo) {
  std::string text = R"toml(
[time]
end = 0.5
[trajectory]
body = "tool"
x = "x"
y = 0.2
angle = 0.1
[[drive]]
name = "x"
formula = "0.3*t"
[[rigid_body]]
name = "tool"
mass = 1.0
inertia = 0.1
position = [0.0, 0.2]
angle = 0.1
[[body]]
name = "blade"
element = "ancf_plate"
terms = ["inertia", "membrane"]
length = 0.4
width = 0.1
thickness = 0.01
density = 2700.0
youngs_modulus = 1e8
poisson_ratio = 0.3
elements = [4, 1]
[[joint]]
type = "weld"
body = "blade"
edge = "root"
to = "tool"
point = [0.1, 0.0]
)toml";
  const std::pair<Vec2, Vec2> struts[] = {
      {{-0.5, -0.6}, {0, 0}}, {{0.1, -0.9}, {0.1, -0.05}}, {{0.9, -0.4}, {0.4, 0.05}}};
  const auto pair = [](const Vec2& x) {
    return "[" + io::to_text(x.x()) + ", " + io::to_text(x.y()) + "]\n";
  };
  const std::string names[] = {"first", "second", "third"};
  for (size_t i = 0; i < 3; ++i)
    text += "[[drive]]\nname = \"" + names[i] +
            "\"\nfrom = \"trajectory\"\n[[joint]]\ntype = \"distance\"\npoint_a = " +
            pair(struts[i].first) + "b = \"blade\"\npoint_b = " + pair(struts[i].second) +
            "distance = \"" + names[i] + "\"\n";
  const Scene scene = read({}, text);
  const Eigen::Matrix2d turn = fem::rotation(0.1);
  for (size_t i = 0; i < 3; ++i)
    for (const double t : {0.0, 0.123, 0.5}) {
      const Vec2 tool(0.3 * t, 0.2), foot = struts[i].first, head = struts[i].second;
      const Vec2 strut = tool + turn * (Vec2(0.1, 0) + head) - foot;
      const fem::Motion length = scene.motion_of({names[i]})(t);
      EXPECT_NEAR(length.value, strut.norm(), 1e-11) << names[i] << t;
      EXPECT_NEAR(length.rate, 0.3 * strut.x() / strut.norm(), 1e-9) << names[i] << t;
    }
}

}  // namespace
}  // namespace flexmorph::cases
