// Shows that rows, rates and tangents of gears and paths agree with differences at random states,
// that a gear keeps its ratio over whole turns, and that the foot point and the checks of a plane
// curve are right.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "fem/body_joints.h"
#include "tests/support/differences.h"
#include "tests/support/rigid_models.h"

namespace flexmorph::fem {
namespace {

using testing::first_difference;
using testing::second_difference;

constexpr double kTurn = 2 * std::numbers::pi;

/// Two rigid bodies "one" and "two" and a joint between them.
class GearAndPath : public ::testing::Test {
 protected:
  void join(std::unique_ptr<Joint> joint) {
    testing::add_rigid(model_, "one", {1, {0, 0}, 0.02});
    testing::add_rigid(model_, "two", {4, {0, 0}, 0.3});
    model_.add_joint(std::move(joint));
    start_ = model_.reference().q;
  }
  const Joint& joint() const { return *model_.joints().back(); }
  ConstraintRows rows(const VectorXd& q, const VectorXd& v) const {
    ConstraintRows out;
    joint().evaluate(0, q, v, out);
    return out;
  }
  static VectorXd gradient(const ConstraintRows& rows, Eigen::Index n) {
    VectorXd out = VectorXd::Zero(n);
    for (const auto& entry : rows.jacobian) out[entry.col()] += entry.value();
    return out;
  }

  /// Settings of the comparison with differences.
  struct Differences {
    double spread;     ///< size of the random changes of the states
    double h;          ///< step of the differences, whose truncation is h⁴ f⁽⁵⁾ / 30
    double tolerance;  ///< for first derivatives; f⁽⁵⁾ is up to 300 for a gear, 3e5 for a path
    double period;     ///< the value is known up to multiples of the period; 0: not periodic
  };

  /// Compares rates, accelerations and the tangent with differences at random states near the
  /// start.
  void expect_derivatives(const Differences& by) {
    ASSERT_EQ(joint().size(), 1);
    const Eigen::Index n = start_.size();
    std::srand(7);
    for (int round = 0; round < 5; ++round) {
      const VectorXd q = start_ + by.spread * VectorXd::Random(n), v = VectorXd::Random(n),
                     a = VectorXd::Random(n), w = VectorXd::Random(n);
      const auto at = [&](double t) { return rows(q + t * v + 0.5 * t * t * a, v); };
      const ConstraintRows here = at(0);
      const auto value = [&](double t) {
        const double change = at(t).value[0] - here.value[0];
        return by.period > 0 ? std::remainder(change, by.period) : change;
      };
      EXPECT_NEAR(gradient(here, n).dot(v), first_difference(value, by.h), by.tolerance);
      EXPECT_NEAR(gradient(here, n).dot(a) - here.acceleration[0], second_difference(value, by.h),
                  1e2 * by.tolerance);
      std::vector<Eigen::Triplet<double>> entries;
      joint().add_stiffness(0, q, VectorXd::Constant(1, 1.7), entries);
      double product = 0;
      for (const auto& entry : entries) product += w[entry.row()] * entry.value() * v[entry.col()];
      const auto force = [&](double t) { return 1.7 * w.dot(gradient(at(t), n)); };
      EXPECT_NEAR(product, first_difference(force, by.h), 10 * by.tolerance);
    }
  }

  Workspace model_;
  VectorXd start_;
};

// Away from zero the value jumps between neighbouring teeth, which are 2 π/5 apart because 14 : 35
// is 2 : 5.
TEST_F(GearAndPath, GearHasTheDerivativesOfItsRow) {
  join(make_gear("mesh", {"one"}, {"two"}, {14, 35, false, 0.3, -1.1}));
  expect_derivatives({0.4, 1e-2, 1e-7, kTurn / 5});
}

TEST_F(GearAndPath, GearKeepsItsRatioOverWholeTurns) {
  join(make_gear("mesh", {"one"}, {"two"}, {14, 35, false, 0.3, -1.1}));
  for (const double turn : {0.0, 1.0, -7.3, 40.0}) {
    VectorXd q = start_;
    const double a = 0.3 + turn, b = -1.1 - 0.4 * turn;
    q.segment<2>(2) << std::cos(a), std::sin(a);
    q.segment<2>(6) << std::cos(b), std::sin(b);
    EXPECT_NEAR(rows(q, VectorXd::Zero(8)).value[0], 0, 1e-13) << turn;
    q.segment<2>(6) << std::cos(b + 0.01), std::sin(b + 0.01);
    EXPECT_NEAR(rows(q, VectorXd::Zero(8)).value[0], 0.01, 1e-13) << turn;
  }
}

TEST_F(GearAndPath, WheelsHaveTeeth) {
  EXPECT_THROW(make_gear("mesh", {"one"}, {"two"}, {0, 35}), Error);
}

PlaneCurve circle(const Vec2& center, double radius) {
  const auto coordinate = [=](double middle, double shift) {
    return [=](double s) {
      return Motion{middle + radius * std::cos(s - shift), -radius * std::sin(s - shift),
                    -radius * std::cos(s - shift)};
    };
  };
  return {coordinate(center.x(), 0), coordinate(center.y(), kTurn / 4), kTurn};
}

TEST_F(GearAndPath, PathHasTheDerivativesOfItsRow) {
  join(make_path("flank", {"one", {0.1, 0}, 0.2}, {"two", {0, -0.1}}, circle({0.2, 0}, 0.5)));
  start_.segment<2>(4) = Vec2(0.3, 0.5);  // off the curve
  expect_derivatives({0.05, 1e-3, 1e-8, 0});
}

// The expected value is the signed distance from the circle, positive inside, where the normal
// points.
TEST_F(GearAndPath, PathIsTheDistanceFromItsCurve) {
  join(make_path("wire", {}, {"two"}, circle({0.2, 0}, 0.5)));
  for (const Vec2& at : {Vec2(0.3, 0.5), Vec2(-0.4, 0.1), Vec2(0.2, -0.45), Vec2(0.7, 0)}) {
    start_.segment<2>(4) = at;
    EXPECT_NEAR(rows(start_, VectorXd::Zero(8)).value[0], 0.5 - (at - Vec2(0.2, 0)).norm(), 1e-14);
  }
}

TEST_F(GearAndPath, PathEndsWhereAnOpenCurveEnds) {
  const auto line = [](double slope) {
    return [slope](double s) { return Motion{slope * s, slope, 0}; };
  };
  join(make_path("slot", {}, {"two"}, PlaneCurve(line(1), line(-1), 1)));
  start_.segment<2>(4) = Vec2(0.5, -0.5);
  EXPECT_NEAR(rows(start_, VectorXd::Zero(8)).value[0], 0, 1e-15);
  start_.segment<2>(4) = Vec2(1.2, -1.2);
  EXPECT_THROW(rows(start_, VectorXd::Zero(8)), Error);
}

TEST(PlaneCurve, KnowsItsCornersAndCrossings) {
  const PlaneCurve round = circle({0, 0}, 1);
  EXPECT_TRUE(round.is_closed());
  EXPECT_NEAR(round.length(), kTurn, 1e-3);
  EXPECT_LT(round.corner(), 0);
  EXPECT_FALSE(round.crosses_itself());
  const auto wave = [](double angular_frequency) {
    return [angular_frequency](double s) {
      return Motion{std::sin(angular_frequency * s),
                    angular_frequency * std::cos(angular_frequency * s),
                    -angular_frequency * angular_frequency * std::sin(angular_frequency * s)};
    };
  };
  EXPECT_TRUE(PlaneCurve(wave(2), wave(1), kTurn).crosses_itself());  // a figure of eight
  const auto cusp = [](int power) {
    return [power](double s) {
      const double x = s - 1;
      return Motion{std::pow(x, power), power * std::pow(x, power - 1),
                    power * (power - 1) * std::pow(x, power - 2)};
    };
  };
  EXPECT_NEAR(PlaneCurve(cusp(3), cusp(2), 2).corner(), 1, 1e-12);
}

}  // namespace
}  // namespace flexmorph::fem
