// Shows that dependent joints are found: the rank agrees with a dense singular value decomposition,
// groups with mechanisms where they are known, the watched condition number with singular values.
// Shows also that plates are moved to their pins.
#include "fem/solve/diagnosis.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "fem/body_joints.h"
#include "fem/solve/assembly.h"
#include "fem/solve/redundancy.h"
#include "fem/terms.h"
#include "tests/support/dense.h"
#include "tests/support/errors.h"
#include "tests/support/models.h"
#include "tests/support/point_mechanisms.h"
#include "tests/support/rigid_models.h"

namespace flexmorph::fem {
namespace {

using testing::add;
using testing::constant;
using testing::error_of;
using testing::FourBar;
using testing::linear;
using testing::LinearRow;
using testing::locations;
using testing::mentions;
using testing::point_model;
using testing::Rod;
using Parts = std::vector<LinearRow::Part>;
using Names = std::vector<std::string>;

FrameMotion at_location(const Vec2& origin, const Vec2& rate = {0, 0}) {
  FrameMotion f;
  f.origin = origin;
  f.origin_rate = rate;
  return f;
}
Workspace pinned_plate(const std::vector<std::pair<std::string, Vec2>>& pins, const Vec2& material,
                       bool with_mass = true) {
  const PlaneSection section{0.01, 1e9, 0.3, 1000};
  std::vector<std::unique_ptr<Term>> terms;
  if (with_mass) terms.push_back(make_inertia(section));
  Workspace model;
  model.add_body(
      "plate",
      std::make_unique<AncfPlate>(2, AncfPlate::ShapeSet::h16, testing::uniform_lines(0, 0.4, 3),
                                  testing::uniform_lines(-0.05, 0.05, 2)),
      section, std::move(terms));
  for (const auto& [name, location] : pins)
    model.add_joint(
        make_pin(name, "plate", material, [p = location](double) { return at_location(p); }));
  return model;
}

/// Expects a description of one group that contains all of the parts, and that the group is called
/// contradictory only if the parts say so.
void expect_described(const Diagnosis& found, const Names& parts) {
  const std::string text = describe(found);
  for (const std::string& part : parts) EXPECT_TRUE(mentions(text, part)) << part << ": " << text;
  const bool contradicts = std::count(parts.begin(), parts.end(), "contradict") > 0;
  EXPECT_EQ(mentions(text, "contradict"), contradicts) << text;
  EXPECT_EQ(found.is_contradictory(), contradicts) << text;
  EXPECT_EQ(std::count(text.begin(), text.end(), '\n'), 0) << text;
}

// Without mass the norm is that of displacements. Pins are linear; therefore one step is
// sufficient.
TEST(Assembly, PlatesComeToTheirPins) {
  for (const bool with_mass : {true, false}) {
    Workspace model = pinned_plate({{"pin", {0.11, -0.07}}}, {0.1, 0.02}, with_mass);
    State x = model.reference();
    const Assembly report = assemble(model, x);
    Constraints c;
    model.constraints(x, c);
    EXPECT_LT(c.value.lpNorm<Eigen::Infinity>(), 1e-14);
    EXPECT_LE(report.iterations, 3);
    EXPECT_EQ(report.velocity_change, 0);
    EXPECT_EQ(diagnose(model, x).rank, 2);
  }
}

TEST(Diagnosis, TwoPinsAtOneLocation) {
  Workspace twice = pinned_plate({{"pin_1", {0.1, 0}}, {"pin_2", {0.1, 0}}}, {0.1, 0});
  const Diagnosis redundant = diagnose(twice, twice.reference());
  EXPECT_EQ(redundant.rank, 2);
  EXPECT_EQ(redundant.degrees_of_freedom(), twice.n_dofs() - 2);
  ASSERT_EQ(redundant.groups.size(), 1u);
  EXPECT_EQ(redundant.groups[0].joints, (Names{"pin_1", "pin_2"}));
  EXPECT_EQ(redundant.groups[0].surplus, 2);
  EXPECT_FALSE(redundant.is_contradictory());
  expect_described(redundant, {"'pin_1'", "'pin_2'", "2 degrees of freedom"});

  Workspace apart = pinned_plate({{"pin_1", {0.1, 0}}, {"pin_2", {0.112, 0}}}, {0.1, 0});
  State x = apart.reference();
  const Diagnosis diagnosis = diagnose(apart, x);
  EXPECT_TRUE(diagnosis.is_contradictory());
  // The weights of a pin inside an element have a root sum of squares below 1, which R counts as 1.
  EXPECT_GE(diagnosis.groups[0].miss, 0.012);
  EXPECT_LE(diagnosis.groups[0].miss, 0.024);
  const std::string text = error_of(Error::Kind::input, [&] { leave_out_redundant(apart, x); });
  for (const char* part : {"'pin_1'", "'pin_2'", "contradict", " m"})
    EXPECT_TRUE(mentions(text, part)) << text;
  EXPECT_TRUE(
      mentions(error_of(Error::Kind::numerical, [&] { assemble(apart, x); }), "contradict"));
}

TEST(Diagnosis, ContradictionsByValueRateAndAcceleration) {
  const auto diagnosis_of = [](const testing::Course& second) {
    Workspace model = point_model(locations({{1, 0}}));
    add<LinearRow>(model, "a", Parts{{0, 0}}, linear(1, 0.3));
    add<LinearRow>(model, "b", Parts{{0, 0}}, second);
    return diagnose(model, model.reference());
  };
  expect_described(diagnosis_of(linear(1, 0.3)), {"'a'", "'b'", "one degree of freedom"});
  const Diagnosis by_value = diagnosis_of(linear(1.012, 0.3));
  expect_described(by_value, {"'a'", "'b'", "contradict", " 0.012 m"});
  EXPECT_FALSE(mentions(describe(by_value), "m/s")) << describe(by_value);
  expect_described(diagnosis_of(linear(1, 0.5)),
                   {"'a'", "'b'", "contradict", " 0.2 m/s", "velocity"});
  const auto accelerated = [](double) { return Motion{1, 0.3, 2}; };
  expect_described(diagnosis_of(accelerated),
                   {"'a'", "'b'", "contradict", " 2 m/s²", "acceleration"});
}

// Round-off of drives that are equal in exact arithmetic is no contradiction, even in a model at
// rest, where no other value gives the size of a rate.
TEST(Diagnosis, RoundOffIsNoContradiction) {
  for (const Motion& second :
       {Motion{1, 1.9e-15, 0}, Motion{1, 0, 1.89e-15}, Motion{1 + 2e-16, 0, 0}}) {
    Workspace model = point_model(locations({{1, 0}}));
    add<LinearRow>(model, "a", Parts{{0, 0}}, linear(1, 0));
    add<LinearRow>(model, "b", Parts{{0, 0}}, [second](double) { return second; });
    expect_described(diagnose(model, model.reference()), {"'a'", "'b'", "one degree of freedom"});
  }
}

// x_a = 0, x_b = 1 and x_b - x_a = 1: any two of the three are independent. Other joints do not
// belong to the group.
TEST(Diagnosis, ThreeJointsDependentOnlyTogether) {
  for (const double distance : {1.0, 1.25}) {
    Workspace model = point_model(locations({{0, 0}, {1, 0}, {2, 1}}));
    add<LinearRow>(model, "other", Parts{{0, 1}}, constant(0));
    add<LinearRow>(model, "a", Parts{{0, 0}}, constant(0));
    add<Rod>(model, "rod", 1, 2, constant(std::sqrt(2)));
    add<LinearRow>(model, "b", Parts{{1, 0}}, constant(1));
    add<LinearRow>(model, "between", Parts{{1, 0}, {0, 0, -1}}, constant(distance));
    const Diagnosis d = diagnose(model, model.reference());
    EXPECT_EQ(d.rank, 4);
    EXPECT_EQ(d.degrees_of_freedom(), 2);
    ASSERT_EQ(d.groups.size(), 1u);
    EXPECT_EQ(d.groups[0].joints, (Names{"a", "b", "between"}));
    EXPECT_EQ(d.groups[0].contradictory, distance != 1.0);
    for (const Names& pair : {Names{"a", "b"}, Names{"a", "between"}, Names{"b", "between"}}) {
      Workspace two = point_model(locations({{0, 0}, {1, 0}}));
      for (const auto& joint : pair) {
        if (joint == "a") add<LinearRow>(two, joint, Parts{{0, 0}}, constant(0));
        if (joint == "b") add<LinearRow>(two, joint, Parts{{1, 0}}, constant(1));
        if (joint == "between")
          add<LinearRow>(two, joint, Parts{{1, 0}, {0, 0, -1}}, constant(distance));
      }
      EXPECT_TRUE(diagnose(two, two.reference()).is_independent());
    }
  }
}

// A platform on three equal, parallel cranks has one redundant crank, but only if the lengths are
// exact. The rows are independent at an inexact start and dependent in the assembled mechanism.
TEST(Diagnosis, ThreeParallelCranks) {
  const Vec2 crank(0.2, 0.3);
  const std::vector<Vec2> ground = {{0, 0}, {1, 0}, {0.4, 0.5}};
  const auto model_with = [&](double third) {
    std::vector<Vec2> points;
    for (const Vec2& g : ground) points.push_back(g + crank);
    Workspace model = point_model(locations(points));
    for (int i = 0; i < 3; ++i)
      add<Rod>(model, "crank_" + std::to_string(i), i, -1,
               constant(crank.norm() * (i == 2 ? third : 1)), ground[static_cast<size_t>(i)]);
    for (int i = 0; i < 3; ++i) {
      const int j = (i + 1) % 3;
      const double length =
          (ground[static_cast<size_t>(i)] - ground[static_cast<size_t>(j)]).norm();
      add<Rod>(model, "side_" + std::to_string(i), i, j, constant(length));
    }
    return model;
  };
  Workspace model = model_with(1);
  State x = model.reference();
  for (int i = 0; i < 6; ++i) x.q[i] += 0.04 * std::cos(2.0 * i);
  EXPECT_EQ(degrees_of_freedom(model, x), 0);
  assemble(model, x);
  const Diagnosis d = diagnose(model, x);
  EXPECT_EQ(d.degrees_of_freedom(), 1);
  ASSERT_EQ(d.groups.size(), 1u);
  EXPECT_EQ(d.groups[0].joints.size(), 6u);
  EXPECT_FALSE(d.is_contradictory());
}

/// Returns a chain of rigid links, the first hinged to the ground; `last` hinges also hold its end
/// at the ground.
Workspace chain(int links, int last) {
  const RigidSection section{1, {0.05, 0}, 0.01};
  Workspace model;
  for (int i = 0; i < links; ++i) testing::add_rigid(model, "link" + std::to_string(i), section);
  const auto add = [&](const std::string& name, const MarkerLocation& a, const MarkerLocation& b) {
    model.add_joint(make_revolute(name, a, b));
  };
  for (int i = 0; i < links; ++i) {
    const MarkerLocation before =
        i == 0 ? MarkerLocation{"", {0, 0}, 0, {}}
               : MarkerLocation{"link" + std::to_string(i - 1), {0.1, 0}, 0, {}};
    add("pin" + std::to_string(i), before, {"link" + std::to_string(i), {0, 0}, 0, {}});
  }
  for (int k = 0; k < last; ++k)
    add("end" + std::to_string(k), {"", {0.05 * links, 0}, 0, {}},
        {"link" + std::to_string(links - 1), {0.1, 0}, 0, {}});
  return model;
}

// By Grübler's formula, a pin removes 2 of 3 n degrees of freedom. A chain of a thousand links is
// diagnosed by the fast method, which finds independent rows only; dependent joints of a shorter
// chain are named.
TEST(Diagnosis, ChainsOfRigidLinks) {
  const auto zigzag = [](Workspace& model, int links) {
    State x = model.reference();
    for (int i = 0; i < links; ++i) {
      testing::Pose pose;
      pose.r = {0.05 * i, i % 2 == 0 ? 0 : 0.1 * std::sqrt(0.75)};
      pose.angle = (i % 2 == 0 ? 1 : -1) * std::acos(0.5);
      testing::put(model, "link" + std::to_string(i), pose, x);
    }
    return x;
  };
  for (const int links : {4, 1000})
    for (const int last : {0, 1}) {
      Workspace model = chain(links, last);
      const Diagnosis found = diagnose(model, zigzag(model, links));
      EXPECT_TRUE(found.is_independent()) << describe(found);
      EXPECT_EQ(found.degrees_of_freedom(), 3 * links - 2 * (links + last));
      EXPECT_EQ(found.independent.size(), static_cast<size_t>(found.constraints));
    }
  Workspace model = chain(20, 2);
  const Diagnosis found = diagnose(model, zigzag(model, 20));
  EXPECT_EQ(found.degrees_of_freedom(), 3 * 20 - 2 * 21);
  expect_described(found, {"'end0'", "'end1'", "2 degrees of freedom"});
}

// Of five conditions on two coordinates, each surplus joint is named with as few other joints as
// possible.
TEST(Diagnosis, NamesAsFewJointsAsItCan) {
  Workspace model = point_model(locations({{1, 0}, {2, 0}}));
  add<LinearRow>(model, "a", Parts{{0, 0}}, constant(1));
  add<LinearRow>(model, "b", Parts{{0, 0}, {1, 0}}, constant(3));
  add<LinearRow>(model, "c", Parts{{0, 0}, {1, 0, -1}}, constant(-1));
  add<LinearRow>(model, "d", Parts{{0, 0}, {1, 0}}, constant(3));
  add<LinearRow>(model, "e", Parts{{0, 0}}, constant(1));
  const Diagnosis d = diagnose(model, model.reference());
  EXPECT_EQ(d.rank, 2);
  int pairs = 0, triples = 0;
  for (const DependentGroup& g : d.groups) {
    pairs += g.joints.size() == 2;
    triples += g.joints.size() == 3;
  }
  EXPECT_EQ(pairs, 2) << describe(d);
  EXPECT_EQ(triples, 1) << describe(d);
}

MatrixXd dense_jacobian(Workspace& model, const State& x) {
  ScaledConstraints rows;
  rows.evaluate(model, x);
  return MatrixXd(rows.jacobian());
}

// Random frameworks of rods have some degrees of freedom, redundant rods, duplicate rods and held
// points.
TEST(Diagnosis, RankOfRandomMechanismsAgainstSingularValues) {
  std::mt19937 random(11);
  int dependent = 0;
  for (int trial = 0; trial < 60; ++trial) {
    const int n = 3 + trial % 10;
    const MatrixXd at = MatrixXd::NullaryExpr(
        n, 2, [&] { return std::uniform_real_distribution<double>(-1, 1)(random); });
    Workspace model = point_model(at);
    const auto point = [&] { return std::uniform_int_distribution<int>(0, n - 1)(random); };
    const int rods = std::uniform_int_distribution<int>(n, 3 * n)(random);
    for (int i = 0; i < rods; ++i) {
      const int a = point(), b = point();
      if (a == b) continue;
      add<Rod>(model, "rod_" + std::to_string(i), a, b, constant((at.row(a) - at.row(b)).norm()));
    }
    for (int i = 0; i < trial % 4; ++i) {
      const int a = point();
      add<LinearRow>(model, "hold_" + std::to_string(i), Parts{{a, i % 2}}, constant(at(a, i % 2)));
    }
    const State x = model.reference();
    const MatrixXd j = dense_jacobian(model, x);
    const VectorXd values = testing::singular_values(j);
    const int rank = static_cast<int>((values.array() > 1e-9 * values[0]).count());
    const Diagnosis d = diagnose(model, x);
    EXPECT_EQ(d.rank, rank) << trial;
    int surplus = 0;
    for (const DependentGroup& g : d.groups) {
      surplus += g.surplus;
      EXPECT_FALSE(g.contradictory) << describe(d);
      // The rows of a group are dependent, the independent rows are not.
      MatrixXd part(g.rows.size(), j.cols());
      for (size_t i = 0; i < g.rows.size(); ++i)
        part.row(static_cast<Eigen::Index>(i)) = j.row(g.rows[i]);
      EXPECT_LE(testing::rank(part, 1e-9), static_cast<int>(g.rows.size()) - 1);
    }
    EXPECT_EQ(surplus, model.n_constraints() - rank) << trial;
    MatrixXd basis(rank, j.cols());
    for (int i = 0; i < rank; ++i) basis.row(i) = j.row(d.independent[static_cast<size_t>(i)]);
    EXPECT_EQ(testing::rank(basis, 1e-9), rank);
    dependent += rank < model.n_constraints();
  }
  EXPECT_GT(dependent, 15) << "too few of them show anything";
}

// The estimated condition number is compared with dense singular values while a four-bar approaches
// its dead centre; the stretched rods are named.
TEST(ConstraintWatch, ConditionOfAMechanismNearItsDeadCentre) {
  const FourBar bar{.r = 0.3, .l = 0.35, .s = 0.25, .g = 0.45};
  Workspace model = bar.model(linear(0, 0));
  ConstraintWatch watch(model);
  for (const double before : {0.5, 1e-2, 1e-4, 1e-6, 1e-8}) {
    State x = model.reference();
    x.q = bar.locations(bar.limit_angle() - before);
    const VectorXd values = testing::singular_values(dense_jacobian(model, x));
    const double exact = values[0] / values[values.size() - 1];
    const Conditioning found = watch.look(x);
    EXPECT_LE(found.condition, 1.001 * exact) << before;
    EXPECT_GE(found.condition, 0.95 * exact) << before;
    EXPECT_EQ(found.condition, constraint_condition(model, x));
    if (before > 1e-3) continue;
    EXPECT_TRUE(std::count(found.joints.begin(), found.joints.end(), "coupler")) << before;
    EXPECT_TRUE(mentions(describe(found), "'rocker'")) << describe(found);
  }
}

TEST(ConstraintWatch, SaturatesWhereRowsAreDependent) {
  Workspace model = point_model(locations({{1, 0}}));
  EXPECT_EQ(constraint_condition(model, model.reference()), 1);
  add<Rod>(model, "a", 0, -1, constant(1));
  add<Rod>(model, "b", 0, -1, constant(1));
  EXPECT_GT(constraint_condition(model, model.reference()), 1e6);
}

}  // namespace
}  // namespace flexmorph::fem
