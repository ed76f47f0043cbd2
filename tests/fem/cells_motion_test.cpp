// Shows that the motions of plates of cells equal those of the general solver with less than half
// of its factorizations; their matrix factor is kept, rotated with the plate and renewed at its
// border only. Shows also that the renewed part of a matrix equals the whole new matrix there, and
// that the measured rotations of bodies are right.
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

/// Adds an unconstrained plate far away. Material flows through its whole mesh, by 5 to 8 % of a
/// cell per step, so that the model needs the general solver: renewing the border of the factor is
/// not sufficient, and the matrix is not symmetric.
void add_flowing_plate(Workspace& model) {
  std::vector<MaterialLine> lines;
  for (int k = 0; k <= 30; ++k)
    lines.push_back(testing::swinging_line(0.01 * k, 1e-3, 480 + 12 * k));
  const PlaneSection section{0.01, 1e8, 0.3, 2700};
  std::vector<std::unique_ptr<Term>> terms;
  terms.push_back(make_inertia(section));
  terms.push_back(make_membrane(section));
  model.add_body(
      "other",
      std::make_unique<AncfPlate>(2, ShapeSet::q4, lines, testing::uniform_lines(0, 0.1, 10)),
      section, std::move(terms));
}

MotionResult move(bool beside_another) {
  testing::Scene scene = testing::make_scene(on_cells(60, 12));
  if (beside_another) add_flowing_plate(scene.model);
  MotionSettings settings;
  settings.end = 0.04;
  settings.start = Start::rigid;
  settings.keep = Keep::steps;
  settings.body_poses = [&](double) {
    FrameMotion frame;
    frame.origin = {3, 0};
    return beside_another ? std::vector<BodyPose>{{"other", frame, 0}} : std::vector<BodyPose>{};
  };
  return integrate(scene.model, scene.moving_roots, settings, [](const MotionStep&) {});
}

// The plate rotates by 14 degrees in 40 steps, and at least three lines are inserted. Newton's
// method stops at corrections of 1e-11 of the plate's length; the tolerances of velocities and
// multipliers are larger by powers of 1/h.
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

/// An extending plate with varying scale factors, of any shape set; a rigid arm is hinged to its
/// tip, with a spring to the ground.
testing::Scene plate_and_arm(ShapeSet shapes) {
  RotatingPlate p = on_cells(12, 4);
  p.shapes = shapes;
  p.factors = testing::chequered(p);
  testing::Scene out = testing::make_scene(p);
  testing::add_rigid(out.model, "arm", {0.3, {0, -0.1}, 1e-3}, Vec2(0, -9.81));
  out.model.add_joint(make_revolute("hinge", {.body = "plate", .point = p.tip()}, {.body = "arm"}));
  out.model.add_force_element(make_spring("spring", {.body = "arm", .point = {0, -0.2}},
                                          {.point = {1, -0.5}}, {20, 0.1, 0.3}));
  return out;
}

/// A plate of which one line is free.
testing::Scene free_line() {
  std::vector<MaterialLine> lines = testing::uniform_lines(0, 0.3, 3);
  lines[1].free = true;
  const PlaneSection section{0.01, 1e8, 0.3, 2700};
  std::vector<std::unique_ptr<Term>> terms;
  terms.push_back(make_inertia(section));
  terms.push_back(make_membrane(section));
  testing::Scene out;
  out.model.add_body(
      "plate",
      std::make_unique<AncfPlate>(2, ShapeSet::h16, lines, testing::uniform_lines(0, 0.1, 2)),
      section, std::move(terms));
  return out;
}

// The chosen rows and columns equal the matrix of the new state to round-off (sums in another
// order); all other entries keep their bits.
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

// The measured rotation of a rigidly moved and rotated body equals the prescribed angle. A rotation
// of 5e-5 rad is below the limit of detection.
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
