// Shows that motions on cells, whose factor is kept, turns with the plate and is renewed at its
// border only, are those of the general solver, in less than half of its factorizations; that the
// part of a matrix that is renewed is that of the whole one; and by how much bodies have turned.
#include <gtest/gtest.h>

#include <cmath>

#include "fem/body_joints.h"
#include "fem/dynamics/motion.h"
#include "fem/dynamics/starts/body_turns.h"
#include "fem/terms.h"
#include "tests/support/models.h"
#include "tests/support/rigid_models.h"

namespace flexmorph::fem {
namespace {

using testing::RotatingPlate;
using testing::ShapeSet;

RotatingPlate on_cells(int nx, int ny) {
  RotatingPlate p;
  p.speed = 0.5;
  p.nx = nx;
  p.ny = ny;
  p.shapes = ShapeSet::q4;
  return p;
}

/// Adds a plate far away that nothing holds. Material flows through its whole mesh, by 5 to 8 % of
/// a cell per step, so that neither a border nor the symmetric part of the matrix will do.
void add_flowing_plate(Workspace& model) {
  std::vector<MaterialLine> lines;
  for (int k = 0; k <= 30; ++k) lines.push_back(testing::swinging_line(0.01 * k, 1e-3, 480 + 12 * k));
  const PlaneSection section{0.01, 1e8, 0.3, 2700};
  std::vector<std::unique_ptr<Term>> terms;
  terms.push_back(make_inertia(section));
  terms.push_back(make_membrane(section));
  model.add_body(
      "other", std::make_unique<AncfPlate>(2, ShapeSet::q4, lines, testing::even_lines(0, 0.1, 10)),
      section, std::move(terms));
}

MotionResult move(bool beside_another) {
  testing::Scene scene = testing::make_scene(on_cells(60, 12));
  if (beside_another) add_flowing_plate(scene.model);
  MotionSettings settings;
  settings.end = 0.04;
  settings.start = Start::rigid;
  settings.keep = Keep::steps;
  settings.placement = [&](double) {
    FrameMotion frame;
    frame.origin = {3, 0};
    return beside_another ? std::vector<Placed>{{"other", frame, 0}} : std::vector<Placed>{};
  };
  return integrate(scene.model, scene.growths, settings, [](const MotionStep&) {});
}

// It turns by 14 degrees in 40 steps, three lines come. Newton's method stops at corrections of
// 1e-11 of the plate's length; forces and velocities are h and h² away from that.
TEST(CellsMotion, IsThatOfTheGeneralSolver) {
  const MotionResult alone = move(false), beside = move(true);
  EXPECT_LT(2 * alone.counts.factorizations, beside.counts.factorizations);
  const auto &one = alone.trajectory.points, &other = beside.trajectory.points;
  ASSERT_EQ(one.size(), other.size());
  ASSERT_GE(alone.events.size(), 3u);
  for (size_t k = 0; k < one.size(); ++k) {
    const State &x = one[k].x, &y = other[k].x;
    const Eigen::Index n = x.q.size(), m = x.lambda.size();
    EXPECT_LT((x.q - y.q.head(n)).lpNorm<Eigen::Infinity>(), 1e-10);
    EXPECT_LT((x.v - y.v.head(n)).lpNorm<Eigen::Infinity>(), 1e-7);
    EXPECT_LT((x.lambda - y.lambda.head(m)).norm(), 1e-6 * (1 + y.lambda.norm())) << k;
  }
}

/// A growing plate of designed material, of any shapes; a rigid arm hangs at its tip by a hinge,
/// with a spring to the ground.
testing::Scene plate_and_arm(ShapeSet shapes) {
  RotatingPlate p = on_cells(12, 4);
  p.shapes = shapes;
  p.factors = testing::chequered(p);
  testing::Scene out = testing::make_scene(p);
  testing::add_rigid(out.model, "arm", {0.3, {0, -0.1}, 1e-3}, Vec2(0, -9.81));
  out.model.add_joint(make_revolute("hinge", {.body = "plate", .point = p.tip()}, {.body = "arm"}));
  out.model.add_link(make_spring("spring", {.body = "arm", .point = {0, -0.2}},
                                 {.point = {1, -0.5}}, {20, 0.1, 0.3}));
  return out;
}

/// A plate of which one line is free.
testing::Scene free_line() {
  std::vector<MaterialLine> lines = testing::even_lines(0, 0.3, 3);
  lines[1].free = true;
  const PlaneSection section{0.01, 1e8, 0.3, 2700};
  std::vector<std::unique_ptr<Term>> terms;
  terms.push_back(make_inertia(section));
  terms.push_back(make_membrane(section));
  testing::Scene out;
  out.model.add_body(
      "plate", std::make_unique<AncfPlate>(2, ShapeSet::h16, lines, testing::even_lines(0, 0.1, 2)),
      section, std::move(terms));
  return out;
}

// What is chosen is that of the new state to round-off (other orders of the same sums), all else
// keeps its bits.
TEST(Workspaces, RenewThePartOfTheMatrixThatIsChosen) {
  const std::function<testing::Scene()> scenes[] = {[] { return plate_and_arm(ShapeSet::q4); },
                                                    [] { return plate_and_arm(ShapeSet::h16); },
                                                    free_line};
  for (const auto& make : scenes) {
    testing::Scene scene = make();
    Workspace& model = scene.model;
    const Weights w{1, 200, 3e4};
    const auto matrix = [&](double t, State& x, Constraints& c) {
      model.prepare(t);
      const State reference = model.reference();
      x = testing::SmoothMotion(reference.q, 0.02 * model.scales().cwiseInverse(), 3).state(t);
      x.lambda = VectorXd::LinSpaced(model.n_constraints(), -1, 1);
      SparseMatrix out;
      model.constraints(x, c);
      model.kkt(x, c, w, 2, out);
      return out;
    };
    State x;
    Constraints c;
    const SparseMatrix before = matrix(0.001, x, c), after = matrix(0.003, x, c);
    std::vector<char> chosen(static_cast<size_t>(before.rows()), 0);
    for (size_t k = 0; k < chosen.size(); ++k) chosen[k] = k < 20 || k % 7 == 3;
    SparseMatrix mixed = before;
    model.renew_kkt(x, c, w, 2, chosen, mixed);
    const double largest = MatrixXd(after).cwiseAbs().maxCoeff();
    int changed = 0;
    for (int column = 0; column < mixed.cols(); ++column)
      for (SparseMatrix::InnerIterator entry(mixed, column); entry; ++entry) {
        const auto row = static_cast<int>(entry.row());
        if (chosen[static_cast<size_t>(row)] && chosen[static_cast<size_t>(column)]) {
          EXPECT_NEAR(entry.value(), after.coeff(row, column), 1e-14 * largest);
          changed += entry.value() != before.coeff(row, column);
        } else {
          EXPECT_EQ(entry.value(), before.coeff(row, column));
        }
      }
    EXPECT_GT(changed, 50);
  }
}

// A body moved and turned by any angle has turned by that; what its points do besides counts by its
// second order; small turns are not noticed.
TEST(BodyTurns, AreThoseOfTheBestRotation) {
  testing::Scene scene = plate_and_arm(ShapeSet::h16);
  const Workspace& model = scene.model;
  const VectorXd reference = model.reference().q;
  const auto turned = [&](double plate, double arm) {
    VectorXd q = reference;
    for (const Body& b : model.bodies()) {
      const double angle = b.name == "arm" ? arm : plate;
      for (int k = 0; k < b.element->n_vectors(); ++k) {
        const Eigen::Rotation2Dd r(angle);
        auto x = q.segment<2>(b.first_dof + 2 * k);
        x = r * Vec2(x) + (b.element->is_position(k) ? Vec2(0.3, -2) : Vec2(0, 0));
      }
    }
    return q;
  };
  BodyTurns turns;
  turns.begin(model, turned(0.4, -3));
  EXPECT_FALSE(turns.follow(model, turned(0.4 + 5e-5, -3)));
  ASSERT_TRUE(turns.follow(model, turned(2.1, 3)));
  const std::vector<TurnedVectors> found = turns.turns(model);
  ASSERT_EQ(found.size(), 2u);
  for (const TurnedVectors& t : found) {
    const double angle = t.first == model.body("arm").first_dof ? 6 : 1.7;
    EXPECT_NEAR(t.cosine, std::cos(angle), 1e-13);
    EXPECT_NEAR(t.sine, std::sin(angle), 1e-13);
  }
  EXPECT_EQ(found[0].last, found[1].first);
  EXPECT_EQ(found[1].last, model.n_dofs());
}

}  // namespace
}  // namespace flexmorph::fem
