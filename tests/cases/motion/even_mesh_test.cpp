// Meshes without events: all lines of a plate that grows or retracts move so that its elements stay
// equal, and what rests on that: order two of the energy balance, loads, other integrators, plates
// on rigid bodies.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "fem/dynamics/gradients/motion_gradient.h"
#include "tests/cases/scenes.h"
#include "tests/support/differences.h"
#include "tests/support/rates.h"

namespace flexmorph::cases {
namespace {

Changes even(Changes more = {}, const std::string& body = "body.0") {
  for (const char* each : {".flow.max_length=", ".flow.min_length=", ".flow.mesh=even"})
    more.insert(more.begin(), body + each);
  return more;
}

/// Without its design: full material.
const Changes kFull = {"design=", "optimizer=", "esl=", "verify=", "cycle="};

Changes with(Changes a, const Changes& b) {
  a.insert(a.end(), b.begin(), b.end());
  return a;
}

const fem::LineGrid& grid_of(const Mechanism& m, const std::string& body) {
  return fem::grid_of(m.model.body(body));
}

/// Lines i/n of the length L(t) behind the root, with their rates and accelerations.
void expect_equal_elements(const Scene& scene, const Body& body, std::array<int, 2> count,
                           int refine) {
  const Mechanism m = build_mechanism(scene, {.elements = {}, .refine = refine});
  const std::unique_ptr<fem::LineGrid> mesh = grid_of(m, body.name).copy();
  ASSERT_EQ(mesh->n_m(), refine * count[0]);
  const double end = body.longest(scene.time.end), h = 1e-3;
  for (const double t : {0.0, 0.3, 0.7}) {
    const double time = t * scene.time.end + 2 * h;
    const auto place = [&](int i) {
      return [&, i](double s) {
        return end - (1 - static_cast<double>(i) / mesh->n_m()) * body.length_at(time + s);
      };
    };
    mesh->move_to(time);
    for (int i = 0; i <= mesh->n_m(); ++i) {
      const fem::Motion& line = mesh->line_m(i);
      EXPECT_NEAR(line.value, place(i)(0), 1e-15) << i;
      EXPECT_NEAR(line.rate, testing::first_difference(place(i), h), 1e-9) << i;
      EXPECT_NEAR(line.acceleration, testing::second_difference(place(i), h), 1e-6) << i;
    }
  }
}

TEST(EvenMesh, KeepsElementsEqual) {
  for (const double speed : {0.5, -0.3}) {
    const Scene scene = read("rotating_plate_v05",
                             even(with(kFull, {"body.0.flow.speed=" + std::to_string(speed)})));
    expect_equal_elements(scene, scene.bodies[0], {10, 2}, 1);
    expect_equal_elements(scene, scene.bodies[0], {10, 2}, 2);
  }
  const Scene crane = read("telescopic_crane", even(kFull));  // a drive says its length
  for (const Body& body : crane.bodies)
    if (body.flow) expect_equal_elements(crane, body, body.elements, 1);
  const Scene plate = read("deploying_plate", even());
  expect_equal_elements(plate, plate.bodies[0], plate.bodies[0].elements, 1);
}

// The length changes from 0.5 m by the speed in 1 s. Elements of an even mesh are no longer than
// max_length, 0.1 m, when the plate is longest, and no shorter than a given min_length.
TEST(EvenMesh, IsTheDefaultWhereTheLengthChangesByLessThanAFactorOfFour) {
  struct Row {
    Changes changes;
    int elements;  // 0: split
  };
  for (const Row& row : {Row{{}, 10}, Row{{"body.0.flow.max_length="}, 10},
                         Row{{"body.0.flow.speed=1.4"}, 19}, Row{{"body.0.flow.speed=1.6"}, 0},
                         Row{{"body.0.flow.speed=-0.37"}, 10}, Row{{"body.0.flow.speed=-0.38"}, 0},
                         Row{{"body.0.flow.speed=-0.3", "body.0.flow.min_length=0.03"}, 0},
                         Row{{"body.0.flow.speed=-0.3", "body.0.flow.min_length=0.02"}, 10}}) {
    const Scene scene =
        read("rotating_plate_v05", with(with(kFull, {"body.0.flow.mesh="}), row.changes));
    const Body& body = scene.bodies[0];
    const std::string which = row.changes.empty() ? "as it is" : row.changes.back();
    EXPECT_EQ(body.is_even(), row.elements > 0) << which;
    EXPECT_EQ(build_mechanism(scene).growths.at(0).max_length < 1, row.elements == 0) << which;
    if (row.elements > 0) {
      EXPECT_EQ(body.elements[0], row.elements) << which;
    }
  }
}

/// Bars aslant, of as much material in every column of cells of 5 mm; no line of the mesh stays on
/// one. (Columns that differ at random set off ringing as they enter, which is no error.)
void give_factors(const Scene& scene, Mechanism& m) {
  const Body& body = scene.bodies[0];
  const double longest = body.longest(scene.time.end);
  const Grid grid{0, body.low(), longest, body.width, static_cast<int>(200 * longest), 20};
  VectorXd factor(grid.n_cells());
  for (int i = 0; i < grid.nx; ++i)
    for (int j = 0; j < grid.ny; ++j) {
      const Vec2 at = grid.cell_center(i, j) / body.width;
      factor[grid.cell(i, j)] = 0.6 + 0.35 * std::cos(2 * std::numbers::pi * (at.x() + at.y()));
    }
  m.model.set_factors(m.model.bodies().back(), {grid, factor, factor});
}

struct Moved {
  const char* name;
  std::string scene;
  Changes changes;
  bool designed = false;
  /// With a design they land where the root passes from one column of its cells to the next.
  std::vector<double> steps = {2e-3, 1e-3, 5e-4};
};
void PrintTo(const Moved& m, std::ostream* out) { *out << m.name; }

class EvenMotion : public ::testing::TestWithParam<Moved> {};

// What an insertion sets off has frequencies that no step resolves: without any, the defect falls
// with the square of the step.
TEST_P(EvenMotion, BalancesItsEnergyWithOrderTwo) {
  const Moved& c = GetParam();
  const Scene scene = read(c.scene, even(c.changes));
  const testing::Rate rate = testing::fit_rate(c.steps, [&](double h) {
    Mechanism m = build_mechanism(scene);
    set_step(scene, h, m.motion);
    if (c.designed) give_factors(scene, m);
    const fem::MotionResult r =
        fem::integrate(m.model, m.growths, m.motion, [](const fem::MotionStep&) {});
    EXPECT_TRUE(r.events.empty());
    EXPECT_EQ(r.counts.rejected, 0);
    return r.energy_defect;
  });
  EXPECT_NEAR(rate.order(), 2, 0.1) << rate.table();
}

INSTANTIATE_TEST_SUITE_P(
    Cases, EvenMotion,
    ::testing::Values(
        Moved{"growing", "rotating_plate_v05", with(kFull, {"body.0.elements=[5, 1]"})},
        Moved{"slow", "rotating_plate_v01", with(kFull, {"body.0.elements=[5, 1]"})},
        Moved{"designed", "rotating_plate_v05", with(kFull, {"body.0.elements=[5, 1]"}), true},
        Moved{"in_space",
              "deploying_plate",
              {"time.end=0.2", "body.0.elements=[4, 1]"},
              false,
              {1e-3, 5e-4, 2.5e-4}},
        Moved{"retracting",
              "rotating_plate_v05",
              with(kFull, {"body.0.elements=[5, 1]", "body.0.flow.speed=-0.3"}),
              false,
              {1e-3, 5e-4, 2.5e-4}}),
    [](const auto& info) { return std::string(info.param.name); });

/// The largest of |a - b| at the tip over a motion.
struct Path {
  std::vector<Vec3> tip;
  fem::MotionResult result;
};
Path path(const Scene& scene) {
  Mechanism m = build_mechanism(scene);
  const Body& body = scene.body(m.growths.at(0).body);
  const Vec2 tip(body.longest(scene.time.end), 0);
  for (int i = 1; i <= 8; ++i) m.motion.stops.push_back(i * m.motion.end / 8);
  Path out;
  out.result = fem::integrate(m.model, m.growths, m.motion, [&](const fem::MotionStep& step) {
    if (step.stop) out.tip.push_back(fem::point_position(step.model.body(body.name), step.x, tip));
  });
  return out;
}
double distance(const Path& a, const Path& b) {
  EXPECT_EQ(a.tip.size(), b.tip.size());
  double out = 0;
  for (size_t k = 0; k < a.tip.size() && k < b.tip.size(); ++k)
    out = std::max(out, (a.tip[k] - b.tip[k]).norm());
  return out;
}

// Both rules of the mesh approach one motion: tips are within a hundredth of the deflections.
TEST(EvenMesh, MovesAsSplitMeshesDo) {
  struct Pair {
    std::string scene;
    Changes changes, even;
    double close;  // of the tip [m]
  };
  Changes platform = with({}, {"time.end=0.1"});
  const std::vector<Pair> pairs = {
      // Deflections of 2 cm; of 3 cm in space; of plates that rigid bodies carry, of 1 mm.
      {"rotating_plate_v05", with(kFull, {"time.end=0.3"}), even(), 2e-4},
      {"rotating_plate_v05",
       with(kFull, {"time.end=0.3", "time.integrator=energy_momentum", "time.rho_inf="}), even(),
       2e-4},
      {"rotating_plate_v05",
       with(kFull, {"time.end=0.3", "time.step=adaptive", "time.tolerance=1e-4"}), even(), 2e-4},
      {"deploying_plate", {"time.end=0.3", "body.0.flow.mesh=split"}, even(), 1e-4},
      {"motion_platform", with(kFull, platform), with(even(), even({}, "body.1")), 2e-5},
      {"telescopic_crane", with(kFull, {"time.end=0.3", "body.0.flow.mesh=split"}), even(), 2e-4},
  };
  for (const Pair& p : pairs) {
    const Path split = path(read(p.scene, p.changes)),
               moved = path(read(p.scene, with(p.changes, p.even)));
    EXPECT_TRUE(moved.result.events.empty()) << p.scene;
    EXPECT_LT(distance(split, moved), p.close) << p.scene;
    EXPECT_GT(distance(split, moved), 0) << p.scene;
  }
}

// A load of the motion lives on the design mesh, which is the same whatever moved.
TEST(EvenMesh, MakesTheLoadsOfSplitOnes) {
  const auto load = [](const Changes& changes) {
    const Scene scene = read("rotating_plate_v05", with({"time.end=0.5"}, changes));
    Mechanism m = build_mechanism(scene);
    const Grid grid{0, -0.05, scene.bodies[0].longest(0.5), 0.1, 30, 4};
    m.motion.stops = {0.4};
    fem::EslSet out;
    fem::integrate(m.model, m.growths, m.motion, [&](const fem::MotionStep& step) {
      if (step.stop)
        out =
            fem::equivalent_static_load(step.model, step.x, m.growths[0], grid, {}, {}, VectorXd());
    });
    return out;
  };
  const fem::EslSet split = load(kFull), moved = load(even(kFull));
  EXPECT_EQ(split.root_column, moved.root_column);
  // By as much as 10 x 2 elements are wrong.
  EXPECT_LT((split.deformation - moved.deformation).norm(), 2e-3 * split.deformation.norm());
  // What insertions have set off is in the one and not in the other.
  EXPECT_LT((split.acceleration - moved.acceleration).norm(), 3e-2 * split.acceleration.norm());
  EXPECT_NEAR(split.strain_energy, moved.strain_energy, 2e-3 * split.strain_energy);
}

// The adjoint of the steps goes back through lines that all move, factors under them.
TEST(EvenMesh, HasTheExactGradientOfItsMotion) {
  const Scene scene =
      read("rotating_plate_v05", even(with(kFull, {"body.0.elements=[5, 1]", "time.end=0.05"})));
  Mechanism m = build_mechanism(scene);
  set_step(scene, 2.5e-3, m.motion);
  give_factors(scene, m);
  m.motion.alpha.tolerance = 1e-13;
  m.motion.stops = {0.02, 0.05};
  using Times = fem::MotionObjective::Times;
  const Vec2 tip(scene.bodies[0].longest(scene.time.end), 0);
  const std::vector<fem::MotionObjective> objectives = {
      {fem::measure_strain_energy(), Times::stops, 1},
      {fem::measure_deflection("plate", tip, m.growths.at(0).hub, 0), Times::steps, 8}};
  const fem::MotionGradients g = fem::motion_gradients(m.model, m.growths, m.motion, objectives);
  fem::Body& plate = m.model.bodies().back();
  const fem::Factors at = plate.factors;
  // Some cells more than others, stiffness and mass unlike.
  const VectorXd along = VectorXd::LinSpaced(at.mass.size(), -1, 2).array().sin(),
                 across = VectorXd::LinSpaced(at.mass.size(), 0, 60).array().cos();
  const auto values = [&](double s) {
    m.model.set_factors(plate, {at.grid, at.stiffness + s * along, at.mass + s * across});
    const std::vector<double> v = fem::motion_values(m.model, m.growths, m.motion, objectives);
    return Vec2(v[0], v[1]);
  };
  const Vec2 differences = testing::first_difference(values, 1e-3);
  for (size_t k = 0; k < 2; ++k) {
    const fem::FactorSlopes& by = g.of[k].by_factors.back();
    const double expected = differences[static_cast<Eigen::Index>(k)];
    EXPECT_NEAR(by.stiffness.dot(along) + by.mass.dot(across), expected, 1e-7 * std::abs(expected))
        << k;
  }
}

std::string complaint(const std::string& name, const Changes& changes) {
  try {
    read(name, changes);
  } catch (const Error& e) {
    EXPECT_EQ(e.kind(), Error::Kind::input);
    return e.what();
  }
  return "";
}

TEST(EvenMesh, IsRefusedWhereItCannotBe) {
  const std::vector<std::pair<Changes, std::string>> wrong = {
      {{"body.0.flow.mesh=uneven"}, "a rule of the mesh is one of 'split', 'even'"},
      {{"body.0.flow.mesh=", "body.0.flow.speed=1.6", "body.0.flow.max_length="},
       "`max_length` is missing: the mesh is \"split\""},
      {{"body.0.flow.mesh=even", "body.0.flow.min_length=0.06"},
       "the 10 elements of an even mesh are 0.05 m long when the body is shortest"},
      {{"body.0.flow.mesh=even", "body.0.flow.max_length=1e-5"},
       "an even mesh with it has more than 100000 elements"},
      {even({"body.0.shape=q4"}), "lie where they lie in the design"},
      {even({"body.0.flow.speed=-0.5"}),
       "some of the body stays outside of the hub, but 0 m are left at time.end"},
      {even({"body.0.line=[{index=1, at=0.1}]"}), "its lines move with it, or come and go"},
      {even({"joint.0.edge=\"line 3\""}), "an edge is"},
  };
  for (const auto& [changes, words] : wrong) {
    const std::string message = complaint("rotating_plate_v05", with(kFull, changes));
    EXPECT_NE(message.find(words), std::string::npos) << changes[0] << ": " << message;
  }
}

}  // namespace
}  // namespace flexmorph::cases
