// Shows when meshes change and how a state changes: limits are met at the exact time; an inserted
// line of h16 nodes changes neither position, velocity nor acceleration of any material point; h12
// and removals change them by the interpolation error only; insertion and removal do not alternate.
#include "fem/dynamics/mesh_changes/moving_root.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "fem/dynamics/force_balance.h"
#include "fem/dynamics/motion.h"
#include "fem/terms.h"
#include "tests/support/models.h"

namespace flexmorph::fem {
namespace {

using testing::RotatingPlate;
using testing::ShapeSet;

constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// Returns a smooth motion of the extending plate at time t and moves its mesh there.
State some_state(testing::Scene& scene, double t, double size = 0.05) {
  Workspace& model = scene.model;
  model.prepare(t);
  const State reference = model.reference();
  State x = testing::SmoothMotion(reference.q, size * model.scales().cwiseInverse(), 5).state(t);
  x.lambda = reference.lambda;
  return x;
}

std::vector<Vec2> points_outside(const RotatingPlate& p, double root) {
  std::vector<Vec2> out;
  for (int i = 0; i <= 40; ++i)
    for (int j = 0; j <= 6; ++j)
      out.push_back({root + (p.whole() - root) * i / 40, -0.05 + 0.1 * j / 6});
  return out;
}

struct Jump {
  double position = 0, velocity = 0, acceleration = 0;
};

/// Returns the largest jumps of the fields when the mesh changes, relative to the largest values.
Jump jump_of(const RotatingPlate& p, testing::Scene& scene, State& x, MeshChange change) {
  Body& body = scene.model.bodies()[0];
  std::vector<PointMotion> before;
  const std::vector<Vec2> points = points_outside(p, grid_of(body).line_m(0).value);
  PointMotion largest{Vec2::Zero(), Vec2::Zero(), Vec2::Zero()};
  for (const Vec2& at : points) {
    before.push_back(point_motion(body, x, at));
    largest.position = largest.position.cwiseMax(before.back().position.cwiseAbs());
    largest.velocity = largest.velocity.cwiseMax(before.back().velocity.cwiseAbs());
    largest.acceleration = largest.acceleration.cwiseMax(before.back().acceleration.cwiseAbs());
  }
  change_mesh(scene.model, body, change, x);
  Jump jump;
  for (size_t i = 0; i < points.size(); ++i) {
    const PointMotion after = point_motion(body, x, points[i]);
    jump.position = std::max(jump.position, (after.position - before[i].position).norm());
    jump.velocity = std::max(jump.velocity, (after.velocity - before[i].velocity).norm());
    jump.acceleration =
        std::max(jump.acceleration, (after.acceleration - before[i].acceleration).norm());
  }
  return {jump.position / largest.position.norm(), jump.velocity / largest.velocity.norm(),
          jump.acceleration / largest.acceleration.norm()};
}

// The halves of a bicubic field are bicubic, and the halves of a bilinear field are bilinear.
class CompleteShapes : public ::testing::TestWithParam<ShapeSet> {};
INSTANTIATE_TEST_SUITE_P(Sets, CompleteShapes, ::testing::Values(ShapeSet::h16, ShapeSet::q4),
                         [](const auto& set) {
                           return std::string(set.param == ShapeSet::q4 ? "q4" : "h16");
                         });

TEST_P(CompleteShapes, HaveFieldsThatAnInsertionLeavesUnchanged) {
  RotatingPlate p;
  p.shapes = GetParam();
  p.speed = 0.5;
  p.factors = testing::chequered(p);
  testing::Scene scene = testing::make_scene(p);
  State x = some_state(scene, 0.1);
  const Energies before = scene.model.energies(x);
  const Jump jump = jump_of(p, scene, x, MeshChange::insertion);
  EXPECT_LT(jump.position, 1e-13);
  EXPECT_LT(jump.velocity, 1e-12);
  EXPECT_LT(jump.acceleration, 1e-11);
  const Energies after = scene.model.energies(x);
  EXPECT_NEAR(after.kinetic, before.kinetic, 1e-12 * before.kinetic);
  EXPECT_NEAR(after.strain, before.strain, 1e-10 * before.strain);
  EXPECT_EQ(x.q.size(), scene.model.n_dofs());
  EXPECT_EQ(x.a.size(), scene.model.n_dofs());
  EXPECT_EQ(grid_of(scene.model.bodies()[0]).n_m(), p.nx + 1);
}

// The incomplete set has no r_mn; therefore this component of the field jumps, which is small for a
// smooth field.
TEST(Insertion, OfIncompleteShapesJumpsByTheMixedDerivative) {
  RotatingPlate p;
  p.speed = 0.5;
  p.shapes = ShapeSet::h12;
  testing::Scene scene = testing::make_scene(p);
  State x = some_state(scene, 0.1);
  const Jump jump = jump_of(p, scene, x, MeshChange::insertion);
  EXPECT_GT(jump.position, 1e-6);
  EXPECT_LT(jump.position, 1e-2);
  EXPECT_LT(jump.velocity, 5e-2);
}

// A removal of the inserted line restores the fields exactly.
TEST(Removal, UndoesAnInsertion) {
  RotatingPlate p;
  p.speed = 0.5;
  for (const ShapeSet shapes : {ShapeSet::h12, ShapeSet::h16, ShapeSet::q4}) {
    p.shapes = shapes;
    testing::Scene scene = testing::make_scene(p);
    State x = some_state(scene, 0.1);
    const State before = x;
    // Any other vector of accelerations is also restored.
    const VectorXd alpha = x.a + 0.1 * x.v;
    const MeshMap in = change_mesh(scene.model, scene.model.bodies()[0], MeshChange::insertion, x);
    ASSERT_GT(x.q.size(), before.q.size());
    const VectorXd carried = in.acceleration(before.q, before.v, alpha);
    const VectorXd q = x.q, v = x.v;
    const MeshMap out = change_mesh(scene.model, scene.model.bodies()[0], MeshChange::removal, x);
    EXPECT_EQ((x.q - before.q).norm() + (x.v - before.v).norm() + (x.a - before.a).norm() +
                  (out.acceleration(q, v, carried) - alpha).norm(),
              0);
  }
}

// The values of other bodies do not change.
TEST(Insertion, DoesNotTouchOtherBodies) {
  RotatingPlate p;
  testing::Scene scene = testing::make_scene(p), other = testing::make_scene(p);
  for (const char* name : {"before", "after"}) {
    std::vector<std::unique_ptr<Term>> terms;
    terms.push_back(make_inertia(p.section));
    scene.model.add_body(name, grid_of(other.model.bodies()[0]).copy(), p.section,
                         std::move(terms));
  }
  Body& middle = scene.model.bodies()[1];
  scene.model.prepare(0.2);
  State x = scene.model.reference();
  x.q = x.v = x.a = VectorXd::Random(scene.model.n_dofs());
  const State old = x;
  const int first = middle.first_dof, size = middle.n_dofs();
  change_mesh(scene.model, middle, MeshChange::insertion, x);
  EXPECT_EQ((x.q.head(first) - old.q.head(first)).norm(), 0);
  const auto rest = old.q.size() - first - size;
  EXPECT_EQ((x.q.tail(rest) - old.q.tail(rest)).norm(), 0);
  EXPECT_EQ(x.q.size() - old.q.size(), size / (p.nx + 1));
}

// Lines of cells are inserted and removed where they are in the design. The element at the root is
// never longer than 1.3 cells nor shorter than a quarter of a cell, and every line changes once.
TEST(NextChange, OfCellsKeepsToTheirLines) {
  RotatingPlate p;
  p.shapes = ShapeSet::q4;
  p.nx = 10;
  const double cell = p.length / p.nx;
  for (const double speed : {0.5, -0.3}) {
    p.speed = speed;
    testing::Scene scene = testing::make_scene(p);
    Body& body = scene.model.bodies()[0];
    MovingRoot growth = scene.moving_roots[0];
    growth.cell = cell;
    growth.max_length = 1.3 * cell;
    growth.min_length = 0.25 * cell;
    double t = 0;
    int changes = 0;
    for (NextChange next = next_change(body, growth, t, 1, 1e-3); next.t < 1;
         next = next_change(body, growth, t, 1, 1e-3)) {
      EXPECT_GT(next.t, t);
      t = next.t;
      EXPECT_EQ(next.change, speed > 0 ? MeshChange::insertion : MeshChange::removal);
      scene.model.prepare(t);
      State x = some_state(scene, t);
      change_mesh(scene.model, body, next.change, x, growth.cell);
      ++changes;
      const LineGrid& lines = grid_of(body);
      for (int i = 1; i <= lines.n_m(); ++i) {
        const double from_end = (lines.line_m(lines.n_m()).value - lines.line_m(i).value) / cell;
        EXPECT_NEAR(from_end, lines.n_m() - i, 1e-9);
      }
    }
    // Ten cells come out at 0.5 m/s, six go in at -0.3 m/s.
    EXPECT_EQ(changes, speed > 0 ? 10 : 6);
  }
}

TEST(NextChange, MeetsTheLimitAtItsTime) {
  RotatingPlate p;
  p.speed = 0.5;
  testing::Scene scene = testing::make_scene(p);
  const Body& body = scene.model.bodies()[0];
  const NextChange change = next_change(body, scene.moving_roots[0], 0, 1, 1e-3);
  EXPECT_NEAR(change.t, 0.1, 1e-12);
  EXPECT_EQ(change.change, MeshChange::insertion);
  EXPECT_EQ(next_change(body, scene.moving_roots[0], 0, 0.0999, 1e-3).t, kInfinity);
}

TEST(NextChange, MergesShrinkingPlatesOnlyWhereTheyDoNotChatter) {
  RotatingPlate p;
  p.speed = -0.1;
  testing::Scene scene = testing::make_scene(p);
  Body& body = scene.model.bodies()[0];
  MovingRoot growth = scene.moving_roots[0];  // limits 0.1 and 0.03, elements of 0.05
  const NextChange change = next_change(body, growth, 0, 1, 1e-3);
  EXPECT_NEAR(change.t, 0.2, 1e-12);
  EXPECT_EQ(change.change, MeshChange::removal);
  // The merged element (0.08) is afterwards within both limits.
  scene.model.prepare(change.t);
  State x = some_state(scene, change.t);
  change_mesh(scene.model, body, change.change, x);
  EXPECT_NEAR(next_change(body, growth, change.t, 2, 1e-3).t, 0.7, 1e-12);
  // The limits 0.1 and 0.05 of P would merge to 0.1, which would be split again; therefore no merge
  // is made.
  testing::Scene again = testing::make_scene(p);
  growth.min_length = 0.0499;
  EXPECT_EQ(next_change(again.model.bodies()[0], growth, 0, 0.4, 1e-3).t, kInfinity);
}

/// A rotating plate with varying scale factors that slides into its hub, at the time of a removal.
struct Retracting {
  testing::Scene scene;
  State x;

  Retracting() {
    RotatingPlate p;
    p.speed = -0.5;
    p.factors = testing::chequered(p);
    scene = testing::make_scene(p);
    MotionSettings settings;
    settings.end = 0.04;
    x = integrate(scene.model, scene.moving_roots, settings, [](const MotionStep&) {}).final;
  }
  double strain() { return scene.model.energies(x).strain; }
};

// After a removal the slopes belong to a longer element, which changes the strain energy; balancing
// the forces cancels most of this change. The equations of motion and the constraints hold
// afterwards.
TEST(ForceBalance, KeepsTheStrainEnergyOfARemoval) {
  Retracting plate;
  Workspace& model = plate.scene.model;
  Body& body = model.bodies()[0];
  const double before = plate.strain();
  change_mesh(model, body, MeshChange::removal, plate.x);
  const double carried = plate.strain();
  const VectorXd change = balance_forces(model, plate.x, separating_frequency(body));
  EXPECT_GT(std::abs(carried - before), 5 * std::abs(plate.strain() - before));
  EXPECT_LT(std::abs(plate.strain() - before), 0.02 * before);
  EXPECT_EQ(change.size(), model.n_dofs());
  Constraints c;
  model.constraints(plate.x, c);
  EXPECT_LT(c.value.lpNorm<Eigen::Infinity>(), 1e-13);
  VectorXd force, inertia;
  model.force(plate.x, force);
  Workspace::add_constraint_force(c, plate.x.lambda, force);
  State still = plate.x;
  still.a.setZero();
  model.force(still, inertia);
  EXPECT_LT(force.norm(), 1e-8 * inertia.norm());
}

// Balanced forces do not change when they are balanced a second time.
TEST(ForceBalance, LeavesABalancedStateAsItIs) {
  Retracting plate;
  Workspace& model = plate.scene.model;
  Body& body = model.bodies()[0];
  change_mesh(model, body, MeshChange::removal, plate.x);
  balance_forces(model, plate.x, separating_frequency(body));
  const State once = plate.x;
  balance_forces(model, plate.x, 3 * separating_frequency(body));
  const VectorXd moved = (plate.x.q - once.q).cwiseProduct(model.scales());
  EXPECT_LT(moved.lpNorm<Eigen::Infinity>(), 1e-11);
}

}  // namespace
}  // namespace flexmorph::fem
