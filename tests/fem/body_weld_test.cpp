// Shows that the weld of plates and beams to each other is correct: its rows vanish wherever two
// welded bodies move as one rigid body and constrain each degree of freedom once, its derivatives
// equal differences, and the forces on the two bodies are opposite.
#include "fem/body_weld.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "fem/elements/ancf_beam.h"
#include "fem/model/workspace.h"
#include "fem/rigid.h"
#include "tests/support/dense.h"
#include "tests/support/differences.h"
#include "tests/support/errors.h"
#include "tests/support/models.h"
#include "tests/support/rigid_models.h"

namespace flexmorph::fem {
namespace {

using testing::ShapeSet;

constexpr double kHeight = 0.1, kLength = 0.9;

std::unique_ptr<Element> plate(ShapeSet shapes, int across = 2, double half_width = 0.05) {
  return std::make_unique<AncfPlate>(2, shapes, testing::uniform_lines(0, kLength, 2),
                                     testing::uniform_lines(-half_width, half_width, across));
}

/// Returns a beam along a quarter of a circle that bends to the left.
std::unique_ptr<Element> arc() {
  return std::make_unique<AncfBeam>(uniform_nodes(kLength, 3), kHeight,
                                    arc_reference(kLength, std::numbers::pi / 2, 3));
}

/// Returns a straight beam whose root is tapered and sheared.
std::unique_ptr<Element> sheared() {
  const std::vector<BeamNode> nodes = {{{0, 0}, {1.2, 0}, {0.2, 0.9}}, {{kLength, 0}}};
  return std::make_unique<AncfBeam>(std::vector{0.0, kLength}, kHeight, nodes);
}

/// Location of the middle of an edge in the undeformed body, and the angle of the axis there.
struct End {
  std::string edge;
  Vec2 middle;
  double angle = 0;
};
const End kRoot{"root", {0, 0}}, kFreeEnd{"free_end", {kLength, 0}};
const End kArcEnd{"free_end", kLength / (std::numbers::pi / 2) * Vec2(1, 1), std::numbers::pi / 2};

struct Joined {
  std::string name;
  std::function<std::unique_ptr<Element>()> a, b;
  End at_a, at_b;
  double angle;
  WeldMode mode;
  int rows;
};
void PrintTo(const Joined& j, std::ostream* out) { *out << j.name; }

std::function<std::unique_ptr<Element>()> plates(ShapeSet shapes) {
  return [shapes] { return plate(shapes); };
}

std::vector<Joined> all_kinds() {
  using enum WeldMode;
  const auto h16 = plates(ShapeSet::h16), h12 = plates(ShapeSet::h12), q4 = plates(ShapeSet::q4);
  return {
      {"arc_on_arc_partially", arc, arc, kArcEnd, kRoot, 0.7, partial, 3},
      {"arc_on_arc", arc, arc, kRoot, kArcEnd, -2.1, edge, 4},
      {"arc_on_arc_fully", arc, arc, kArcEnd, kArcEnd, std::numbers::pi, full, 6},
      {"sheared_partially", sheared, arc, kRoot, kArcEnd, 0.7, partial, 3},
      {"sheared_fully", arc, sheared, kArcEnd, kRoot, 0.7, full, 6},
      {"plates_h16", h16, h16, kFreeEnd, kRoot, 0, edge, 3 * 4},
      {"plates_h16_fully", h16, h16, kFreeEnd, kRoot, 0, full, 3 * 8},
      {"plates_h16_end_to_end", h16, h16, kFreeEnd, kFreeEnd, std::numbers::pi, full, 3 * 8},
      {"plates_h12_root_to_root", h12, h12, kRoot, kRoot, -std::numbers::pi, full, 3 * 6},
      {"plates_q4", q4, q4, kFreeEnd, kRoot, 0, full, 3 * 2},
      {"plate_on_beam", arc, h16, kArcEnd, kRoot, 1.3, edge, 3 * 4},
      {"cells_on_beam", arc, q4, kArcEnd, kFreeEnd, 1.3, edge, 3 * 2},
      {"beam_on_plate", h12, sheared, kFreeEnd, kRoot, -0.4, edge, 3 * 4},
  };
}

/// Body a with its root moved and rotated by an angle, and body b in the pose that the weld
/// requires.
struct Pair {
  Workspace model;
  State x;

  explicit Pair(const Joined& j, double angle = 0.3, const Vec2& at = {0.4, -0.7}) {
    model.add_body("a", j.a(), {}, {});
    model.add_body("b", j.b(), {}, {});
    model.add_joint(
        make_body_weld("weld", {"a", j.at_a.edge}, {"b", j.at_b.edge}, j.angle, j.mode));
    model.prepare(0);
    x = model.reference();
    const double angle_b = angle + j.at_a.angle + j.angle - j.at_b.angle;
    put("a", at, angle);
    put("b", at + rotation(angle) * j.at_a.middle - rotation(angle_b) * j.at_b.middle, angle_b);
  }

  void put(const std::string& name, const Vec2& at, double angle) {
    const Body& body = model.body(name);
    for (int k = 0; k < body.element->n_vectors(); ++k) {
      auto vector = x.q.segment<2>(body.first_dof + 2 * k);
      vector = (rotation(angle) * Vec2(vector)).eval();
      if (body.element->is_position(k)) vector += at;
    }
  }

  ConstraintRows rows(const VectorXd& q, const VectorXd& v) const {
    ConstraintRows out;
    model.joints()[0]->evaluate(0, q, v, out);
    return out;
  }
  MatrixXd jacobian(const VectorXd& q) const {
    const ConstraintRows r = rows(q, x.v);
    MatrixXd out = MatrixXd::Zero(r.value.size(), q.size());
    for (const auto& entry : r.jacobian) out(entry.row(), entry.col()) += entry.value();
    return out;
  }
};

class BodyWelds : public ::testing::TestWithParam<Joined> {};

// The rows vanish to round-off in any pose of both bodies; the rank is measured by singular values
// of rows of size one.
TEST_P(BodyWelds, HoldAWeldedBodyAndEveryFreedomOnce) {
  for (const double angle : {0.0, 0.3, 2.5}) {
    const Pair pair(GetParam(), angle);
    const ConstraintRows rows = pair.rows(pair.x.q, pair.x.v);
    ASSERT_EQ(rows.value.size(), GetParam().rows);
    EXPECT_EQ(pair.model.joints()[0]->size(), GetParam().rows);
    EXPECT_LT(rows.value.norm(), 1e-14);
    EXPECT_EQ(rows.rate.norm(), 0);
    EXPECT_GT(testing::singular_values(pair.jacobian(pair.x.q)).minCoeff(), 0.1);
  }
}

// The rows are of degree two at most; therefore differences are exact.
TEST_P(BodyWelds, HaveTheirDerivatives) {
  const Pair pair(GetParam());
  const auto n = pair.x.q.size();
  std::srand(11);
  const VectorXd q = pair.x.q + 0.3 * VectorXd::Random(n), v = VectorXd::Random(n),
                 w = VectorXd::Random(n);
  const auto along = [&](double t) { return pair.rows(q + t * v, v).value; };
  EXPECT_LT((pair.jacobian(q) * v - testing::first_difference(along, 0.1)).norm(), 1e-13);
  const VectorXd second = testing::second_difference(along, 0.1);
  EXPECT_LT((pair.rows(q, v).acceleration + second).norm(), 1e-11);
  const VectorXd lambda = VectorXd::Random(GetParam().rows);
  std::vector<Eigen::Triplet<double>> entries;
  pair.model.joints()[0]->add_stiffness(0, q, lambda, entries);
  VectorXd product = VectorXd::Zero(n);
  for (const auto& entry : entries) product[entry.row()] += entry.value() * w[entry.col()];
  const auto force = [&](double t) {
    return VectorXd(pair.jacobian(q + t * w).transpose() * lambda);
  };
  EXPECT_LT((product - testing::first_difference(force, 0.1)).norm(), 1e-12);
}

// Forces and moments between welded bodies add up to zero about any point.
TEST_P(BodyWelds, ActAndReact) {
  Pair pair(GetParam());
  std::srand(5);
  pair.x.lambda = VectorXd::Random(GetParam().rows);
  const Vec3 about(0.3, -0.7, 0);
  const Wrench a = pair.model.joint_wrench(0, "a", about, pair.x),
               b = pair.model.joint_wrench(0, "b", about, pair.x);
  EXPECT_GT(b.force.norm(), 0.1);
  EXPECT_GT(std::abs(b.moment.z()), 1e-3);
  EXPECT_LT((a.force + b.force).norm(), 1e-13);
  EXPECT_LT((a.moment + b.moment).norm(), 1e-13);
}

INSTANTIATE_TEST_SUITE_P(Kinds, BodyWelds, ::testing::ValuesIn(all_kinds()),
                         [](const auto& each) { return each.param.name; });

std::string refusal(const Joined& j) {
  return testing::error_of(Error::Kind::input, [&] { const Pair pair(j); });
}

TEST(BodyWeld, RefusesWhatDoesNotMeet) {
  using enum WeldMode;
  const auto h16 = plates(ShapeSet::h16), q4 = plates(ShapeSet::q4);
  const auto three = [] { return plate(ShapeSet::h16, 3); };
  const auto wide = [] { return plate(ShapeSet::h16, 2, 0.06); };
  const auto mentions = [](const Joined& j, const std::vector<std::string>& parts) {
    const std::string text = refusal(j);
    for (const std::string& part : parts) EXPECT_TRUE(testing::mentions(text, part)) << text;
    EXPECT_TRUE(testing::mentions(text, "'weld'")) << text;
  };
  mentions({"", h16, three, kFreeEnd, kRoot, 0, edge, 0}, {"2", "3", "elements"});
  mentions({"", h16, wide, kFreeEnd, kRoot, 0, edge, 0}, {"nodes", "coincide"});
  mentions({"", h16, q4, kFreeEnd, kRoot, 0, edge, 0}, {"elements", "types"});
  mentions({"", h16, h16, kFreeEnd, kRoot, 0.1, edge, 0}, {"angle", "0", "180"});
  mentions({"", h16, h16, kFreeEnd, kRoot, 0, partial, 0}, {"plates", "\"edge\"", "\"full\""});
  mentions({"", h16, arc, kFreeEnd, kRoot, 0, full, 0}, {"plate", "beam", "\"edge\""});
  mentions({"", arc, arc, kArcEnd, kRoot, 0, direction, 0},
           {"beams", "\"partial\"", "\"edge\"", "\"full\""});
  mentions({"", h16, h16, {"side_low", {}}, kRoot, 0, edge, 0}, {"'side_low'", "along", "'a'"});
  const std::string unknown = refusal({"", arc, arc, {"end", {}}, kRoot, 0, edge, 0});
  for (const char* part : {"'end'", "'root'", "'free_end'"})
    EXPECT_TRUE(testing::mentions(unknown, part)) << unknown;
}

TEST(BodyWeld, RefusesBodiesWithoutSuchEdges) {
  const auto bind = [](EdgeLocation a, EdgeLocation b) {
    return testing::error_of(Error::Kind::input, [&] {
      Workspace model;
      model.add_body("arc", arc(), {}, {});
      model.add_body("moving", std::make_unique<AncfPlate>(testing::swinging_plate(ShapeSet::h16)),
                     {}, {});
      testing::add_rigid(model, "rigid", {2, {0, 0}, 0.1});
      model.add_joint(make_body_weld("weld", std::move(a), std::move(b), 0, WeldMode::edge));
      model.prepare(0);
    });
  };
  const auto mentions = [](const std::string& text, const std::vector<std::string>& parts) {
    for (const std::string& part : parts) EXPECT_TRUE(testing::mentions(text, part)) << text;
  };
  mentions(bind({"arc", "root"}, {"none", "root"}), {"'weld'", "'none'"});
  mentions(bind({"arc", "root"}, {"arc", "free_end"}), {"'weld'", "different bodies"});
  mentions(bind({"arc", "root"}, {"rigid", "root"}), {"'weld'", "'rigid'", "edges"});
  mentions(bind({"arc", "root"}, {"moving", "root"}), {"'weld'", "'root'", "'moving'", "material"});
}

}  // namespace
}  // namespace flexmorph::fem
