// Shows that the force of every link does the work its energy gives up, that its tangent is the
// derivative of its force and its power what goes in and out otherwise; that the link's places in
// the matrix stay; and values of springs, dampers, loads known from outside.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "fem/bushing.h"
#include "fem/link.h"
#include "fem/stop.h"
#include "tests/support/differences.h"
#include "tests/support/models.h"
#include "tests/support/rigid_models.h"

namespace flexmorph::fem {
namespace {

using testing::first_difference;
using testing::ShapeSet;
using testing::SmoothMotion;

Motion shift(double t) {
  return {0.2 * std::sin(2.3 * t), 0.46 * std::cos(2.3 * t), -1.058 * std::sin(2.3 * t)};
}
MarkerPlace one() { return {.body = "one", .point = {0.3, -0.2}, .angle = 0.8}; }
MarkerPlace one_shifted() {
  return {.body = "one", .point = {0.3, -0.2}, .angle = 0.8, .along = shift};
}
MarkerPlace two() { return {.body = "two", .point = {-0.1, 0.4}, .angle = -1.9}; }
MarkerPlace ground() { return {.point = {2, 1}, .angle = 0.3}; }
MarkerPlace ground_shifted() { return {.point = {2, 1}, .angle = 0.3, .along = shift}; }
MarkerPlace plate() { return {.body = "plate", .point = {0.13, 0.02}}; }

LoadLaw driven(std::vector<LoadLaw::Component> components) { return components; }

struct LinkCase {
  std::string name;
  enum Kind {
    between,  // bodies, without shifted places
    outside   // from the ground, or with shifted places
  } kind;
  bool stores;  // all it takes, and gives it back
  std::function<std::unique_ptr<Link>()> make;
};

std::vector<LinkCase> cases() {
  return {
      {"spring", LinkCase::between, true,
       [] {
         return make_spring("l", one(), two(), {3, 0, 0.4});
       }},
      {"spring_shifted", LinkCase::outside, true,
       [] {
         return make_spring("l", one_shifted(), two(), {3, 0, 0.4});
       }},
      {"spring_without_length", LinkCase::between, true,
       [] {
         return make_spring("l", two(), plate(), {3, 0, 0});
       }},
      {"damper", LinkCase::between, false,
       [] {
         return make_spring("l", one(), two(), {0, 2, 0});
       }},
      {"damped_spring", LinkCase::outside, false,
       [] {
         return make_spring("l", ground_shifted(), one_shifted(), {3, 2, 0.4});
       }},
      {"damped_spring_on_plate", LinkCase::outside, false,
       [] {
         return make_spring("l", plate(), one_shifted(), {3, 2, 0.4});
       }},
      {"torsion_spring", LinkCase::between, true,
       [] {
         return make_torsion_spring("l", one(), two(), {3, 0, 0.4});
       }},
      {"damped_torsion_spring", LinkCase::outside, false,
       [] {
         return make_torsion_spring("l", ground(), two(), {3, 2, -1});
       }},
      {"bushing", LinkCase::between, true,
       [] {
         return make_bushing("l", one(), two(), {{3, 0.7}, {0, 0}, 2, 0, 0.4, {}});
       }},
      {"bushing_shifted", LinkCase::outside, true,
       [] {
         return make_bushing("l", one_shifted(), two(), {{3, 0.7}, {0, 0}, 2, 0, 0.4, {}});
       }},
      {"damped_bushing", LinkCase::outside, false,
       [] {
         return make_bushing("l", ground_shifted(), two(), {{3, 0.7}, {2, 1}, 2, 0.6, 1, {}});
       }},
      {"damped_bushing_on_plate", LinkCase::outside, false,
       [] {
         return make_bushing("l", one(), plate(), {{3, 0.7}, {2, 1}, 0, 0, 0, {}});
       }},
      {"stop", LinkCase::between, true,
       [] {
         return make_stop(
             "l", one(), two(),
             {.coordinate = StopData::Coordinate::along, .most = -9, .stiffness = 0.1});
       }},
      {"damped_stop", LinkCase::outside, false,
       [] {
         return make_stop("l", one_shifted(), plate(),
                          {.coordinate = StopData::Coordinate::along,
                           .most = -9,
                           .stiffness = 9,
                           .damping = 0.2});
       }},
      {"stop_in_onset", LinkCase::between, true,
       [] {
         return make_stop(
             "l", one(), two(),
             {.coordinate = StopData::Coordinate::along, .most = -9, .stiffness = 2, .onset = 99});
       }},
      {"damped_stop_in_onset", LinkCase::outside, false,
       [] {
         return make_stop("l", one_shifted(), plate(),
                          {.coordinate = StopData::Coordinate::along,
                           .most = -9,
                           .stiffness = 9,
                           .damping = 0.2,
                           .onset = 99});
       }},
      {"least_stop", LinkCase::between, true,
       [] {
         return make_stop(
             "l", one(), two(),
             {.coordinate = StopData::Coordinate::along, .least = 9, .stiffness = 0.1});
       }},
      {"damped_least_stop", LinkCase::outside, false,
       [] {
         return make_stop("l", one_shifted(), plate(),
                          {.coordinate = StopData::Coordinate::along,
                           .least = 9,
                           .stiffness = 9,
                           .damping = 0.2});
       }},
      {"least_stop_in_onset", LinkCase::between, true,
       [] {
         return make_stop(
             "l", one(), two(),
             {.coordinate = StopData::Coordinate::along, .least = 9, .stiffness = 2, .onset = 99});
       }},
      {"damped_least_stop_in_onset", LinkCase::outside, false,
       [] {
         return make_stop("l", one_shifted(), plate(),
                          {.coordinate = StopData::Coordinate::along,
                           .least = 9,
                           .stiffness = 9,
                           .damping = 0.2,
                           .onset = 99});
       }},
      {"distance_stop", LinkCase::between, true,
       [] {
         return make_stop(
             "l", one(), two(),
             {.coordinate = StopData::Coordinate::distance, .most = 0.01, .stiffness = 3});
       }},
      {"damped_distance_stop", LinkCase::outside, false,
       [] {
         return make_stop("l", one_shifted(), plate(),
                          {.coordinate = StopData::Coordinate::distance,
                           .most = 0.01,
                           .stiffness = 9,
                           .damping = 0.2});
       }},
      {"distance_stop_in_onset", LinkCase::between, true,
       [] {
         return make_stop("l", one(), two(),
                          {.coordinate = StopData::Coordinate::distance,
                           .most = 0.01,
                           .stiffness = 60,
                           .onset = 99});
       }},
      {"damped_distance_stop_in_onset", LinkCase::outside, false,
       [] {
         return make_stop("l", one_shifted(), plate(),
                          {.coordinate = StopData::Coordinate::distance,
                           .most = 0.01,
                           .stiffness = 9,
                           .damping = 0.2,
                           .onset = 99});
       }},
      {"angle_stop", LinkCase::between, true,
       [] {
         return make_stop(
             "l", one(), two(),
             {.coordinate = StopData::Coordinate::angle, .most = -8, .stiffness = 0.1});
       }},
      {"damped_angle_stop", LinkCase::outside, false,
       [] {
         return make_stop("l", one_shifted(), two(),
                          {.coordinate = StopData::Coordinate::angle,
                           .most = -8,
                           .stiffness = 9,
                           .damping = 0.2});
       }},
      {"angle_stop_in_onset", LinkCase::between, true,
       [] {
         return make_stop(
             "l", one(), two(),
             {.coordinate = StopData::Coordinate::angle, .most = -8, .stiffness = 2, .onset = 99});
       }},
      {"damped_angle_stop_in_onset", LinkCase::outside, false,
       [] {
         return make_stop("l", one_shifted(), two(),
                          {.coordinate = StopData::Coordinate::angle,
                           .most = -8,
                           .stiffness = 9,
                           .damping = 0.2,
                           .onset = 99});
       }},
      {"point_force_shifted", LinkCase::outside, true,
       [] { return make_point_force("l", one_shifted(), Vec2(2, -3)); }},
      {"point_force_on_plate", LinkCase::outside, true,
       [] { return make_point_force("l", plate(), Vec2(2, -3)); }},
      {"point_force_driven", LinkCase::outside, false,
       [] {
         return make_point_force(
             "l", one_shifted(),
             driven({[](double t) { return 2 * t; }, [](double t) { return t * t; }}));
       }},
      {"turning_force", LinkCase::outside, false,
       [] { return make_point_force("l", one_shifted(), Vec2(2, -3), true); }},
      {"turning_force_driven", LinkCase::outside, false,
       [] {
         return make_point_force(
             "l", two(),
             driven({[](double t) { return std::cos(t); }, [](double t) { return 1 - t; }}), true);
       }},
      {"torque_driven", LinkCase::outside, false,
       [] { return make_torque("l", two(), driven({[](double t) { return 1.7 + t; }})); }},
      {"torque", LinkCase::outside, false, [] { return make_torque("l", two(), 1.7); }}};
}

Workspace bodies() {
  Workspace model;
  model.add_body("plate",
                 std::make_unique<AncfPlate>(2, ShapeSet::h16, testing::even_lines(0, 0.3, 2),
                                             testing::even_lines(-0.05, 0.05, 1)),
                 {}, {});
  for (const char* name : {"one", "two"})
    model.add_body(name, std::make_unique<RigidBody>(1), {}, {});
  return model;
}

/// Bodies apart, so that no direction is lost and no angle wraps on the way.
SmoothMotion away(const Model& model) {
  VectorXd mean = model.reference().q;
  mean.segment<4>(model.body("one").first_dof) << 1, 0.2, 0.9, 0.3;
  mean.segment<4>(model.body("two").first_dof) << -0.6, 1.1, 0.4, 0.8;
  return {mean, VectorXd::Ones(mean.size()), 8};
}

class EveryLink : public ::testing::TestWithParam<LinkCase> {
 protected:
  EveryLink() : model(bodies()) {
    model.add_link(GetParam().make());
    motion = std::make_unique<SmoothMotion>(away(model));
  }
  VectorXd force(const State& x) {
    VectorXd out;
    model.force(x, out);
    return out;
  }
  const Link& link() const { return *model.links()[0]; }

  Workspace model;
  std::unique_ptr<SmoothMotion> motion;
};
INSTANTIATE_TEST_SUITE_P(Links, EveryLink, ::testing::ValuesIn(cases()),
                         [](const auto& c) { return c.param.name; });

// d(energies)/dt = power - f · q̇: what the force gives to the bodies, and what enters otherwise.
TEST_P(EveryLink, WorkPowerAndEnergyAddUp) {
  for (const double t : {0.6, 2.1}) {
    const auto energy = [&](double dt) {
      const Energies e = model.energies(motion->state(t + dt));
      return e.strain + e.potential;
    };
    const State x = motion->state(t);
    // f · q̇ is the work on the unknowns; energies grow by it and by the power that enters.
    EXPECT_NEAR(first_difference(energy, 1e-3), model.link_power(x) + force(x).dot(x.v), 1e-9);
  }
}

// Only dampers and motors have power, apart from shifted places.
TEST_P(EveryLink, HasNoPowerWhereItStoresAll) {
  const State x = motion->state(0.6);
  const bool shifted = GetParam().name.find("shifted") != std::string::npos;
  EXPECT_EQ(model.link_power(x) == 0, GetParam().stores && !shifted);
}

// Truncation (1e-3)^4 and round-off 1e-13: below 1e-8.
TEST_P(EveryLink, TangentIsTheDerivativeOfTheForce) {
  const State x = motion->state(0.6);
  const VectorXd direction = VectorXd::Random(model.n_dofs());
  Constraints none;
  model.constraints(x, none);
  SparseMatrix tangent;
  for (const bool by_rate : {false, true}) {
    const auto at = [&](double by) {
      State y = x;
      (by_rate ? y.v : y.q) += by * direction;
      return force(y);
    };
    model.kkt(x, none, {by_rate ? 0.0 : 1.0, by_rate ? 1.0 : 0.0, 0}, 1, tangent);
    EXPECT_LT((tangent * direction - first_difference(at, 1e-3)).norm(), 1e-8) << by_rate;
  }
}

TEST_P(EveryLink, PlacesStay) {
  const auto places = [&](const State& x) {
    std::vector<Eigen::Triplet<double>> entries;
    link().add_tangent(x, {}, entries);
    std::vector<std::pair<int, int>> out;
    for (const auto& entry : entries) out.emplace_back(entry.row(), entry.col());
    return out;
  };
  std::vector<Eigen::Triplet<double>> pattern;
  link().add_pattern(pattern);
  std::vector<std::pair<int, int>> expected;
  for (const auto& entry : pattern) expected.emplace_back(entry.row(), entry.col());
  EXPECT_EQ(places(motion->state(0.6)), expected);
  EXPECT_EQ(places(motion->state(2.1)), expected);
}

class EveryLinkBetween : public EveryLink {};
INSTANTIATE_TEST_SUITE_P(Links, EveryLinkBetween, ::testing::ValuesIn([] {
                           std::vector<LinkCase> out = cases();
                           std::erase_if(
                               out, [](const LinkCase& c) { return c.kind != LinkCase::between; });
                           return out;
                         }()),
                         [](const auto& c) { return c.param.name; });

// Internal forces leave the momenta alone: resultant and moment of all forces vanish.
TEST_P(EveryLinkBetween, BodiesItsForcesBalance) {
  const State x = motion->state(0.6);
  const VectorXd f = force(x);
  Vec2 sum(0, 0);
  double moment = 0;
  for (const Body& b : model.bodies())
    for (int k = 0; k < b.element->n_vectors(); ++k) {
      const Vec2 q = x.q.segment<2>(b.first_dof + 2 * k), g = f.segment<2>(b.first_dof + 2 * k);
      if (b.element->is_position(k)) sum += g;
      moment += q.x() * g.y() - q.y() * g.x();
    }
  EXPECT_GT(f.norm(), 0.1);
  EXPECT_LT(sum.norm(), 1e-14);
  EXPECT_NEAR(moment, 0, 1e-14);
}

// The mean force of a step does the work that the energy takes, whatever the step; its tangent is
// its derivative by the end of the step.
TEST(MeanForce, OfSpringsAndForcesKeepsTheEnergy) {
  for (const auto& [make, damped] :
       {std::pair{+[] {
                    return make_spring("l", one(), two(), {3, 0, 0.4});
                  },
                  false},
        {+[] {
           return make_spring("l", two(), plate(), {3, 0, 0});
         },
         false},
        {+[] {
           return make_spring("l", ground(), plate(), {3, 2, 0.4});
         },
         true},
        {+[] {
           return make_spring("l", one(), two(), {0, 2, 0.4});
         },
         true},
        {+[] { return make_point_force("l", plate(), Vec2(2, -3)); }, false}}) {
    Workspace model = bodies();
    model.add_link(make());
    const SmoothMotion motion = away(model);
    const double h = 0.3;
    State start = motion.state(0.6), end = motion.state(0.6 + h), mean = start;
    const auto set = [&](const VectorXd& q1) {
      end.q = q1;
      mean.q = 0.5 * (start.q + end.q);
      mean.v = (end.q - start.q) / h;
    };
    set(end.q);
    VectorXd f;
    model.mean_force(mean, start.q, end.q, f);
    const auto energy = [&](const State& x) {
      const Energies e = model.energies(x);
      return e.strain + e.potential;
    };
    const double work = f.dot(end.q - start.q), stored = energy(end) - energy(start);
    if (damped)
      EXPECT_GT(work, stored + 1e-3);
    else
      EXPECT_NEAR(work, stored, 1e-14);

    const VectorXd q1 = end.q, direction = VectorXd::Random(q1.size());
    const auto force = [&](double by) {
      set(q1 + by * direction);
      VectorXd out;
      model.mean_force(mean, start.q, end.q, out);
      return out;
    };
    const VectorXd difference = first_difference(force, 1e-3);
    set(q1);
    Constraints none;
    model.constraints(mean, none);
    SparseMatrix tangent;
    model.mean_kkt(mean, start.q, end.q, none, none, {0.5, 1 / h, 0}, 1, tangent);
    EXPECT_LT((tangent * direction - difference).norm(), 1e-8);
  }
}

/// One rigid body "one" at r with the angle, otherwise at rest.
State placed(const Model& model, const Vec2& r, double angle) {
  State x = model.reference();
  testing::put(model, "one", {r, angle}, x);
  return x;
}

// 3-4-5 triangle, 5 m long: N = 3 (5 - 4) + 2 · l̇ with l̇ = (3 · 10)/5 = 6.
TEST(Spring, PullsAlongItsLine) {
  Workspace model;
  model.add_body("one", std::make_unique<RigidBody>(1), {}, {});
  model.add_link(make_spring("s", {.point = {1, 1}}, {.body = "one", .point = {0, 1}}, {3, 2, 4}));
  State x = placed(model, {4, 4}, 0);
  x.v[0] = 10;
  VectorXd f;
  model.force(x, f);
  EXPECT_NEAR(f[0], 15 * 0.6, 1e-13);
  EXPECT_NEAR(f[1], 15 * 0.8, 1e-13);
  EXPECT_NEAR(model.energies(x).strain, 1.5, 1e-14);
  EXPECT_NEAR(model.link_power(x), -2 * 36, 1e-12);
}

// d = (3, 4) in the axes of a, turned by a quarter: forces 2 · 3 and 5 · 4 along them, 7 (π/2 -
// 0.5) about.
TEST(Bushing, PushesAlongAndAcross) {
  const double quarter = 0.5 * std::numbers::pi;
  Workspace model;
  model.add_body("one", std::make_unique<RigidBody>(1), {}, {});
  model.add_link(make_bushing("b", {.point = {1, 1}, .angle = quarter}, {.body = "one"},
                              {{2, 5}, {0.5, 0}, 7, 0, 0.5, {}}));
  State x = placed(model, {1 - 4, 1 + 3}, 2 * quarter);
  x.v[1] = 10;
  VectorXd f;
  model.force(x, f);
  EXPECT_NEAR(f[0], -20, 1e-13);
  EXPECT_NEAR(f[1], 6 + 5, 1e-13);
  EXPECT_NEAR(f.tail<2>().dot(Vec2(-x.q[3], x.q[2])), 7 * (quarter - 0.5), 1e-13);
  EXPECT_NEAR(model.energies(x).strain,
              0.5 * (2 * 9 + 5 * 16 + 7 * (quarter - 0.5) * (quarter - 0.5)), 1e-13);
  EXPECT_NEAR(model.link_power(x), -0.5 * 100, 1e-12);
}

// Free between its limits; k (δ - w/2) beyond its onset; it never pulls, whatever the rate: then
// its energy leaves as power.
TEST(Stop, PushesOnlyBeyondItsLimits) {
  Workspace model;
  model.add_body("one", std::make_unique<RigidBody>(1), {}, {});
  model.add_link(make_stop("s", {.point = {1, 0}}, {.body = "one"},
                           {.least = -2, .most = 3, .stiffness = 10, .damping = 4, .onset = 0.5}));
  const auto force = [&](double z, double rate) {
    State x = placed(model, {1 + z, 7}, 0);
    x.v[0] = rate;
    VectorXd f;
    model.force(x, f);
    EXPECT_EQ(f[1], 0);
    EXPECT_TRUE(f.tail<2>().isZero());
    return f[0];
  };
  for (const double z : {-2.0, 0.0, 3.0}) EXPECT_EQ(force(z, 5), 0) << z;
  EXPECT_NEAR(force(4, 0), 10 * 0.75, 1e-13);
  EXPECT_NEAR(force(4, 2), 10 * 0.75 + 8, 1e-13);
  EXPECT_NEAR(force(3.25, 2), 10 * 0.0625 + 4, 1e-13);
  EXPECT_NEAR(force(-3, -2), -10 * 0.75 - 8, 1e-13);
  EXPECT_EQ(force(4, -20), 0);
  EXPECT_EQ(force(-3, 20), 0);
  State x = placed(model, {1 + 4, 7}, 0);
  x.v[0] = -20;
  EXPECT_NEAR(model.link_power(x), -20 * 10 * 0.75, 1e-12);
}

// The angle goes the short way round: from 0.9 π to -0.9 π is 0.2 π, not -1.8 π.
TEST(TorsionSpring, WrapsItsAngle) {
  const double pi = std::numbers::pi;
  for (const auto& [turn, rest, expected] : {std::tuple{0.9 * pi, -0.9 * pi, -0.2 * pi},
                                             {-0.9 * pi, 0.9 * pi, 0.2 * pi},
                                             {0.5 * pi, -0.5 * pi, pi},
                                             {0.3, 0.1, 0.2}}) {
    Workspace model;
    model.add_body("one", std::make_unique<RigidBody>(1), {}, {});
    model.add_link(make_torsion_spring("s", {}, {.body = "one"}, {2, 0, rest}));
    const State x = placed(model, {0, 0}, turn);
    EXPECT_NEAR(model.energies(x).strain, expected * expected, 1e-13);
    // The moment is the work of the force on the rotation u̇ = J u.
    VectorXd f;
    model.force(x, f);
    const Vec2 turned(-x.q[3], x.q[2]);
    EXPECT_NEAR(std::abs(f.tail<2>().dot(turned)), std::abs(2 * expected), 1e-13);
    if (expected < pi) {
      EXPECT_GT(f.tail<2>().dot(turned) * expected, 0);
    }
  }
}

TEST(Torque, TurnsCounterClockwiseWithItsMoment) {
  Workspace model;
  testing::add_rigid(model, "one", {2, {0.3, 0.4}, 0.7});
  model.add_link(make_torque("t", {.body = "one"}, 5));
  const State x = placed(model, {1, 2}, 0.6);
  VectorXd f;
  model.force(x, f);
  EXPECT_NEAR(f.tail<2>().dot(Vec2(-x.q[3], x.q[2])), -5, 1e-14);
  EXPECT_LT(f.head<2>().norm(), 1e-15);
  model.scale_loads(0.5);
  model.force(x, f);
  EXPECT_NEAR(f.tail<2>().dot(Vec2(-x.q[3], x.q[2])), -2.5, 1e-14);
}

TEST(PointForce, IsTheGeneralizedForceOfItsPoint) {
  Workspace model;
  model.add_body("one", std::make_unique<RigidBody>(1), {}, {});
  model.add_link(make_point_force("f", {.body = "one", .point = {2, 3}}, Vec2(5, 7)));
  const State x = placed(model, {1, 2}, 0);
  VectorXd f;
  model.force(x, f);
  // δ(r + 2 u + 3 v) · F, v = (-u_y, u_x).
  EXPECT_TRUE(f.isApprox(Eigen::Vector4d(-5, -7, -(2 * 5 + 3 * 7), -(2 * 7 - 3 * 5)), 1e-14)) << f;
  EXPECT_NEAR(model.energies(x).potential, -(5 * 3 + 7 * 5), 1e-13);
  model.scale_loads(2);
  EXPECT_NEAR(model.energies(x).potential, -2 * (5 * 3 + 7 * 5), 1e-13);
}

TEST(Links, NameWhatTheyCannotUse) {
  const RigidBody one(1);
  const std::string name = "one";
  const BodyView view{&name, &one, 0};
  EXPECT_THROW(make_spring("s", {}, {.body = "arm"}, {1, 0, 0})->bind({&view, 1}), Error);
  EXPECT_THROW(make_spring("s", {}, {}, {1, 0, 0})->bind({&view, 1}), Error);
  EXPECT_THROW(make_spring("s", {}, {.body = "one"}, {-1, 0, 0}), Error);
  EXPECT_THROW(make_spring("s", {}, {.body = "one"}, {1, NAN, 0}), Error);
  EXPECT_THROW(make_torsion_spring("s", {}, {.body = "one"}, {1, -1, 0}), Error);
  EXPECT_THROW(make_bushing("b", {}, {.body = "one"}, {}), Error);
  EXPECT_THROW(make_bushing("b", {}, {.body = "one"}, {{-1, 0}, {0, 0}, 0, 0, 0, {}}), Error);
  EXPECT_THROW(make_stop("s", {}, {.body = "one"}, {.stiffness = 1}), Error);
  EXPECT_THROW(make_stop("s", {}, {.body = "one"}, {.most = 1}), Error);
  EXPECT_THROW(make_stop("s", {}, {.body = "one"}, {.least = 1, .most = 0, .stiffness = 1}), Error);
  EXPECT_THROW(make_point_force("f", {.body = "one"}, Vec2(INFINITY, 0)), Error);
  EXPECT_THROW(make_torque("t", {.body = "one"}, NAN), Error);

  Workspace model;
  model.add_body("one", std::make_unique<RigidBody>(1), {}, {});
  model.add_link(make_spring("s", {}, {.body = "one"}, {1, 0, 0.5}));
  VectorXd f;
  try {  // both ends at the origin
    model.force(model.reference(), f);
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), Error::Kind::numerical);
  }
  const State x = placed(model, {1, 0}, 0);
  model.add_link(make_torque("t", {.body = "one"}, 1));
  EXPECT_THROW(model.mean_force(x, x.q, x.q, f), Error);  // a torque has none
}

}  // namespace
}  // namespace flexmorph::fem
