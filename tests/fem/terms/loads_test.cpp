// Shows that loads are right: resultants and moments of the generalized force agree with the
// statics of the load on the deformed shape, tangents agree with differences, dead loads have a
// potential, and forces are proportional to the load factor.
#include "fem/loads.h"

#include <gtest/gtest.h>

#include <cmath>

#include "fem/dynamics/mesh_changes/moving_root.h"
#include "tests/support/differences.h"
#include "tests/support/space_plates.h"

namespace flexmorph::fem {
namespace {

using testing::first_difference;
using testing::ShapeSet;
using testing::SpacePlate;
using testing::vector;

struct LoadCase {
  std::string name;
  ShapeSet shapes;
  std::unique_ptr<Term> (*make)();
};

/// A deformed plate with one load only.
class EveryLoad : public ::testing::TestWithParam<LoadCase> {
 protected:
  static SpacePlate plate() {
    SpacePlate p;
    p.length = 0.9;
    p.width = 0.5;
    p.nx = 3;
    p.ny = 2;
    p.shapes = GetParam().shapes;
    p.terms = {};
    return p;
  }
  EveryLoad() : model(plate().model(GetParam().make())), x(model.reference()) {
    const auto& element = dynamic_cast<const AncfPlate&>(*model.bodies()[0].element);
    const MatrixXd q = testing::random_shape(element, 0.2, 3);
    for (int k = 0; k < element.n_vectors(); ++k) x.q.segment<3>(3 * k) = q.row(k).transpose();
    model.prepare(0);
  }
  VectorXd force(const VectorXd& q) {
    State y = x;
    y.q = q;
    VectorXd f;
    model.force(y, f);
    return f;
  }

  Workspace model;
  State x;
};
INSTANTIATE_TEST_SUITE_P(
    Loads, EveryLoad,
    ::testing::Values(
        LoadCase{"point", ShapeSet::h16,
                 [] {
                   return make_point_force({0.4, 0.1}, vector(1, 2, 3));
                 }},
        LoadCase{"edge", ShapeSet::h12,
                 [] { return make_edge_load("side_high", vector(1, 2, 3)); }},
        LoadCase{"surface", ShapeSet::h16, [] { return make_surface_load(vector(1, 2, 3)); }},
        LoadCase{"pressure_h12", ShapeSet::h12, [] { return make_pressure(3); }},
        LoadCase{"pressure_h16", ShapeSet::h16, [] { return make_pressure(3); }},
        LoadCase{"moment_root_h16", ShapeSet::h16, [] { return make_edge_moment("root", 2); }},
        LoadCase{"moment_end_h12", ShapeSet::h12, [] { return make_edge_moment("free_end", 2); }},
        LoadCase{"moment_end_h16", ShapeSet::h16, [] { return make_edge_moment("free_end", 2); }},
        LoadCase{"turning_point", ShapeSet::h16,
                 [] {
                   return make_turning_point_force({0.4, 0.1}, vector(1, 2, 3));
                 }},
        LoadCase{"turning_edge", ShapeSet::h12,
                 [] { return make_turning_edge_load("side_high", vector(1, 2, 3)); }},
        LoadCase{"turning_surface", ShapeSet::h16,
                 [] { return make_turning_surface_load(vector(1, 2, 3)); }},
        LoadCase{"moment_side_h16", ShapeSet::h16,
                 [] { return make_edge_moment("side_high", 2); }}),
    [](const auto& c) { return c.param.name; });

// Along random directions truncation (1e-3)⁴ and round-off 1e-16 / 1e-3 are below 1e-9.
TEST_P(EveryLoad, TangentIsTheDerivativeOfTheForce) {
  Constraints none;
  SparseMatrix k;
  model.constraints(x, none);
  model.kkt(x, none, {1, 0, 0}, 1, k);
  const VectorXd scales = model.scales(), f = force(x.q);
  std::srand(1);
  for (int i = 0; i < 5; ++i) {
    const VectorXd direction = VectorXd::Random(x.q.size()).cwiseQuotient(scales) * 0.2;
    const VectorXd df =
        first_difference([&](double by) { return VectorXd(force(x.q + by * direction)); }, 1e-3);
    EXPECT_LT((k * direction - df).cwiseQuotient(scales).norm(),
              1e-7 * f.cwiseQuotient(scales).norm());
  }
}

TEST_P(EveryLoad, IsProportionalToItsFactor) {
  const VectorXd one = force(x.q);
  model.scale_loads(0);
  EXPECT_EQ(force(x.q).norm(), 0);
  model.scale_loads(-2.5);
  EXPECT_LT((force(x.q) + 2.5 * one).norm(), 1e-14 * one.norm());
}

// The derivative of the potential is the force (follower loads have no potential and give 0).
TEST_P(EveryLoad, PotentialOfDeadLoadsIsTheirWork) {
  for (const char* follows : {"pressure", "moment", "turning"})
    if (GetParam().name.starts_with(follows)) {
      EXPECT_EQ(model.energies(x).potential, 0);
      return;
    }
  const VectorXd direction = VectorXd::Random(x.q.size());
  const double dv = first_difference(
      [&](double by) {
        State y = x;
        y.q += by * direction;
        return model.energies(y).potential;
      },
      1e-2);
  EXPECT_NEAR(dv, force(x.q).dot(direction), 1e-10 * std::abs(dv));
}

/// Returns the resultant of a generalized force: its work in a unit translation.
Vec3 resultant(const Model& model, const VectorXd& f) {
  Vec3 out = Vec3::Zero();
  const Element& element = *model.bodies()[0].element;
  for (int k = 0; k < element.n_vectors(); ++k)
    if (element.is_position(k)) out += f.segment<3>(3 * k);
  return out;
}

/// Returns the moment about the origin: the work in a unit rotation, in which all vectors rotate.
Vec3 moment(const VectorXd& q, const VectorXd& f) {
  Vec3 out = Vec3::Zero();
  for (Eigen::Index k = 0; k < q.size(); k += 3)
    out += q.segment<3>(k).cross(Vec3(f.segment<3>(k)));
  return out;
}

TEST_P(EveryLoad, ResultantIsThatOfTheLoad) {
  const Vec3 found = -resultant(model, force(x.q));
  const std::string name = GetParam().name;
  Vec3 expected = Vec3::Zero();  // edge moments have no resultant
  if (name == "point") expected = {1, 2, 3};
  if (name == "edge") expected = 0.9 * Vec3(1, 2, 3);
  if (name == "surface") expected = 0.9 * 0.5 * Vec3(1, 2, 3);
  if (name == "turning_point") {
    const Body& body = model.bodies()[0];
    const auto at = [&](double dx, double dy) {
      return point_position(body, x, {0.4 + dx, 0.1 + dy});
    };
    const Vec3 r_m = (at(1e-5, 0) - at(-1e-5, 0)) / 2e-5, r_n = (at(0, 1e-5) - at(0, -1e-5)) / 2e-5;
    const Vec3 first = r_m.normalized(), third = r_m.cross(r_n).normalized();
    expected = first + 2 * third.cross(first) + 3 * third;
    // tolerance: round-off and truncation of the differences
    EXPECT_LT((found - expected).norm(), 1e-8);
    return;
  }
  if (name.starts_with("turning")) return;
  if (name.starts_with("pressure")) {  // ∮ r × dr / 2: the vector area depends on the boundary only
    const Element& element = *model.bodies()[0].element;
    const auto edge_integral = [&](const std::string& edge, bool along_m) {
      Vec3 sum = Vec3::Zero();
      const auto nodes = element.edge(edge);
      for (size_t i = 0; i + 1 < nodes.size(); ++i)
        for (size_t g = 0; g < 4; ++g) {
          const Vec2 step = nodes[i + 1].material - nodes[i].material;
          ShapeTable t;
          const int e =
              element.locate(nodes[i].material + gauss(4).points[g] * step, Tabulate::gradient, t);
          LocalRows q(element.n_shapes(), 3);
          for (int k = 0; k < element.n_shapes(); ++k)
            q.row(k) = x.q.segment<3>(3 * element.vectors(e)[static_cast<size_t>(k)]);
          const Vec3 r = MatrixXd(t.N * q).transpose(),
                     d = MatrixXd((along_m ? t.N_m : t.N_n) * q).transpose();
          sum += 0.5 * gauss(4).weights[g] * step.norm() * r.cross(d);
        }
      return sum;
    };
    expected = 3 * (edge_integral("side_low", true) + edge_integral("free_end", false) -
                    edge_integral("side_high", true) - edge_integral("root", false));
  }
  EXPECT_LT((found - expected).norm(), 1e-13 * (1 + expected.norm()));
}

// On the undeformed plate n̂ = e_z, and slopes are e_x, e_y. Rotating the outward slope e_x towards
// e_z is a moment about -e_y.
TEST(EdgeMoment, TurnsTheOutwardSlopeTowardsTheNormal) {
  const struct {
    std::string edge;
    Vec3 moment;  // for a moment of 2 per length
  } cases[] = {{"free_end", {0, -2 * 0.5, 0}},
               {"root", {0, 2 * 0.5, 0}},
               {"side_high", {2 * 0.9, 0, 0}},
               {"side_low", {-2 * 0.9, 0, 0}}};
  for (const auto& c : cases) {
    SpacePlate p;
    p.length = 0.9;
    p.width = 0.5;
    p.nx = p.ny = 2;
    p.terms = {};
    Workspace model = p.model(make_edge_moment(c.edge, 2));
    model.prepare(0);
    const State x = model.reference();
    VectorXd f;
    model.force(x, f);
    EXPECT_LT((-moment(x.q, f) - c.moment).norm(), 1e-14) << c.edge;
  }
}

TEST(Loads, RefuseWhatTheyCannotDo) {
  const AncfPlate flat(2, ShapeSet::h16, testing::uniform_lines(0, 1, 1),
                       testing::uniform_lines(0, 1, 1));
  const auto refused = [](const std::unique_ptr<Term>& term, const Element& element) {
    try {
      term->prepare(element, {}, true);
      return false;
    } catch (const Error& error) {
      return error.kind() == Error::Kind::input;
    }
  };
  EXPECT_TRUE(refused(make_pressure(1), flat));
  EXPECT_TRUE(refused(make_edge_moment("root", 1), flat));
  EXPECT_TRUE(refused(make_point_force({0.5, 0.5}, vector(1, 0, 0)), flat));
  EXPECT_TRUE(refused(make_point_force({1.5, 0.5}, Vec2(1, 0)), flat));
  EXPECT_TRUE(refused(make_edge_load("top", Vec2(1, 0)), flat));
  EXPECT_TRUE(refused(make_edge_load("root", Vec2(1, 0)), testing::swinging_plate(ShapeSet::h16)));
  EXPECT_FALSE(refused(make_surface_load(Vec2(1, 0)), flat));
}

}  // namespace
}  // namespace flexmorph::fem
