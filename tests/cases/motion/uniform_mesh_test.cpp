// Shows that all lines of a plate on a uniform mesh move such that its elements stay equal while
// the plate grows or retracts, without mesh changes; and that energy balances of second order,
// loads, other integrators and plates on rigid bodies work with such meshes.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "fem/dynamics/gradients/motion_gradient.h"
#include "tests/cases/scenes.h"
#include "tests/support/differences.h"
#include "tests/support/errors.h"
#include "tests/support/rates.h"

namespace flexmorph::cases {
namespace {

Changes uniform(Changes more = {}, const std::string& body = "body.0") {
  for (const char* each : {".flow.max_length=", ".flow.min_length=", ".flow.mesh=uniform"})
    more.insert(more.begin(), body + each);
  return more;
}

/// Changes that remove the design: full material.
const Changes kFull = {"design=", "optimizer=", "esl=", "verify=", "cycle="};

Changes with(Changes a, const Changes& b) {
  a.insert(a.end(), b.begin(), b.end());
  return a;
}

const fem::LineGrid& grid_of(const Mechanism& m, const std::string& body) {
  return fem::grid_of(m.model.body(body));
}

/// Expects lines at i/n of the length L(t) behind the root, and their rates and accelerations (by
/// difference quotients).
void expect_equal_elements(const Scene& scene, const Body& body, std::array<int, 2> count,
                           int refine) {
  const Mechanism m = build_mechanism(scene, {.elements = {}, .refine = refine});
  const std::unique_ptr<fem::LineGrid> mesh = grid_of(m, body.name).copy();
  ASSERT_EQ(mesh->n_m(), refine * count[0]);
  const double end = body.longest(scene.time.end), h = 1e-3;
  for (const double t : {0.0, 0.3, 0.7}) {
    const double time = t * scene.time.end + 2 * h;
    const auto location = [&](int i) {
      return [&, i](double s) {
        return end - (1 - static_cast<double>(i) / mesh->n_m()) * body.length_at(time + s);
      };
    };
    mesh->move_to(time);
    for (int i = 0; i <= mesh->n_m(); ++i) {
      const fem::Motion& line = mesh->line_m(i);
      EXPECT_NEAR(line.value, location(i)(0), 1e-15) << i;
      EXPECT_NEAR(line.rate, testing::first_difference(location(i), h), 1e-9) << i;
      EXPECT_NEAR(line.acceleration, testing::second_difference(location(i), h), 1e-6) << i;
    }
  }
}

TEST(UniformMesh, KeepsElementsEqual) {
  for (const double speed : {0.5, -0.3}) {
    const Scene scene = read("rotating_plate_v05",
                             uniform(with(kFull, {"body.0.flow.speed=" + std::to_string(speed)})));
    expect_equal_elements(scene, scene.bodies[0], {10, 2}, 1);
    expect_equal_elements(scene, scene.bodies[0], {10, 2}, 2);
  }
  const Scene crane = read("telescopic_crane", uniform(kFull));  // a drive gives the length
  for (const Body& body : crane.bodies)
    if (body.flow) expect_equal_elements(crane, body, body.elements, 1);
  const Scene plate = read("deploying_plate", uniform());
  expect_equal_elements(plate, plate.bodies[0], plate.bodies[0].elements, 1);
}

// The length changes from 0.5 m by the speed times 1 s. The elements of a uniform mesh are at most
// max_length = 0.1 m long when the plate is longest, and not shorter than a given min_length.
TEST(UniformMesh, IsTheDefaultWhereTheLengthChangesByLessThanAFactorOfFour) {
  struct Row {
    Changes changes;
    int elements;  // 0 means that the mesh is split
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
    EXPECT_EQ(body.has_uniform_mesh(), row.elements > 0) << which;
    EXPECT_EQ(build_mechanism(scene).moving_roots.at(0).max_length < 1, row.elements == 0) << which;
    if (row.elements > 0) {
      EXPECT_EQ(body.elements[0], row.elements) << which;
    }
  }
}

/// Sets scale factors in the form of oblique bars, with equal material in every column of cells of
/// 5 mm; lines of the mesh pass from column to column. (Columns that differ at random would excite
/// vibrations as they enter, which is not an error.)
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
  /// Steps [s]. With a design, steps also end when the root passes from one column of cells to the
  /// next.
  std::vector<double> steps = {2e-3, 1e-3, 5e-4};
};
void PrintTo(const Moved& m, std::ostream* out) { *out << m.name; }

class UniformMotion : public ::testing::TestWithParam<Moved> {};

// An insertion excites frequencies that no step resolves. Without insertions the energy error
// decreases with the square of the step.
TEST_P(UniformMotion, BalancesItsEnergyWithOrderTwo) {
  const Moved& c = GetParam();
  const Scene scene = read(c.scene, uniform(c.changes));
  const testing::Rate rate = testing::fit_rate(c.steps, [&](double h) {
    Mechanism m = build_mechanism(scene);
    set_step(scene, h, m.motion);
    if (c.designed) give_factors(scene, m);
    const fem::MotionResult r =
        fem::integrate(m.model, m.moving_roots, m.motion, [](const fem::MotionStep&) {});
    EXPECT_TRUE(r.events.empty());
    EXPECT_EQ(r.counts.rejected, 0);
    return r.energy_error;
  });
  EXPECT_NEAR(rate.order(), 2, 0.1) << rate.table();
}

INSTANTIATE_TEST_SUITE_P(
    Cases, UniformMotion,
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

/// Positions of the tip at eight times of a motion, and the result of the motion.
struct Path {
  std::vector<Vec3> tip;
  fem::MotionResult result;
};
Path path(const Scene& scene) {
  Mechanism m = build_mechanism(scene);
  const Body& body = scene.body(m.moving_roots.at(0).body);
  const Vec2 tip(body.longest(scene.time.end), 0);
  for (int i = 1; i <= 8; ++i) m.motion.stops.push_back(i * m.motion.end / 8);
  Path out;
  out.result = fem::integrate(m.model, m.moving_roots, m.motion, [&](const fem::MotionStep& step) {
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

// Both mesh rules give one motion: the positions of the tips differ by at most about a hundredth of
// the deflections.
TEST(UniformMesh, MovesAsSplitMeshesDo) {
  struct Pair {
    std::string scene;
    Changes changes, even;
    double close;  // tolerance at the tip [m]
  };
  Changes platform = with({}, {"time.end=0.1"});
  const std::vector<Pair> pairs = {
      // The deflections are 2 cm; 3 cm in space; 1 mm for plates carried by rigid bodies.
      {"rotating_plate_v05", with(kFull, {"time.end=0.3"}), uniform(), 2e-4},
      {"rotating_plate_v05",
       with(kFull, {"time.end=0.3", "time.integrator=energy_momentum", "time.rho_inf="}), uniform(),
       2e-4},
      {"rotating_plate_v05",
       with(kFull, {"time.end=0.3", "time.step=adaptive", "time.tolerance=1e-4"}), uniform(), 2e-4},
      {"deploying_plate", {"time.end=0.3", "body.0.flow.mesh=split"}, uniform(), 1e-4},
      {"motion_platform", with(kFull, platform), with(uniform(), uniform({}, "body.1")), 2e-5},
      {"telescopic_crane", with(kFull, {"time.end=0.3", "body.0.flow.mesh=split"}), uniform(),
       2e-4},
  };
  for (const Pair& p : pairs) {
    const Path split = path(read(p.scene, p.changes)),
               moved = path(read(p.scene, with(p.changes, p.even)));
    EXPECT_TRUE(moved.result.events.empty()) << p.scene;
    EXPECT_LT(distance(split, moved), p.close) << p.scene;
    EXPECT_GT(distance(split, moved), 0) << p.scene;
  }
}

// An equivalent static load is given on the design mesh, which does not depend on the mesh of the
// motion.
TEST(UniformMesh, MakesTheLoadsOfSplitOnes) {
  const auto load = [](const Changes& changes) {
    const Scene scene = read("rotating_plate_v05", with({"time.end=0.5"}, changes));
    Mechanism m = build_mechanism(scene);
    const Grid grid{0, -0.05, scene.bodies[0].longest(0.5), 0.1, 30, 4};
    m.motion.stops = {0.4};
    fem::EslSet out;
    fem::integrate(m.model, m.moving_roots, m.motion, [&](const fem::MotionStep& step) {
      if (step.stop)
        out = fem::equivalent_static_load(step.model, step.x, m.moving_roots[0], grid, {}, {},
                                          VectorXd());
    });
    return out;
  };
  const fem::EslSet split = load(kFull), moved = load(uniform(kFull));
  EXPECT_EQ(split.root_column, moved.root_column);
  // The tolerance is the discretization error of 10 x 2 elements.
  EXPECT_LT((split.deformation - moved.deformation).norm(), 2e-3 * split.deformation.norm());
  // Only the motion with insertions contains the vibrations that insertions excite.
  EXPECT_LT((split.acceleration - moved.acceleration).norm(), 3e-2 * split.acceleration.norm());
  EXPECT_NEAR(split.strain_energy, moved.strain_energy, 2e-3 * split.strain_energy);
}

// The adjoint solution is correct on a mesh whose lines all move across the cells of the scale
// factors.
TEST(UniformMesh, HasTheExactGradientOfItsMotion) {
  const Scene scene =
      read("rotating_plate_v05", uniform(with(kFull, {"body.0.elements=[5, 1]", "time.end=0.05"})));
  Mechanism m = build_mechanism(scene);
  set_step(scene, 2.5e-3, m.motion);
  give_factors(scene, m);
  m.motion.alpha.tolerance = 1e-13;
  m.motion.stops = {0.02, 0.05};
  using Times = fem::MotionObjective::Times;
  const Vec2 tip(scene.bodies[0].longest(scene.time.end), 0);
  const std::vector<fem::MotionObjective> objectives = {
      {fem::measure_strain_energy(), Times::stops, 1},
      {fem::measure_deflection("plate", tip, m.moving_roots.at(0).hub, 0), Times::steps, 8}};
  const fem::MotionGradients g =
      fem::motion_gradients(m.model, m.moving_roots, m.motion, objectives);
  fem::Body& plate = m.model.bodies().back();
  const fem::ScaleFactors at = plate.factors;
  // The directions differ from cell to cell and between stiffness and mass.
  const VectorXd along = VectorXd::LinSpaced(at.mass.size(), -1, 2).array().sin(),
                 across = VectorXd::LinSpaced(at.mass.size(), 0, 60).array().cos();
  const auto values = [&](double s) {
    m.model.set_factors(plate, {at.grid, at.stiffness + s * along, at.mass + s * across});
    const std::vector<double> v = fem::motion_values(m.model, m.moving_roots, m.motion, objectives);
    return Vec2(v[0], v[1]);
  };
  const Vec2 differences = testing::first_difference(values, 1e-3);
  for (size_t k = 0; k < 2; ++k) {
    const fem::ScaleFactorGradient& by = g.of[k].d_factors.back();
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

TEST(UniformMesh, IsRefusedWhereItCannotBe) {
  const std::vector<std::pair<Changes, std::vector<std::string>>> wrong = {
      {{"body.0.flow.mesh=uneven"}, {"'split', 'uniform'"}},
      {{"body.0.flow.mesh=", "body.0.flow.speed=1.6", "body.0.flow.max_length="},
       {"body.flow", "`max_length`", "missing", "split", "2.1 m"}},
      {{"body.0.flow.mesh=uniform", "body.0.flow.min_length=0.06"},
       {"10 elements", "0.05 m", "min_length"}},
      {{"body.0.flow.mesh=uniform", "body.0.flow.max_length=1e-5"}, {"uniform", "100000"}},
      {uniform({"body.0.shape=q4"}), {"q4", "uniform"}},
      {uniform({"body.0.flow.speed=-0.5"}), {"hub", "0 m", "time.end"}},
      {uniform({"body.0.line=[{index=1, at=0.1}]"}), {"'plate'", "flow", "[[body.line]]"}},
      {uniform({"joint.0.edge=\"line 3\""}), {"'root', 'free_end'"}},
  };
  for (const auto& [changes, parts] : wrong) {
    const Changes all = with(kFull, changes);
    const std::string message = complaint("rotating_plate_v05", all);
    EXPECT_TRUE(testing::mentions_all(message, parts,
                                      location_in(message, shipped("rotating_plate_v05"), all)));
  }
}

}  // namespace
}  // namespace flexmorph::cases
