// Shows the effect of splitting and merging moving elements of a plate in space: an inserted line
// of h16 nodes changes neither position nor velocity anywhere, nor energy; a removed line changes
// the position by the error of cubic interpolation over the longer element, h⁴/384 max |∂⁴r/∂m⁴|.
#include <gtest/gtest.h>

#include <cmath>
#include <optional>

#include "fem/dynamics/motion.h"
#include "fem/terms.h"
#include "tests/support/space_plates.h"

namespace flexmorph::fem {
namespace {

using testing::ShapeSet;

const PlaneSection kSoftPlate{0.01, 1e7, 0.3, 2700};

/// Returns a plate that slides out of a hub at 0.3 m/s, with the boundary element `first` and `n`
/// others of `length`. With `free_root` the root line is free.
Workspace plate(double first, double length, int n, int bending_points = 5,
                bool free_root = false) {
  std::vector<MaterialLine> m = {{0, [first](double t) {
                                    return Motion{-first - 0.3 * t, -0.3, 0};
                                  }}};
  if (free_root) m[0] = {-first, {}, true};
  for (int i = 0; i <= n; ++i) m.push_back({length * i, {}});
  std::vector<std::unique_ptr<Term>> terms;
  terms.push_back(make_membrane(kSoftPlate));
  terms.push_back(make_bending(kSoftPlate, bending_points));
  terms.push_back(make_inertia(kSoftPlate));
  Workspace model;
  model.add_body("plate",
                 std::make_unique<AncfPlate>(3, ShapeSet::h16, std::move(m),
                                             testing::uniform_lines(0, 0.1, 2)),
                 kSoftPlate, std::move(terms));
  return model;
}

struct Field {
  Vec3 position, velocity;
};
Field field_at(const Model& model, const State& x, const Vec2& material) {
  const Body& body = model.bodies()[0];
  ShapeTable t;
  const auto vectors =
      body.element->vectors(body.element->locate(material, Tabulate::position_rates, t));
  Field out{Vec3::Zero(), Vec3::Zero()};
  for (size_t k = 0; k < vectors.size(); ++k) {
    const auto i = static_cast<Eigen::Index>(k);
    const Vec3 q = x.q.segment<3>(3 * vectors[k]), v = x.v.segment<3>(3 * vectors[k]);
    out.position += t.N(0, i) * q;
    out.velocity += t.N(0, i) * v;
    if (t.N_t.size() > 0) out.velocity += t.N_t(0, i) * q;
  }
  return out;
}

std::vector<Vec2> points(double from, double to) {
  std::vector<Vec2> out;
  for (int i = 0; i <= 60; ++i)
    for (int j = 0; j <= 8; ++j) out.push_back({from + (to - from) * i / 60, 0.1 * j / 8});
  return out;
}

double largest(const VectorXd& x) { return x.lpNorm<Eigen::Infinity>(); }

/// Returns the relative jump of the strain energy by an insertion and tests all other jumps.
double insertion(int bending_points, bool free_root = false) {
  Workspace model = plate(0.12, 0.08, 3, bending_points, free_root);
  model.prepare(0);
  const State rest = model.reference();
  State x = testing::SmoothMotion(rest.q, 0.02 * model.scales().cwiseInverse(), 5).state(0);
  if (free_root) x.q[x.q.size() - 1] = -0.12;  // points() begins at this line
  x.lambda = rest.lambda;
  model.prepare(x);
  const Energies before = model.energies(x);
  const Vec3 momentum = model.momentum(x);
  std::vector<Field> fields;
  for (const Vec2& at : points(-0.12, 0.24)) fields.push_back(field_at(model, x, at));
  change_mesh(model, model.bodies()[0], MeshChange::insertion, x);
  const Energies after = model.energies(x);
  EXPECT_NEAR(grid_of(model.bodies()[0]).line_m(1).value, -0.06, 1e-15);
  size_t i = 0;
  for (const Vec2& at : points(-0.12, 0.24)) {
    const Field f = field_at(model, x, at);
    EXPECT_LT((f.position - fields[i].position).norm(), 1e-12);
    EXPECT_LT((f.velocity - fields[i].velocity).norm(), 1e-12 * largest(x.v));
    ++i;
  }
  EXPECT_NEAR(after.kinetic, before.kinetic, 1e-12 * before.kinetic);
  EXPECT_LT((model.momentum(x) - momentum).norm(), 1e-12 * momentum.norm());
  return std::abs(after.strain / before.strain - 1);
}

// The bending energy is rational, and quadrature over two halves differs from quadrature over the
// whole element; therefore the jump is the error of the quadrature.
TEST(InsertionInSpace, ChangesNothing) {
  const double five = insertion(5), nine = insertion(9);
  std::printf("jump of the strain energy: %.1e with 5 points each way, %.1e with 9\n", five, nine);
  EXPECT_LT(five, 1e-7);
  EXPECT_LT(nine, 1e-10);
}

// An insertion next to a free root line must not change its position, rate and acceleration.
TEST(InsertionInSpace, BesideAFreeRootLineChangesNothing) {
  const double five = insertion(5, true), nine = insertion(9, true);
  std::printf("jump of the strain energy: %.1e with 5 points each way, %.1e with 9\n", five, nine);
  EXPECT_LT(five, 1e-7);
  EXPECT_LT(nine, 1e-10);
}

TEST(RemovalInSpace, BesideAFreeRootLineUndoesAnInsertion) {
  Workspace model = plate(0.12, 0.08, 3, 5, true);
  const State rest = model.reference();
  State x = testing::SmoothMotion(rest.q, 0.02 * model.scales().cwiseInverse(), 5).state(0);
  model.prepare(x);
  const State before = x;
  change_mesh(model, model.bodies()[0], MeshChange::insertion, x);
  const auto scalar = x.q.size() - 1;
  EXPECT_EQ(model.bodies()[0].first_scalar(), scalar);
  EXPECT_EQ(grid_of(model.bodies()[0]).line_m(0).rate, before.v[before.v.size() - 1]);
  EXPECT_EQ(grid_of(model.bodies()[0]).line_m(0).acceleration, before.a[before.a.size() - 1]);
  change_mesh(model, model.bodies()[0], MeshChange::removal, x);
  EXPECT_EQ((x.q - before.q).norm() + (x.v - before.v).norm() + (x.a - before.a).norm(), 0);
}

// With limits of 0.1 and 0.03 m the change depends on the position of the free line, and insertion
// and removal do not alternate.
TEST(ChangeDue, FollowsTheFreeRootLine) {
  Workspace model = plate(0.05, 0.05, 3, 5, true);
  MovingRoot growth{"plate", [](double) { return FrameMotion{}; }, 0.1, 0.03};
  const auto due = [&](double root) {
    State x = model.reference();
    x.q[x.q.size() - 1] = root;
    model.prepare(x);
    return change_due(model.bodies()[0], growth);
  };
  EXPECT_EQ(due(-0.0999), std::nullopt);
  EXPECT_EQ(due(-0.1001), MeshChange::insertion);
  EXPECT_EQ(due(-0.0301), std::nullopt);
  EXPECT_EQ(due(-0.0299), MeshChange::removal);
  growth.max_length = 0.085;  // 0.0799 is above 0.9 of it
  EXPECT_EQ(due(-0.0299), std::nullopt);
  growth.line = 1;
  EXPECT_EQ(due(-0.2), std::nullopt);
  Workspace driven = plate(0.2, 0.05, 3);
  EXPECT_EQ(change_due(driven.bodies()[0], {"plate", growth.hub}), std::nullopt);
}

/// Returns r(m, n) of an arched, twisted, stretched plate.
Vec3 shape(double m, double n) {
  return {m + 0.02 * std::sin(7 * m), n + 0.01 * std::cos(9 * m), 0.05 * std::sin(8 * m) + m * n};
}
/// Upper bound of |∂⁴r/∂m⁴| of shape().
constexpr double kFourth = 0.02 * 2401 + 0.01 * 6561 + 0.05 * 4096;

/// Returns the largest change of the position by a removal for elements of the given length.
double removal(double h) {
  Workspace model = plate(h, h, 3);
  model.prepare(0);
  State x = model.reference();
  const LineGrid& grid = grid_of(model.bodies()[0]);
  const double d = 1e-3;
  for (int i = 0; i <= grid.n_m(); ++i)
    for (int j = 0; j <= grid.n_n(); ++j) {
      const double m = grid.line_m(i).value, n = grid.line_n(j).value;
      const auto first = 3 * grid.per_node() * grid.node(i, j);
      const auto by_m = [&](double at) {
        return Vec3((8 * (shape(m + d, at) - shape(m - d, at)) -
                     (shape(m + 2 * d, at) - shape(m - 2 * d, at))) /
                    (12 * d));
      };
      x.q.segment<3>(first) = shape(m, n);
      x.q.segment<3>(first + 3) = by_m(n);
      x.q.segment<3>(first + 6) = (shape(m, n + d) - shape(m, n - d)) / (2 * d);
      x.q.segment<3>(first + 9) = (by_m(n + d) - by_m(n - d)) / (2 * d);
    }
  std::vector<Vec3> before;
  for (const Vec2& at : points(-h, 3 * h)) before.push_back(field_at(model, x, at).position);
  change_mesh(model, model.bodies()[0], MeshChange::removal, x);
  double jump = 0;
  size_t i = 0;
  for (const Vec2& at : points(-h, 3 * h))
    jump = std::max(jump, (field_at(model, x, at).position - before[i++]).norm());
  return jump;
}

TEST(RemovalInSpace, JumpsByTheInterpolationError) {
  const double coarse = removal(0.05), fine = removal(0.025);
  std::printf("jump %.2e m, bound %.2e m; half the size: %.2e m\n", coarse,
              std::pow(0.1, 4) / 384 * kFourth, fine);
  EXPECT_LT(coarse, std::pow(0.1, 4) / 384 * kFourth);
  EXPECT_LT(fine, std::pow(0.05, 4) / 384 * kFourth);
  EXPECT_NEAR(std::log2(coarse / fine), 4, 0.3);
}

}  // namespace
}  // namespace flexmorph::fem
