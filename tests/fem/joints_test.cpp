// Shows that the rows of every joint are right: value, rate and right side of the acceleration
// agree with differences in time along a random motion while the hub accelerates, and the
// undeformed plate in its hub satisfies the weld.
#include <gtest/gtest.h>

#include <cmath>

#include "fem/joint.h"
#include "tests/support/differences.h"
#include "tests/support/models.h"

namespace flexmorph::fem {
namespace {

using testing::first_difference;
using testing::second_difference;
using testing::ShapeSet;
using testing::SmoothMotion;

FrameMotion swinging_hub(double t) {
  FrameMotion f;
  f.origin = {0.3 * std::sin(2 * t), 0.1 * t * t};
  f.origin_rate = {0.6 * std::cos(2 * t), 0.2 * t};
  f.origin_acceleration = {-1.2 * std::sin(2 * t), 0.2};
  f.angle = 0.4 + 1.5 * t + 0.7 * std::sin(t);
  f.angle_rate = 1.5 + 0.7 * std::cos(t);
  f.angle_acceleration = -0.7 * std::sin(t);
  return f;
}

struct JointCase {
  std::string name;
  ShapeSet shapes;
  std::unique_ptr<Joint> (*make)();
};

template <WeldMode mode>
std::unique_ptr<Joint> weld() {
  return make_weld("weld", "plate", "root", swinging_hub, mode);
}
std::unique_ptr<Joint> pin() { return make_pin("pin", "plate", {0.13, 0.02}, swinging_hub); }

class EveryJoint : public ::testing::TestWithParam<JointCase> {
 protected:
  EveryJoint()
      : plate(2, GetParam().shapes, testing::uniform_lines(0, 0.3, 2),
              testing::uniform_lines(-0.05, 0.05, 2)),
        joint(GetParam().make()) {
    const BodyView view{&body, &plate, kFirst};
    joint->bind({&view, 1});
    n = kFirst + 2 * plate.n_vectors();
    motion = std::make_unique<SmoothMotion>(VectorXd::Random(n), VectorXd::Ones(n), 8);
  }
  ConstraintRows rows(double t) const {
    ConstraintRows out;
    joint->evaluate(t, motion->q(t), motion->v(t), out);
    return out;
  }
  VectorXd times(const ConstraintRows& r, const VectorXd& x) const {
    VectorXd out = VectorXd::Zero(joint->size());
    for (const auto& entry : r.jacobian) out[entry.row()] += entry.value() * x[entry.col()];
    return out;
  }

  static constexpr int kFirst = 6;  // number of the unknowns of other bodies in front
  std::string body = "plate";
  AncfPlate plate;
  std::unique_ptr<Joint> joint;
  int n = 0;
  std::unique_ptr<SmoothMotion> motion;
};
INSTANTIATE_TEST_SUITE_P(
    Joints, EveryJoint,
    ::testing::Values(JointCase{"edge_h12", ShapeSet::h12, weld<WeldMode::edge>},
                      JointCase{"edge_h16", ShapeSet::h16, weld<WeldMode::edge>},
                      JointCase{"direction_h12", ShapeSet::h12, weld<WeldMode::direction>},
                      JointCase{"direction_h16", ShapeSet::h16, weld<WeldMode::direction>},
                      JointCase{"full_h12", ShapeSet::h12, weld<WeldMode::full>},
                      JointCase{"full_h16", ShapeSet::h16, weld<WeldMode::full>},
                      JointCase{"pin_h12", ShapeSet::h12, pin},
                      JointCase{"pin_h16", ShapeSet::h16, pin}),
    [](const auto& c) { return c.param.name; });

// Truncation (1e-3 x 3)^4 / 30 and round-off 1e-16 / 1e-6 are below 1e-9.
TEST_P(EveryJoint, RowsAreDifferencesAlongAMotion) {
  const double t = 0.6;
  const ConstraintRows r = rows(t);
  ASSERT_EQ(r.value.size(), joint->size());
  const auto value = [&](double dt) { return VectorXd(rows(t + dt).value); };
  EXPECT_LT((times(r, motion->v(t)) + r.rate - first_difference(value, 1e-3)).norm(), 1e-10);
  EXPECT_LT((times(r, motion->a(t)) - r.acceleration - second_difference(value, 1e-3)).norm(),
            2e-8);
}

TEST_P(EveryJoint, JacobianIsTheDerivativeByTheUnknowns) {
  const double t = 0.6;
  const ConstraintRows r = rows(t);
  const VectorXd direction = VectorXd::Random(n);
  const auto value = [&](double by) {
    ConstraintRows out;
    joint->evaluate(t, motion->q(t) + by * direction, motion->v(t), out);
    return VectorXd(out.value);
  };
  // The rows are linear in q; therefore the difference is exact except for round-off.
  EXPECT_LT((times(r, direction) - first_difference(value, 0.1)).norm(), 1e-13);
}

// Rows of positions are distances: if a held node is moved by d, its rows add |d|² to the sum of
// squares.
TEST_P(EveryJoint, UndeformedPlateInItsHubFitsTheWeld) {
  const FrameMotion hub = swinging_hub(0.6);
  Eigen::Matrix2d turn;
  turn << std::cos(hub.angle), -std::sin(hub.angle), std::sin(hub.angle), std::cos(hub.angle);
  VectorXd q = VectorXd::Random(n);
  const MatrixXd reference = plate.reference();
  for (int k = 0; k < plate.n_vectors(); ++k)
    q.segment<2>(kFirst + 2 * k) =
        turn * reference.row(k).transpose() + (plate.is_position(k) ? hub.origin : Vec2::Zero());
  ConstraintRows r;
  joint->evaluate(0.6, q, q, r);
  const VectorXd before = r.value;
  if (joint->size() > 2) {  // the point of the pin is not at the origin of the hub
    EXPECT_LT(before.cwiseAbs().maxCoeff(), 1e-15);
  }
  const Vec2 moved(0.03, -0.04);
  for (int k = 0; k < plate.n_vectors(); ++k)
    if (plate.is_position(k)) q.segment<2>(kFirst + 2 * k) += moved;
  joint->evaluate(0.6, q, q, r);
  const double held = (r.value - before).squaredNorm() / moved.squaredNorm();
  EXPECT_GT(held, 0.5);
  EXPECT_NEAR(held, std::round(held), 1e-12);
}

TEST(Joints, NameWhatTheyDoNotFind) {
  const std::string body = "plate";
  const AncfPlate plate = testing::swinging_plate(ShapeSet::h16);
  const BodyView view{&body, &plate, 0};
  EXPECT_THROW(make_weld("w", "arm", "root", swinging_hub, WeldMode::edge)->bind({&view, 1}),
               Error);
  EXPECT_THROW(make_weld("w", "plate", "top", swinging_hub, WeldMode::edge)->bind({&view, 1}),
               Error);
  // Inside an element whose lines move, a pin would need the rates of the shape functions.
  EXPECT_THROW(make_pin("p", "plate", {0.15, 0}, swinging_hub)->bind({&view, 1}), Error);
}

}  // namespace
}  // namespace flexmorph::fem
