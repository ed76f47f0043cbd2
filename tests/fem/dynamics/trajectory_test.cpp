// Shows that a trajectory contains the requested states, and that changes of its mesh are linear
// maps: they have the closed-form values of the interpolation, the right transposed maps, and the
// effect of the changes in the motion.
#include "fem/dynamics/trajectory.h"

#include <gtest/gtest.h>

#include "fem/dynamics/force_balance.h"
#include "fem/dynamics/motion.h"
#include "fem/terms.h"
#include "tests/support/models.h"

namespace flexmorph::fem {
namespace {

using testing::RotatingPlate;
using testing::ShapeSet;

double product(const MeshMap::Vectors& a, const MeshMap::Vectors& b) {
  return a.q.dot(b.q) + a.v.dot(b.v) + a.a.dot(b.a);
}
double size(const MeshMap::Vectors& x) { return std::sqrt(product(x, x)); }

MeshMap::Vectors random(int n) {
  return {VectorXd::Random(n), VectorXd::Random(n), VectorXd::Random(n)};
}

class EveryMeshMap : public ::testing::TestWithParam<std::tuple<ShapeSet, MeshChange, int>> {};
INSTANTIATE_TEST_SUITE_P(
    Shapes, EveryMeshMap,
    ::testing::Combine(::testing::Values(ShapeSet::h12, ShapeSet::h16, ShapeSet::q4),
                       ::testing::Values(MeshChange::insertion, MeshChange::removal),
                       ::testing::Values(2, 3)));

/// Returns two plates in the plane or in space whose root lines move with rates and accelerations.
Workspace plates(ShapeSet shapes, int dim) {
  Workspace out;
  for (const char* name : {"first", "second"}) {
    std::vector<MaterialLine> m = testing::uniform_lines(0, 0.4, 4);
    m[0] = testing::swinging_line(0.02, 0.015, 3);
    std::vector<std::unique_ptr<Term>> terms;
    terms.push_back(make_inertia({0.01, 1e8, 0.3, 2700}));
    out.add_body(
        name,
        std::make_unique<AncfPlate>(dim, shapes, std::move(m), testing::uniform_lines(0, 0.1, 2)),
        {}, std::move(terms));
  }
  out.prepare(0.3);
  return out;
}

// <A x, y> = <x, Aᵀ y> for all three vectors together, because rates of positions enter
// accelerations.
TEST_P(EveryMeshMap, AndItsTransposedAreAdjoint) {
  const auto [shapes, change, dim] = GetParam();
  Workspace model = plates(shapes, dim);
  for (const Body& body : model.bodies()) {
    const MeshMap map(body, change, model.n_dofs(), shapes == ShapeSet::q4 ? 0.06 : 0);
    std::srand(1);
    for (int k = 0; k < 5; ++k) {
      const MeshMap::Vectors x = random(map.n_before()), y = random(map.n_after());
      const MeshMap::Vectors there = map.apply(x), back = map.apply_transposed(y);
      EXPECT_EQ(there.a.size(), map.n_after());
      EXPECT_EQ(back.a.size(), map.n_before());
      EXPECT_NEAR(product(there, y), product(x, back), 1e-14 * size(there) * size(y));
      EXPECT_EQ((map.acceleration(x.q, x.v, x.a) - there.a).norm(), 0);
    }
  }
}

// Rows of the new node on the lower edge are cubic Hermite functions in the middle of an element of
// length l: f = (f₁ + f₂)/2 + l (f₁' - f₂')/8, f' = 3 (f₂ - f₁)/(2 l) - (f₁' + f₂')/4.
TEST(MeshMap, HasTheValuesOfCubicsInTheMiddle) {
  Workspace model = plates(ShapeSet::h16, 2);
  const Body& body = model.bodies()[0];
  const LineGrid& plate = grid_of(body);
  const MeshMap map(body, MeshChange::insertion, model.n_dofs());
  const double l = plate.line_m(1).value - plate.line_m(0).value;
  const int column = 2 * plate.per_node() * (plate.n_n() + 1);  // unknowns of one line of nodes
  MeshMap::Vectors unit{VectorXd::Zero(map.n_before()), VectorXd::Zero(map.n_before()),
                        VectorXd::Zero(map.n_before())};
  const auto rows = [&](int at) {  // value and derivative of the new node by one unknown
    unit.q.setZero();
    unit.q[at] = 1;
    const VectorXd q = map.apply(unit).q;
    return Vec2(q[column], q[column + 2]);
  };
  EXPECT_LT((rows(0) - Vec2(0.5, -1.5 / l)).norm(), 1e-13 / l);
  EXPECT_LT((rows(2) - Vec2(l / 8, -0.25)).norm(), 1e-13);
  EXPECT_LT((rows(column) - Vec2(0.5, 1.5 / l)).norm(), 1e-13 / l);
  EXPECT_LT((rows(column + 2) - Vec2(-l / 8, -0.25)).norm(), 1e-13);
}

// Lines move through the field, so that B and C of the map are the first and second derivative of A
// by time at the fixed material point of the new node.
TEST(MeshMap, RatesAreThoseOfTheFieldAtItsMaterialPoint) {
  Workspace model = plates(ShapeSet::h16, 2);
  const State reference = model.reference();
  const testing::SmoothMotion motion(reference.q, 0.05 * model.scales().cwiseInverse(), 2);
  const double t = 0.3;
  const Body& body = model.bodies()[0];
  const LineGrid& plate = grid_of(body);
  model.prepare(t);
  const MeshMap map(body, MeshChange::insertion, model.n_dofs());
  const State x = motion.state(t);
  const MeshMap::Vectors after = map.apply({x.q, x.v, x.a});
  const int column = 2 * plate.per_node() * (plate.n_n() + 1);
  const Vec2 node(0.5 * (plate.line_m(0).value + plate.line_m(1).value), 0);
  const auto position = [&](double at) {
    model.prepare(at);
    return Vec2(point_position(body, motion.state(at), node).head<2>());
  };
  const double h = 1e-3;
  const Vec2 there = position(t), later = position(t + h), earlier = position(t - h);
  EXPECT_LT((after.q.segment<2>(column) - there).norm(), 1e-14);
  EXPECT_LT((after.v.segment<2>(column) - (later - earlier) / (2 * h)).norm(), 1e-5);
  EXPECT_LT((after.a.segment<2>(column) - (later - 2 * there + earlier) / (h * h)).norm(), 1e-3);
}

/// @param scene  receives the scene with its final mesh
MotionResult move(Keep keep, testing::Scene& scene) {
  RotatingPlate p;
  p.speed = 0.5;
  scene = testing::make_scene(p);
  MotionSettings settings;
  settings.end = 0.25;
  settings.step = 2e-3;
  settings.stops = {0.05, 0.101, 0.2};
  settings.keep = keep;
  return integrate(scene.model, scene.moving_roots, settings, [](const MotionStep&) {});
}

TEST(Trajectory, ChangesOfTheMeshAreWhatTheMotionDid) {
  testing::Scene scene;
  const MotionResult r = move(Keep::steps, scene);
  const Trajectory& motion = r.trajectory;
  ASSERT_EQ(motion.changes.size(), r.events.size());
  ASSERT_GE(motion.changes.size(), 2u);
  for (const Trajectory::Change& change : motion.changes) {
    const State& before = motion.points.at(change.after).x;
    const State& after = motion.points.at(change.after + 1).x;
    EXPECT_EQ(before.t, change.time);
    EXPECT_EQ(after.t, change.time);
    State carried = before;
    change.map.carry(carried);
    ASSERT_EQ(carried.q.size(), after.q.size());
    if (&change != &motion.changes.back()) continue;
    // After the last change, forces are balanced and velocities are projected onto the constraints
    // on the final mesh.
    scene.model.prepare(carried);
    balance_forces(scene.model, carried, separating_frequency(scene.model.bodies()[0]));
    const VectorXd sizes = scene.model.scales();
    EXPECT_LT(sizes.cwiseProduct(carried.q - after.q).norm(), 1e-12);
    EXPECT_LT((carried.a - after.a).norm(), 1e-9 * after.a.norm());
    EXPECT_LT((carried.lambda - after.lambda).norm(), 1e-9 * after.lambda.norm());
    make_integrator(scene.model, {})->project_velocity(carried);
    EXPECT_LE((carried.v - after.v).norm(), 1e-13 * after.v.norm());
  }
}

TEST(Trajectory, KeepsWhatIsAskedFor) {
  testing::Scene scene;
  const MotionResult nothing = move(Keep::nothing, scene), stops = move(Keep::stops, scene),
                     steps = move(Keep::steps, scene);
  EXPECT_TRUE(nothing.trajectory.points.empty());
  EXPECT_TRUE(nothing.trajectory.changes.empty());
  ASSERT_EQ(stops.trajectory.points.size(), 5u);
  const double times[] = {0, 0.05, 0.101, 0.2, 0.25};
  for (size_t i = 0; i < 5; ++i) {
    EXPECT_EQ(stops.trajectory.points[i].x.t, times[i]);
    EXPECT_EQ(stops.trajectory.points[i].stop, i > 0);
  }
  const size_t n = steps.trajectory.points.size();
  EXPECT_EQ(n, static_cast<size_t>(steps.counts.steps) + 1 + steps.events.size());
  size_t seen = 0;
  for (const Trajectory::Point& point : steps.trajectory.points) seen += point.stop;
  EXPECT_EQ(seen, 4u);
  for (const MotionResult* r : {&stops, &steps}) {
    const State& last = r->trajectory.points.back().x;
    EXPECT_EQ((last.q - nothing.final.q).norm() + (last.lambda - nothing.final.lambda).norm(), 0);
  }
}

}  // namespace
}  // namespace flexmorph::fem
