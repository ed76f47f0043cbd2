// Shows that held nodes constrain the right unknowns: their rows are the named entries without
// repetition at corners; clamps, supports and symmetry planes at the edges of a plate in space
// admit the right fields; pins in space and of single components agree with differences.
#include <gtest/gtest.h>

#include <Eigen/QR>
#include <cmath>

#include "tests/support/differences.h"
#include "tests/support/errors.h"
#include "tests/support/space_plates.h"

namespace flexmorph::fem {
namespace {

using testing::ShapeSet;
using testing::SpacePlate;

/// Returns all rows of a joint at q.
ConstraintRows rows(const Joint& joint, const VectorXd& q, double t = 0) {
  ConstraintRows out;
  joint.evaluate(t, q, VectorXd::Zero(q.size()), out);
  return out;
}

MatrixXd dense(const ConstraintRows& r, Eigen::Index n) {
  MatrixXd out = MatrixXd::Zero(r.value.size(), n);
  for (const auto& entry : r.jacobian) out(entry.row(), entry.col()) += entry.value();
  return out;
}

struct Bound {
  Bound(ShapeSet shapes, std::unique_ptr<Joint> made, int dim = 3)
      : plate(dim, shapes, testing::uniform_lines(0, 1, 2), testing::uniform_lines(0, 1, 2)),
        joint(std::move(made)) {
    const BodyView view{&name, &plate, 0};
    joint->bind({&view, 1});
    const Eigen::Matrix<double, -1, -1, Eigen::RowMajor> reference = plate.reference();
    q = Eigen::Map<const VectorXd>(reference.data(), reference.size());
  }
  /// Returns the unknowns that interpolate a field and its derivatives.
  VectorXd field(const std::function<Vec3(double, double)>& f) const {
    VectorXd out(q.size());
    const double h = 0.01;
    for (const NodeVectors& node : plate.nodes()) {
      const double m = node.material.x(), n = node.material.y();
      const auto by_n = [&](double at) {
        return Vec3(testing::first_difference([&](double d) { return f(at, n + d); }, h));
      };
      out.segment<3>(3 * node.r) = f(m, n);
      out.segment<3>(3 * node.r_m) =
          testing::first_difference([&](double d) { return f(m + d, n); }, h);
      out.segment<3>(3 * node.r_n) = by_n(m);
      if (node.r_mn >= 0)
        out.segment<3>(3 * node.r_mn) =
            testing::first_difference([&](double d) { return by_n(m + d); }, h);
    }
    return out;
  }
  double violation(const std::function<Vec3(double, double)>& displacement) const {
    return rows(*joint, q + field(displacement)).value.cwiseAbs().maxCoeff();
  }

  std::string name = "plate";
  AncfPlate plate;
  std::unique_ptr<Joint> joint;
  VectorXd q;
};

// For every edge and both shape sets the rows vanish on the undeformed plate and are independent.
TEST(Holds, EdgesFitTheUndeformedPlateAndAreIndependent) {
  for (const ShapeSet shapes : {ShapeSet::h12, ShapeSet::h16}) {
    std::vector<Held> all;
    for (const char* edge : {"root", "free_end", "side_low", "side_high"})
      for (const auto& list : {clamped_edge(edge, WeldMode::edge), supported_edge(edge),
                               clamped_edge(edge, WeldMode::full), symmetry_edge(edge)})
        all.insert(all.end(), list.begin(), list.end());
    const Bound b(shapes, make_hold("h", "plate", all));
    const ConstraintRows r = rows(*b.joint, b.q);
    EXPECT_EQ(r.value.cwiseAbs().maxCoeff(), 0);
    EXPECT_EQ(dense(r, b.q.size()).colPivHouseholderQr().rank(), r.value.size());
  }
}

// Each field must be admitted or excluded as the boundary condition of the continuum requires.
// Differences are exact for these polynomials except for round-off of 1e-16 / 1e-4.
TEST(Holds, EdgesAdmitWhatTheirConditionAdmits) {
  struct Field {
    std::string what;
    std::function<Vec3(double, double)> u;
    bool clamped, direction, full, supported, symmetry;  // admitted at m = 0
  };
  const Field fields[] = {{"bends", [](double m, double n) { return Vec3(0, 0, m * m * (1 + n)); },
                           true, true, true, true, true},
                          {"stretches", [](double m, double n) { return Vec3(m * (1 + n), 0, 0); },
                           true, true, false, true, true},
                          {"shears", [](double m, double n) { return Vec3(0, m * (1 + n), 0); },
                           true, false, false, true, false},
                          {"turns", [](double m, double n) { return Vec3(0, 0, m * (1 + n)); },
                           false, false, false, true, false},
                          {"slides", [](double, double n) { return Vec3(0, 1 + n, 0); }, false,
                           false, false, true, true},
                          {"lifts", [](double, double n) { return Vec3(0, 0, 1 + n); }, false,
                           false, false, false, true},
                          {"leaves", [](double, double n) { return Vec3(1 + n, 0, 0); }, false,
                           false, false, true, false}};
  for (const bool side : {false, true}) {
    const std::string edge = side ? "side_low" : "root";
    const auto check = [&](const std::vector<Held>& held, const Field& f, bool admitted) {
      const Bound b(ShapeSet::h16, make_hold("h", "plate", held));
      const auto turned = [&](double m, double n) -> Vec3 {  // exchanges m with n and x with y
        const Vec3 u = f.u(n, m);
        return {u.y(), u.x(), u.z()};
      };
      const double v = side ? b.violation(turned) : b.violation(f.u);
      EXPECT_EQ(v < 1e-10, admitted) << f.what << " " << edge << " " << v;
    };
    for (const Field& f : fields) {
      check(clamped_edge(edge, WeldMode::edge), f, f.clamped);
      check(clamped_edge(edge, WeldMode::direction), f, f.direction);
      check(clamped_edge(edge, WeldMode::full), f, f.full);
      check(supported_edge(edge), f, f.supported);
      check(symmetry_edge(edge), f, f.symmetry);
    }
  }
}

TEST(Holds, TakePointsBoxesAndValues) {
  const Bound point(
      ShapeSet::h16,
      make_hold("h", "plate",
                {{HoldLocation::at({0.5, 1}), NodeVector::r, {2}, testing::vector(0, 0, 0.25)}}));
  const ConstraintRows r = rows(*point.joint, point.q);
  ASSERT_EQ(r.value.size(), 1);
  EXPECT_EQ(r.value[0], -0.25);
  ASSERT_EQ(r.jacobian.size(), 1u);
  // This is node (1, 2) of 3 x 3; each node has four vectors of three entries.
  EXPECT_EQ(r.jacobian[0].col(), 3 * 4 * 5 + 2);
  const Bound box(
      ShapeSet::h16,
      make_hold("h", "plate", {{{.low = {0, 0}, .high = {0.5, 1}}, NodeVector::r_m, {0, 1}, {}}}));
  EXPECT_EQ(box.joint->size(), 6 * 2);
  const Bound plane(ShapeSet::h12,
                    make_hold("h", "plate", {{{.edge = "root"}, NodeVector::r, {0, 1}, {}}}), 2);
  EXPECT_EQ(plane.joint->size(), 6);
}

TEST(Holds, SayWhatIsWrong) {
  const auto refused = [](std::vector<Held> held, const std::vector<std::string>& parts) {
    const std::string text = testing::error_of(Error::Kind::input, [&] {
      Bound(ShapeSet::h16, make_hold("h", "plate", std::move(held)));
    });
    for (const std::string& part : parts) EXPECT_TRUE(testing::mentions(text, part)) << text;
  };
  const auto corner = HoldLocation::at({0, 0});
  refused({{HoldLocation::at({0.4, 1}), NodeVector::r, {2}, {}}}, {"'h'", "node", "'plate'"});
  refused({{corner, NodeVector::r, {3}, {}}}, {"'h'", "component 3", "3 dimensions"});
  refused({{corner, NodeVector::r, {}, {}}}, {"'h'", "no component"});
  refused({{{.edge = "top"}, NodeVector::r, {2}, {}}}, {"'top'", "'side_high'"});
  refused(
      {{corner, NodeVector::r, {2}, {}}, {corner, NodeVector::r, {2}, testing::vector(0, 0, 1)}},
      {"'h'", "values", "0.000000", "1.000000"});
  const std::string name = "plate";
  const AncfPlate moving = testing::swinging_plate(ShapeSet::h16);
  const BodyView view{&name, &moving, 0};
  EXPECT_THROW(
      make_hold("h", "plate", {{{.edge = "root"}, NodeVector::r, {0}, {}}})->bind({&view, 1}),
      Error);
}

// Rates and accelerations of the rows of a pin in space along a path must equal differences of its
// values.
TEST(Pins, FollowTheirPathInSpace) {
  const auto path = [](double t) {
    return std::vector<Motion>{{std::sin(t), std::cos(t), -std::sin(t)}, {t * t, 2 * t, 2}};
  };
  for (const bool all : {false, true}) {
    const PointDrive drive = [=](double t) {
      std::vector<Motion> out = path(t);
      if (all) out.push_back({t, 1, 0});
      return out;
    };
    const Bound b(ShapeSet::h16, make_pin("p", "plate", {0.3, 0.7}, drive,
                                          all ? std::vector<int>{} : std::vector<int>{2, 0}));
    ASSERT_EQ(b.joint->size(), all ? 3 : 2);
    const auto value = [&](double d) { return VectorXd(rows(*b.joint, b.q, 0.4 + d).value); };
    const ConstraintRows r = rows(*b.joint, b.q, 0.4);
    EXPECT_LT((r.rate - testing::first_difference(value, 1e-2)).norm(), 1e-9);
    EXPECT_LT((-r.acceleration - testing::second_difference(value, 1e-2)).norm(), 1e-8);
    const Vec3 at(0.3, 0.7, 0);  // position on the undeformed plate
    const std::vector<Motion> target = drive(0.4);
    for (int i = 0; i < b.joint->size(); ++i)
      EXPECT_NEAR(r.value[i], at[all ? i : 2 - 2 * i] - target[static_cast<size_t>(i)].value,
                  1e-15);
  }
}

}  // namespace
}  // namespace flexmorph::fem
