// Shows that loads, joints, force elements and the start of a motion work with beams: resultants of
// gravity and loads, markers on beam points, welds of curved and sheared ends with their
// derivatives, held nodes, placement.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "fem/body_joints.h"
#include "fem/dynamics/starts/start.h"
#include "fem/elements/ancf_beam.h"
#include "fem/force_element.h"
#include "fem/loads.h"
#include "fem/terms.h"
#include "tests/support/errors.h"
#include "tests/support/rigid_models.h"
#include "tests/support/sections.h"

namespace flexmorph::fem {
namespace {

constexpr double kHeightAtJoints = 0.1;

VectorXd vector(double x, double y) {
  VectorXd out(2);
  out << x, y;
  return out;
}

std::unique_ptr<AncfBeam> quarter_arc() {
  return std::make_unique<AncfBeam>(uniform_nodes(0.9, 6), kHeightAtJoints,
                                    arc_reference(0.9, std::numbers::pi / 2, 6));
}

/// Returns the resultant of one load on the reference configuration: its virtual work in a
/// translation.
Vec2 resultant(std::unique_ptr<Term> load, double* moment = nullptr) {
  std::vector<std::unique_ptr<Term>> terms;
  terms.push_back(std::move(load));
  Workspace model;
  model.add_body("beam", quarter_arc(), kBeamSection, std::move(terms));
  model.prepare(0);
  const State x = model.reference();
  VectorXd f;
  model.force(x, f);
  Vec2 sum = Vec2::Zero();
  if (moment) *moment = 0;
  for (int k = 0; k < model.n_dofs() / 2; ++k) {
    if (k % 3 == 0) sum -= f.segment<2>(2 * k);
    if (moment) *moment -= x.q[2 * k] * f[2 * k + 1] - x.q[2 * k + 1] * f[2 * k];
  }
  return sum;
}

TEST(BeamLoads, HaveTheirResultants) {
  const std::unique_ptr<AncfBeam> beam = quarter_arc();
  double area = 0;
  ShapeTable t;
  for (int e = 0; e < 6; ++e) {
    beam->tabulate(e, 8, Tabulate::position, {}, ScaleFactorKind::none, t);
    area += t.weight.sum();
  }
  EXPECT_NEAR(area, 0.09 * (1 - std::pow(std::numbers::pi / 12, 2) / 12), 1e-6);
  const Vec2 weight = resultant(make_gravity(kBeamSection, vector(1, -9.81)));
  EXPECT_NEAR(weight.x(), 7200 * 0.05 * area, 1e-11);
  EXPECT_NEAR(weight.y(), -9.81 * 7200 * 0.05 * area, 1e-11);
  const Vec2 surface = resultant(make_surface_load(vector(3, 4)));
  EXPECT_NEAR(surface.x(), 3 * area, 1e-14);
  EXPECT_NEAR(surface.y(), 4 * area, 1e-14);
  // A force off the axis at the face of the free end has a moment; the axis is rotated by 90
  // degrees to the left there.
  double moment = 0;
  const Vec2 force =
      resultant(make_point_force({0.9, kHeightAtJoints / 2}, vector(5, -7)), &moment);
  EXPECT_NEAR(force.x(), 5, 1e-13);
  EXPECT_NEAR(force.y(), -7, 1e-13);
  const double radius = 0.9 / (std::numbers::pi / 2);
  const Vec2 at(radius - kHeightAtJoints / 2, radius);
  EXPECT_NEAR(moment, at.x() * -7 - at.y() * 5, 1e-12);
  const Vec2 mass = resultant(make_point_mass(2, {0.9, kHeightAtJoints / 2}, vector(0, -9.81)));
  EXPECT_NEAR(mass.y(), -2 * 9.81, 1e-12);
}

/// A beam and a rigid body with a joint between them, in the reference configuration.
struct Pair {
  Workspace model;
  State x;

  explicit Pair(std::unique_ptr<Joint> joint, std::unique_ptr<AncfBeam> beam = quarter_arc()) {
    model.add_body("beam", std::move(beam), kBeamSection, {});
    testing::add_rigid(model, "hub", {2, {0, 0}, 0.1});
    model.add_joint(std::move(joint));
    x = model.reference();
  }
  VectorXd value(const VectorXd& q) {
    State y = x;
    y.q = q;
    Constraints c;
    model.constraints(y, c);
    return c.value;
  }
};

// The rows vanish on the undeformed bodies, where the frame is at the node with its first axis
// along r_m. The Jacobian equals differences (rows are of degree 2, so that central ones are
// exact), and the accelerations equal the second derivative along a motion.
TEST(BeamWelds, HoldCurvedEndsAndHaveExactDerivatives) {
  const double radius = 0.9 / (std::numbers::pi / 2);
  for (const WeldMode mode :
       {WeldMode::partial, WeldMode::edge, WeldMode::direction, WeldMode::full}) {
    Pair pair(make_edge_weld("weld", "beam", "free_end",
                             {"hub", {radius, radius}, std::numbers::pi / 2}, mode));
    const int rows = mode == WeldMode::partial     ? 3
                     : mode == WeldMode::edge      ? 4
                     : mode == WeldMode::direction ? 5
                                                   : 6;
    ASSERT_EQ(pair.model.joints()[1]->size(), rows);
    EXPECT_LT(pair.value(pair.x.q).norm(), 1e-14);

    std::mt19937 random(3);
    std::uniform_real_distribution<double> part(-0.3, 0.3);
    State& x = pair.x;
    for (int i = 0; i < x.q.size(); ++i) {
      x.q[i] += part(random);
      x.v[i] = part(random);
    }
    Constraints c;
    pair.model.constraints(x, c);
    MatrixXd jacobian = MatrixXd::Zero(c.value.size(), x.q.size());
    for (const auto& entry : c.jacobian) jacobian(entry.row(), entry.col()) += entry.value();
    for (int i = 0; i < x.q.size(); ++i) {
      VectorXd up = x.q, down = x.q;
      up[i] += 0.1;
      down[i] -= 0.1;
      EXPECT_LT((jacobian.col(i) - (pair.value(up) - pair.value(down)) / 0.2).norm(), 1e-14);
    }
    const VectorXd second =
        (pair.value(x.q + 0.1 * x.v) + pair.value(x.q - 0.1 * x.v) - 2 * pair.value(x.q)) / 0.01;
    EXPECT_LT((c.acceleration + second).norm(), 1e-12);
  }
}

// A sheared, tapered end keeps its reference vectors in the frame (full), or its section (edge).
TEST(BeamWelds, TakeTheReferenceVectorsOfTheEnd) {
  const std::vector<double> x = {0, 0.5};
  const std::vector<BeamNode> nodes = {{{0, 0}, {1.2, 0}, {0.2, 0.9}}, {{0.5, 0}, {1, 0}, {0, 1}}};
  for (const WeldMode mode :
       {WeldMode::partial, WeldMode::edge, WeldMode::direction, WeldMode::full}) {
    Pair pair(make_edge_weld("weld", "beam", "root", {"hub"}, mode),
              std::make_unique<AncfBeam>(x, kHeightAtJoints, nodes));
    EXPECT_LT(pair.value(pair.x.q).norm(), 1e-15);
    Pair driven(make_weld(
                    "weld", "beam", "root", [](double) { return FrameMotion{}; }, mode),
                std::make_unique<AncfBeam>(x, kHeightAtJoints, nodes));
    EXPECT_LT(driven.value(driven.x.q).norm(), 1e-15);
  }
}

// Joints and springs can be attached to points of a beam, on the axis and off it.
TEST(BeamMarkers, ArePointsOfTheBeam) {
  Pair pair(make_revolute("hinge", {"hub", {0.45, 0.03}}, {"beam", {0.45, 0.03}}),
            std::make_unique<AncfBeam>(0.9, kHeightAtJoints, 5));
  EXPECT_LT(pair.value(pair.x.q).norm(), 1e-15);
  pair.model.add_force_element(
      make_spring("spring", {}, {"beam", {0.9, -kHeightAtJoints / 2}}, {100, 0, 0}));
  pair.model.prepare(0);
  const double length2 = 0.9 * 0.9 + kHeightAtJoints * kHeightAtJoints / 4;
  EXPECT_NEAR(pair.model.energies(pair.x).strain, 50 * length2, 1e-12);
  const LocationMotion location = pair.model.location_motion({"beam", {0.3, 0.04}}, pair.x);
  EXPECT_LT((location.position - Vec2(0.3, 0.04)).norm(), 1e-15);
  const std::string text = testing::error_of(Error::Kind::input, [&] {
    pair.model.add_joint(make_revolute("off", {}, {"beam", {0.3, 0.06}}));
  });
  for (const char* part : {"outside", "0.3", "0.06"})
    EXPECT_TRUE(testing::mentions(text, part)) << text;
}

TEST(BeamHolds, FindNodesByTheirCoordinates) {
  Pair pair(make_hold("held", "beam",
                      {{HoldLocation::at({0.45, 0}), NodeVector::r, {1}, {}},
                       {{.edge = "free_end"}, NodeVector::r_n, {0, 1}, {}}}));
  ASSERT_EQ(pair.model.joints()[1]->size(), 3);
  // the node is at the reference position on the arc
  EXPECT_LT(pair.value(pair.x.q).norm(), 1e-15);
  const std::string text = testing::error_of(Error::Kind::input, [] {
    Pair(make_hold("held", "beam", {{HoldLocation::at({0.4, 0}), NodeVector::r, {1}, {}}}));
  });
  for (const char* part : {"'held'", "node", "'beam'"})
    EXPECT_TRUE(testing::mentions(text, part)) << text;
}

// A placed beam starts to move as a rigid body: every point has the position and velocity that the
// frame gives it.
TEST(BeamStart, PlacedBeamsMoveAsRigidBodies) {
  std::vector<std::unique_ptr<Term>> terms;
  terms.push_back(make_inertia(kBeamSection));
  Workspace model;
  model.add_body("beam", quarter_arc(), kBeamSection, std::move(terms));
  const FrameMotion f{{0.3, -0.2}, {1, 2}, {0, 0}, 0.8, 3, 0};
  const BodyPoses body_poses = [&](double) { return std::vector<BodyPose>{{"beam", f}}; };
  const State x = start_state(model, {}, 0, Start::rigid, body_poses);
  const Vec2 at(0.4, 0.03);
  State reference = model.reference();
  const Vec2 X = model.location_motion({"beam", at}, reference).position;
  const LocationMotion location = model.location_motion({"beam", at}, x);
  const double c = std::cos(0.8), s = std::sin(0.8);
  const Vec2 arm(c * X.x() - s * X.y(), s * X.x() + c * X.y());
  EXPECT_LT((location.position - f.origin - arm).norm(), 1e-15);
  EXPECT_LT((location.velocity - f.origin_rate - 3 * Vec2(-arm.y(), arm.x())).norm(), 1e-14);
}

}  // namespace
}  // namespace flexmorph::fem
