// Shows that six-node triangles pass the patch test, represent bending exactly, serve all clamps by
// one factor and have the right recovered stress.

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <vector>

#include "fem/triangles/recovered_stress.h"
#include "fem/triangles/t6.h"
#include "fem/triangles/triangle_plate.h"

namespace flexmorph::fem {
namespace {

const PlaneSection kSteel{0.02, 200e9, 0.3, 7800};

/// Returns an irregular mesh of 3 x 1 that is finer at one corner, with the given lines across.
PartMesh plate_mesh(std::span<const double> lines = {}) {
  const std::vector<Region> plate = {{{{0, 0}, {3, 0}, {3, 1}, {0, 1}}, {}}};
  std::vector<Segment> across;
  for (const double x : lines) across.push_back({{x, -1}, {x, 2}});
  SizeField sizes({{0, 0}, {3, 1}}, 0.5);
  sizes.refine({0.2, 0.8}, 0.5, 0.15);
  PartMesher mesher(plate, across);
  mesher.refine(sizes);
  return mesher.mesh();
}

/// Returns the nodal values of a field (2 n_nodes).
VectorXd nodal(const PartMesh& mesh, const std::function<Vec2(const Vec2&)>& field) {
  VectorXd out(2 * static_cast<Eigen::Index>(mesh.points.size()));
  for (Eigen::Index k = 0; k < out.size() / 2; ++k)
    out.segment<2>(2 * k) = field(mesh.point(static_cast<int>(k)));
  return out;
}

/// Returns K u of all triangles.
VectorXd forces_of(const PartMesh& mesh, const VectorXd& u) {
  VectorXd out = VectorXd::Zero(u.size());
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    Eigen::Matrix<double, 12, 1> local;
    for (int a = 0; a < 6; ++a)
      local.segment<2>(2 * a) = u.segment<2>(2 * mesh.triangles[t][static_cast<std::size_t>(a)]);
    const Eigen::Matrix<double, 12, 1> f = T6(mesh.corners(t)).stiffness(kSteel) * local;
    for (int a = 0; a < 6; ++a)
      out.segment<2>(2 * mesh.triangles[t][static_cast<std::size_t>(a)]) += f.segment<2>(2 * a);
  }
  return out;
}

bool is_inside(const Vec2& p) {
  return p.x() > 1e-9 && p.x() < 3 - 1e-9 && p.y() > 1e-9 && p.y() < 1 - 1e-9;
}

TEST(SixNodeTriangle, ShapesAreOneAtTheirNodesAndSumToOne) {
  const std::array<AreaPoint, 6> nodes = {
      {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {.5, .5, 0}, {0, .5, .5}, {.5, 0, .5}}};
  for (int k = 0; k < 6; ++k)
    for (int j = 0; j < 6; ++j)
      EXPECT_EQ(t6_shapes(nodes[static_cast<std::size_t>(k)])[j], k == j ? 1 : 0);
  for (const WeightedPoint& w : six_points()) EXPECT_NEAR(t6_shapes(w.at).sum(), 1, 1e-14);
}

// The exact values contain factorials: ∫ L0^a L1^b L2^c dA = 2 A a! b! c! / (a + b + c + 2)!
TEST(SixNodeTriangle, RulesIntegratePolynomialsExactly) {
  const auto factorial = [](int n) { return std::tgamma(n + 1.0); };
  for (int a = 0; a <= 4; ++a)
    for (int b = 0; a + b <= 4; ++b) {
      double six = 0, three = 0;
      for (const WeightedPoint& w : six_points())
        six += w.weight * std::pow(w.at[0], a) * std::pow(w.at[1], b);
      for (const AreaPoint& p : kThreePoints) three += std::pow(p[0], a) * std::pow(p[1], b) / 3;
      const double exact = 2 * factorial(a) * factorial(b) / factorial(a + b + 2);
      EXPECT_NEAR(six, exact, 1e-14);
      if (a + b <= 2) {
        EXPECT_NEAR(three, exact, 1e-15);
      }
    }
}

// Patch test: a constant strain gives no force on inner nodes.
TEST(SixNodeTriangle, PassesThePatchTest) {
  const PartMesh mesh = plate_mesh();
  const VectorXd u = nodal(mesh, [](const Vec2& p) {
    return Vec2(1e-3 * p.x() + 2e-3 * p.y(), -4e-4 * p.x() + 5e-4 * p.y());
  });
  const VectorXd f = forces_of(mesh, u);
  const double scale = f.lpNorm<Eigen::Infinity>();
  for (std::size_t k = 0; k < mesh.points.size(); ++k) {
    if (!is_inside(mesh.points[k])) continue;
    EXPECT_LE(f.segment<2>(2 * static_cast<Eigen::Index>(k)).norm(), 1e-12 * scale);
  }
}

// Pure bending, σ₁₁ = E κ (y - 1/2), is a quadratic field; it has no force on inner nodes and on
// the long edges.
TEST(SixNodeTriangle, BendsWithoutAnError) {
  const PartMesh mesh = plate_mesh();
  const double nu = kSteel.poisson_ratio, curvature = 1e-3;
  const VectorXd u = nodal(mesh, [&](const Vec2& p) {
    const double y = p.y() - 0.5;
    return Vec2(curvature * p.x() * y, -0.5 * curvature * (p.x() * p.x() + nu * y * y));
  });
  const VectorXd f = forces_of(mesh, u);
  const double scale = f.lpNorm<Eigen::Infinity>();
  for (std::size_t k = 0; k < mesh.points.size(); ++k) {
    const Vec2& p = mesh.points[k];
    if (p.x() < 1e-9 || p.x() > 3 - 1e-9) continue;
    EXPECT_LE(f.segment<2>(2 * static_cast<Eigen::Index>(k)).norm(), 1e-12 * scale);
  }
  // The expected value is two times the energy: E I κ² L.
  EXPECT_NEAR(u.dot(f), 200e9 * 0.02 / 12 * curvature * curvature * 3, 1e-10 * u.dot(f));
}

/// Returns the nodal forces of unit tension at the right edge (n_unknowns).
VectorXd tension(const TrianglePlate& plate) {
  const PartMesh& mesh = plate.mesh();
  VectorXd out = VectorXd::Zero(plate.n_unknowns());
  for (const auto& t : mesh.triangles)
    for (std::size_t k = 0; k < 3; ++k) {
      const int a = t[k], b = t[(k + 1) % 3];
      if (mesh.point(a).x() < 3 - 1e-9 || mesh.point(b).x() < 3 - 1e-9) continue;
      const double length = (mesh.point(b) - mesh.point(a)).norm();
      for (const auto& [node, share] :
           {std::pair(a, 1. / 6), std::pair(b, 1. / 6), std::pair(t[3 + k], 4. / 6)})
        out[plate.row(node, 0)] += share * length;
    }
  return out;
}

TEST(TrianglePlate, TensionIsExactAndHasNoEstimatedError) {
  const PartMesh mesh = plate_mesh();
  TrianglePlateSupports supports;
  for (int k = 0; k < static_cast<int>(mesh.points.size()); ++k) {
    if (mesh.point(k).x() > 1e-12) continue;
    supports.held.push_back({k, 0});
    if (mesh.point(k).y() < 1e-12) supports.held.push_back({k, 1});
  }
  TrianglePlate plate(mesh, kSteel, supports);
  plate.factorize();
  const VectorXd f = tension(plate);
  MatrixXd u = f.transpose();
  plate.solve(u, std::vector<int>{0});
  const double exact = 3 / (200e9 * 0.02);  // F L / (E A) with F = 1 and A = 0.02
  EXPECT_NEAR(u.row(0).dot(f), exact, 1e-10 * exact);
  const auto found = RecoveredStress(plate).evaluate(u, std::vector<int>{0});
  EXPECT_NEAR(found.energies[0], exact, 1e-10 * exact);
  EXPECT_LE(found.errors[0], 1e-16 * exact);
  for (Eigen::Index k = 0; k < found.stress.cols(); ++k) {
    EXPECT_NEAR(found.stress(0, k), 50, 1e-7);  // F / A
    EXPECT_NEAR(found.averaged(0, k), 50, 1e-7);
    EXPECT_NEAR(von_mises(found.stress.col(k)), 50, 1e-7);
  }
}

// One factor serves all clamps: each row of results must equal the plate with that clamp alone.
TEST(TrianglePlate, ClampsAreLeadingBlocks) {
  const std::vector<double> lines = {2.2, 1.5, 0.4, 0};
  const PartMesh mesh = plate_mesh(lines);
  TrianglePlate all(mesh, kSteel, {{}, lines, 1e-9, {}});
  all.factorize();
  MatrixXd loads(5, all.n_unknowns());
  const std::vector<int> clamps = {0, 1, 1, 2, 3};
  const VectorXd f = tension(all);
  for (int l = 0; l < 5; ++l) loads.row(l) = (1 + l) * f.transpose();
  MatrixXd u = loads;
  all.solve(u, clamps);
  const auto stress = RecoveredStress(all).evaluate(u, clamps);
  for (int l = 0; l < 5; ++l) {
    const double x = lines[static_cast<std::size_t>(clamps[static_cast<std::size_t>(l)])];
    TrianglePlateSupports held;
    for (int k = 0; k < static_cast<int>(mesh.points.size()); ++k)
      if (mesh.point(k).x() <= x + 1e-9)
        for (int c = 0; c < 2; ++c) held.held.push_back({k, c});
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
      const auto [a, b, c] = mesh.corners(t);
      held.left_out.push_back((a + b + c).x() / 3 < x);
    }
    TrianglePlate one(mesh, kSteel, held);
    one.factorize();
    MatrixXd v = (1 + l) * tension(one).transpose();
    one.solve(v, std::vector<int>{0});
    double largest = 0;
    for (int k = 0; k < static_cast<int>(mesh.points.size()); ++k)
      for (int c = 0; c < 2; ++c) {
        const double here = one.row(k, c) < 0 ? 0 : v(0, one.row(k, c));
        const double there = all.row(k, c) < 0 ? 0 : u(l, all.row(k, c));
        largest = std::max(largest, std::abs(here - there));
      }
    EXPECT_LE(largest, 1e-11 * v.lpNorm<Eigen::Infinity>()) << "clamped at " << x;
    const auto own = RecoveredStress(one).evaluate(v, std::vector<int>{0});
    EXPECT_NEAR(stress.energies[l], own.energies[0], 1e-10 * own.energies[0]);
    EXPECT_NEAR(stress.errors[l], own.errors[0], 1e-7 * own.energies[0]);
  }
}

TEST(TrianglePlate, RefusesAPlateThatNothingHolds) {
  const PartMesh mesh = plate_mesh();
  TrianglePlate plate(mesh, kSteel, {});
  try {
    plate.factorize();
    FAIL() << "a free plate has a factor";
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), Error::Kind::numerical);
  }
}

}  // namespace
}  // namespace flexmorph::fem
