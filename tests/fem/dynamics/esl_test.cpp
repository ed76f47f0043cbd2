// Shows that equivalent static loads have the right contents: deformation and acceleration in the
// axes of the turning_hub agree with differences in time of the positions of material points while
// the turning_hub accelerates and the material flows; the rigid continuation inside the turning_hub
// and the forces of point masses are right.
#include "fem/dynamics/esl.h"

#include <gtest/gtest.h>

#include <cmath>

#include "fem/terms.h"
#include "tests/support/differences.h"
#include "tests/support/models.h"

namespace flexmorph::fem {
namespace {

using testing::first_difference;
using testing::second_difference;

constexpr double kTime = 0.4, kRoot = 0.05, kEnd = 0.3;

/// Motion of the root line, which is on a column of the grid at kTime, with speed and acceleration.
Motion root_line(double t) {
  const double s = t - kTime;
  return {kRoot - 0.2 * s - 0.3 * s * s, -0.2 - 0.6 * s, -0.6};
}

FrameMotion turning_hub(double t) {
  FrameMotion f;
  f.origin = {0.2 * std::sin(t), 0.1 * t * t};
  f.origin_rate = {0.2 * std::cos(t), 0.2 * t};
  f.origin_acceleration = {-0.2 * std::sin(t), 0.2};
  f.angle = 0.3 + 4 * t + t * t;
  f.angle_rate = 4 + 2 * t;
  f.angle_acceleration = 2;
  return f;
}

Eigen::Matrix2d turn(double t) {
  const double angle = turning_hub(t).angle;
  Eigen::Matrix2d r;
  r << std::cos(angle), -std::sin(angle), std::sin(angle), std::cos(angle);
  return r;
}

class Esl : public ::testing::Test {
 protected:
  Esl() {
    std::vector<MaterialLine> m = testing::uniform_lines(kRoot, kEnd, 3);
    m[0].drive = root_line;
    const PlaneSection section{0.01, 1e8, 0.3, 2700};
    std::vector<std::unique_ptr<Term>> terms;
    terms.push_back(make_inertia(section));
    terms.push_back(make_membrane(section));
    model.add_body("plate",
                   std::make_unique<AncfPlate>(2, AncfPlate::ShapeSet::h16, m,
                                               testing::uniform_lines(-0.05, 0.05, 2)),
                   section, std::move(terms));
  }
  /// Returns the state whose rates belong to nodal values given as a function of time.
  template <class Values>
  State state(const Values& q) {
    State x;
    x.t = kTime;
    x.q = q(kTime);
    x.v = first_difference([&](double dt) { return VectorXd(q(kTime + dt)); }, 1e-3);
    x.a = second_difference([&](double dt) { return VectorXd(q(kTime + dt)); }, 1e-3);
    model.prepare(kTime);
    return x;
  }
  EslSet load(const State& x, std::span<const AttachedMass> masses = {},
              const VectorXd& gravity = {}, std::span<const AttachedForce> forces = {}) {
    model.prepare(x.t);
    return equivalent_static_load(model, x, {"plate", turning_hub, 1, 0.01}, grid, masses, forces,
                                  gravity);
  }

  Workspace model;
  Grid grid{0, -0.05, kEnd, 0.1, 30, 10};
};

TEST_F(Esl, FieldsAreThoseOfMaterialPointsInTheHubsAxes) {
  model.prepare(kTime);
  const testing::SmoothMotion motion(model.reference().q, 0.1 * model.scales().cwiseInverse(), 3);
  const State x = motion.state(kTime);
  VectorXd g(2);
  g << 0.5, -9.81;
  const EslSet set = load(x, {}, g);
  EXPECT_EQ(set.root_column, 5);
  EXPECT_NEAR(set.strain_energy, model.energies(x).strain, 0);
  const auto position = [&](double t, const Vec2& material) {
    model.prepare(t);
    return point_motion(model.body("plate"), motion.state(t), material).position;
  };
  for (int i = set.root_column + 1; i <= grid.nx; i += 4)
    for (int j = 0; j <= grid.ny; j += 5) {
      const Vec2 at = grid.node_position(i, j);
      const int entry = 2 * grid.node(i, j);
      const Vec2 u = turn(kTime).transpose() * (position(kTime, at) - turning_hub(kTime).origin) -
                     (at - Vec2(kRoot, 0));
      EXPECT_LT((set.deformation.segment<2>(entry) - u).norm(), 1e-14);
      const Vec2 r_tt =
          second_difference([&](double dt) { return position(kTime + dt, at); }, 1e-3);
      const Vec2 a = turn(kTime).transpose() * (r_tt - g);
      EXPECT_LT((set.acceleration.segment<2>(entry) - a).norm(), 1e-8 * (1 + a.norm())) << i;
    }
  for (int i = 0; i <= set.root_column; ++i)
    EXPECT_EQ(set.deformation.segment(2 * grid.node(i, 0), 2 * (grid.ny + 1)).norm(), 0);
}

// The acceleration of the rigid, extending body is a formula inside the turning_hub and comes from
// the shape functions outside. Both must equal the second difference of the motion R(t) (X - m₀(t))
// + o(t).
TEST_F(Esl, RigidBodyContinuesIntoTheHub) {
  const auto rigid = [&](double t) {
    VectorXd q(model.n_dofs());
    model.prepare(t);
    const auto& element = *model.bodies()[0].element;
    const MatrixXd reference = element.reference();
    for (int k = 0; k < element.n_vectors(); ++k) {
      Vec2 local = reference.row(k).transpose();
      if (element.is_position(k)) local.x() -= root_line(t).value;
      q.segment<2>(2 * k) =
          turn(t) * local + (element.is_position(k) ? turning_hub(t).origin : Vec2::Zero());
    }
    return q;
  };
  const State x = state(rigid);
  const EslSet set = load(x);
  for (int i = 0; i <= grid.nx; ++i)
    for (int j = 0; j <= grid.ny; j += 5) {
      const Vec2 at = grid.node_position(i, j);
      const auto position = [&](double dt) {
        const double t = kTime + dt;
        return Vec2(turn(t) * (at - Vec2(root_line(t).value, 0)) + turning_hub(t).origin);
      };
      const Vec2 a = turn(kTime).transpose() * second_difference(position, 1e-3);
      EXPECT_LT((set.acceleration.segment<2>(2 * grid.node(i, j)) - a).norm(), 1e-7) << i;
    }
  EXPECT_LT(set.deformation.norm(), 1e-13);
}

TEST_F(Esl, PointMassPushesWithItsInertia) {
  model.prepare(kTime);
  const State x = testing::SmoothMotion(model.reference().q, 0.1 * model.scales().cwiseInverse(), 3)
                      .state(kTime);
  const AttachedMass mass{0.5, {kEnd, 0.02}};
  const EslSet set = load(x, {&mass, 1});
  ASSERT_EQ(set.forces.size(), 1u);
  EXPECT_EQ(set.forces[0].node, grid.node(30, 7));
  const Vec2 a =
      turn(kTime).transpose() * point_motion(model.body("plate"), x, mass.material).acceleration;
  EXPECT_LT((set.forces[0].force + 0.5 * a).norm(), 1e-12 * a.norm());
  const AttachedMass between{0.5, {kEnd, 0.0213}};
  EXPECT_THROW(load(x, {&between, 1}), Error);
}

// Distributed forces have the prescribed resultant and moment in the axes of the turning_hub, also
// if no node is at the middle of the edge.
TEST_F(Esl, SpreadForcesKeepResultantAndMoment) {
  model.prepare(kTime);
  const State x = testing::SmoothMotion(model.reference().q, 0.1 * model.scales().cwiseInverse(), 3)
                      .state(kTime);
  for (const int rows : {10, 5, 1}) {
    grid.ny = rows;
    const double top = grid.y0 + grid.height;
    const AttachedForce edge{{kEnd, 0}, true, {3, -5}, 0.7}, point{{kEnd, top}, false, {1, 2}, 0};
    const EslSet set = load(x, {}, {}, std::vector{edge, point});
    Vec2 force(0, 0);
    double moment = 0;
    for (size_t i = 0; i + 1 < set.forces.size(); ++i) {
      const int node = set.forces[i].node;
      ASSERT_EQ(node / (grid.ny + 1), grid.nx);
      const double y = grid.node_position(grid.nx, node % (grid.ny + 1)).y();
      force += set.forces[i].force;
      moment -= y * set.forces[i].force.x();
    }
    EXPECT_LT((force - turn(kTime).transpose() * edge.force).norm(), 1e-14) << rows;
    EXPECT_NEAR(moment, edge.moment, 1e-14) << rows;
    EXPECT_EQ(set.forces.back().node, grid.node(30, rows));
    EXPECT_LT((set.forces.back().force - turn(kTime).transpose() * point.force).norm(), 1e-15);
  }
  const AttachedForce between{{kEnd - 0.3 * grid.dx(), 0}, true, {3, -5}, 0.7};
  EXPECT_THROW(load(x, {}, {}, std::vector{between}), Error);
}

// A root between two columns is assigned to the nearer column; the fields outside do not change.
TEST_F(Esl, RootBetweenTwoColumnsIsOnTheNearerOne) {
  for (const double later : {0.003, 0.007}) {
    const double t = kTime + later;
    model.prepare(t);
    const State x =
        testing::SmoothMotion(model.reference().q, 0.1 * model.scales().cwiseInverse(), 3).state(t);
    const EslSet set = load(x);
    const double root = root_line(t).value / grid.dx();
    ASSERT_GT(std::abs(root - std::round(root)), 0.01);
    EXPECT_EQ(set.root_column, std::lround(root));
    const Vec2 at = grid.node_position(20, 3);
    const Vec2 r = point_motion(model.body("plate"), x, at).position;
    const Vec2 u =
        turn(t).transpose() * (r - turning_hub(t).origin) - (at - Vec2(root_line(t).value, 0));
    EXPECT_LT((set.deformation.segment<2>(2 * grid.node(20, 3)) - u).norm(), 1e-14);
  }
}

/// Temperature rise ΔT in kelvin with a growing rate.
Motion temperature(double t) {
  const double s = t - kTime;
  return {80 + 50 * s + 400 * s * s, 50 + 800 * s, 800};
}
constexpr double kExpansion = 1e-3;

class HotEsl : public Esl {
 protected:
  HotEsl() { model.bodies()[0].heat = Heat{kExpansion, temperature}; }

  EslSet load_of(const State& x, const AttachedForce& force) {
    return load(x, {}, {}, {&force, 1});
  }

  /// Returns the nodal values of r = R(t) (s (X - m₀), y(X - m₀, Y)) + o(t) from s, y and its
  /// derivatives by x, y, xy.
  template <class Across>
  VectorXd grown(double t, const Across& across) {
    VectorXd q(model.n_dofs());
    model.prepare(t);
    const Element& element = *model.bodies()[0].element;
    const MatrixXd reference = element.reference();
    const double s = model.bodies()[0].heat->stretch(t).value;
    for (int k = 0; k < element.n_vectors(); ++k) {
      const Vec2 X = reference.row(k - k % 4).transpose();
      const double x = X.x() - root_line(t).value;
      const Eigen::Vector4d y = across(x, X.y());
      const Vec2 local(k % 4 == 0 ? s * x : k % 4 == 1 ? s : 0.0, y[k % 4]);
      q.segment<2>(2 * k) = turn(t) * local + (k % 4 == 0 ? turning_hub(t).origin : Vec2(0, 0));
    }
    return q;
  }
};

// A hot body expands freely. Its inertia loads use the expanded positions: they must equal the
// second difference of the motion R (1 + a) (X - m₀) + o, also in the turning_hub.
TEST_F(HotEsl, FreeGrowthIsNoDeformation) {
  const auto stretch = [](double t) { return 1 + kExpansion * temperature(t).value; };
  const State x = state([&](double t) {
    return grown(
        t, [&](double, double y) { return Eigen::Vector4d(stretch(t) * y, 0, stretch(t), 0); });
  });
  const EslSet set = load(x);
  EXPECT_NEAR(set.thermal_stretch, 0.08, 1e-15);
  EXPECT_EQ(set.held_stretch, 0);
  EXPECT_LT(set.deformation.norm(), 1e-13);
  for (int i = 0; i <= grid.nx; ++i)
    for (int j = 0; j <= grid.ny; j += 5) {
      const Vec2 at = grid.node_position(i, j);
      const auto position = [&](double dt) {
        const double t = kTime + dt;
        return Vec2(turn(t) * stretch(t) * (at - Vec2(root_line(t).value, 0)) +
                    turning_hub(t).origin);
      };
      const Vec2 a = turn(kTime).transpose() * second_difference(position, 1e-3);
      EXPECT_LT((set.acceleration.segment<2>(2 * grid.node(i, j)) - a).norm(), 1e-7) << i;
    }
}

// An edge that permits only a share of the thermal expansion restrains the rest. The deformation
// must equal the motion minus the free expansion of the plate.
TEST_F(HotEsl, TheEdgeHoldsBackWhatItDoesNotTakePartIn) {
  const double length = kEnd - kRoot;
  for (const double share : {0.0, 0.4, 1.0}) {
    const auto across = [&](double t) {
      const double a = kExpansion * temperature(t).value;
      return [&, a](double x, double y) {
        const double s = x / length, grow = 1 + a * (share + (1 - share) * s * s);
        const double slope = 2 * a * (1 - share) * s / length;
        return Eigen::Vector4d(grow * y, slope * y, grow, slope);
      };
    };
    const State x = state([&](double t) { return grown(t, across(t)); });
    const EslSet set = load(x);
    const double a = 0.08;
    EXPECT_NEAR(set.thermal_stretch, a, 1e-15);
    EXPECT_NEAR(set.held_stretch, (1 - share) * a, 1e-14);
    if (share == 0) {
      EXPECT_EQ(set.held_stretch, set.thermal_stretch);
    }
    for (int i = 0; i <= grid.nx; ++i)
      for (int j = 0; j <= grid.ny; ++j) {
        const Vec2 X = grid.node_position(i, j) - Vec2(kRoot, 0);
        const double missing = (1 - share) * a * (1 - std::pow(X.x() / length, 2));
        const Vec2 w(0, i < set.root_column ? 0.0 : -missing * X.y());
        EXPECT_LT((set.deformation.segment<2>(2 * grid.node(i, j)) - w).norm(), 1e-14) << i;
      }
    // The continuation into the turning_hub agrees with the plate at the root line, which is
    // between two columns.
    const auto rigid = [&](double t, const Vec2& X) {
      const double s = 1 + kExpansion * temperature(t).value;
      const double s_y = 1 + share * kExpansion * temperature(t).value;
      const Vec2 p = X - Vec2(root_line(t).value, 0);
      return Vec2(turn(t) * Vec2(s * p.x(), s_y * p.y()) + turning_hub(t).origin);
    };
    const Vec2 X = grid.node_position(2, 9);
    const Vec2 expected = turn(kTime).transpose() *
                          second_difference([&](double dt) { return rigid(kTime + dt, X); }, 1e-3);
    EXPECT_LT((set.acceleration.segment<2>(2 * grid.node(2, 9)) - expected).norm(), 1e-7);
  }
}

// The restrained stretch of the far edge is a where a joint keeps its width, for any rotation of
// the plate in the axes of the turning_hub; it is the rest of a where the edge expands partly; it
// is zero where the edge expands freely or where only a load acts on it.
TEST_F(HotEsl, TheFarEdgeIsHeldByItsJoint) {
  const double length = kEnd - kRoot, a = 0.08;
  const AttachedForce joint{{kEnd, 0}, true, {3, -5}, 0.7, true};
  AttachedForce load = joint, inner = joint, point = joint;
  load.held = false;
  inner.material.x() = 0.2;
  point.spread = false;
  for (const double share : {0.0, 0.4, 1.0}) {
    const auto across = [&](double x, double y) {
      const double s = x / length, grow = 1 + a * (1 - (1 - share) * s * s);
      const double slope = -2 * a * (1 - share) * s / length;
      return Eigen::Vector4d(grow * y, slope * y, grow, slope);
    };
    for (const double angle : {0.0, 0.3}) {
      State x = state([&](double t) { return grown(t, across); });
      const Eigen::Matrix2d turned = rotation(angle);
      for (Eigen::Index k = 0; k < x.q.size() / 2; ++k)
        x.q.segment<2>(2 * k) = (turned * x.q.segment<2>(2 * k)).eval();
      EXPECT_NEAR(load_of(x, joint).held_end_stretch, (1 - share) * a, 1e-14) << angle;
      if (share == 0) {
        EXPECT_EQ(load_of(x, joint).held_end_stretch, load_of(x, joint).thermal_stretch);
      }
      if (share == 1) {
        EXPECT_EQ(load_of(x, joint).held_end_stretch, 0);
      }
      for (const AttachedForce& other : {load, inner, point})
        EXPECT_EQ(load_of(x, other).held_end_stretch, 0);
    }
  }
  model.bodies()[0].heat.reset();
  EXPECT_EQ(load_of(state([&](double) { return model.reference().q; }), joint).held_end_stretch, 0);
}

// A hot body at its reference temperature has the loads of a cold body.
TEST_F(HotEsl, WithoutRiseItIsCold) {
  model.prepare(kTime);
  const State x = testing::SmoothMotion(model.reference().q, 0.1 * model.scales().cwiseInverse(), 3)
                      .state(kTime);
  model.bodies()[0].heat->temperature = [](double) { return Motion{}; };
  const EslSet hot = load(x);
  model.bodies()[0].heat.reset();
  const EslSet cold = load(x);
  EXPECT_EQ(hot.deformation, cold.deformation);
  EXPECT_LT((hot.acceleration - cold.acceleration).norm(), 1e-13 * cold.acceleration.norm());
  EXPECT_EQ(hot.held_stretch, 0);
  EXPECT_EQ(hot.thermal_stretch, 0);
}

TEST_F(HotEsl, RefusesATemperatureThatIsNone) {
  model.prepare(kTime);
  const State x = testing::SmoothMotion(model.reference().q, 0.1 * model.scales().cwiseInverse(), 3)
                      .state(kTime);
  for (const double bad : {-1001.0, std::nan("")}) {
    model.bodies()[0].heat->temperature = [bad](double) { return Motion{bad, 0, 0}; };
    EXPECT_THROW(load(x), Error);
  }
}

}  // namespace
}  // namespace flexmorph::fem
