// Shows that equivalent static loads of the kind `inertia` on the design mesh reproduce the
// deflection of the dynamic run, within 6 % of the largest deflection at every load time. The
// difference is centrifugal stiffening, which linear statics does not contain: it has one sign and
// falls with the square of the angular velocity.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>

#include "fem/dynamics/esl.h"
#include "fem/dynamics/motion.h"
#include "fem/solve/static_solver.h"
#include "tests/support/models.h"

namespace flexmorph::fem {
namespace {

using testing::RotatingPlate;

struct Deflections {
  std::vector<double> time, dynamic, statics;
  double largest() const {
    double out = 0;
    for (const double d : dynamic) out = std::max(out, std::abs(d));
    return out;
  }
  /// Returns the largest difference relative to the largest deflection.
  double difference() const {
    double out = 0;
    for (size_t i = 0; i < time.size(); ++i) out = std::max(out, std::abs(statics[i] - dynamic[i]));
    return out / largest();
  }
  /// Returns the slope of the line statics = (1 + slope) dynamic through the origin.
  double excess() const {
    double sd = 0, dd = 0;
    for (size_t i = 0; i < time.size(); ++i) {
      sd += statics[i] * dynamic[i];
      dd += dynamic[i] * dynamic[i];
    }
    return sd / dd - 1;
  }
  void print(const char* name) const {
    std::printf("%s: difference %.2f %% of %.4e m, static / dynamic - 1 = %.2f %%\n", name,
                100 * difference(), largest(), 100 * excess());
    for (size_t i = 0; i < time.size(); ++i)
      std::printf("  t = %.2f  dynamic %+.4e  static %+.4e  difference %+.2f %%\n", time[i],
                  dynamic[i], statics[i], 100 * (statics[i] - dynamic[i]) / largest());
  }
};

/// Returns F = -M a + f on the design mesh with full material.
MatrixXd forces(const std::vector<EslSet>& sets, const StaticSolver& solver,
                const PlaneSection& section) {
  const Grid& g = solver.grid();
  const Eigen::Matrix4d mass = q4_mass(section, g.dx(), g.dy());
  MatrixXd out = MatrixXd::Zero(static_cast<Eigen::Index>(sets.size()), solver.n_unknowns());
  for (size_t l = 0; l < sets.size(); ++l) {
    VectorXd f = VectorXd::Zero(2 * g.n_nodes());
    for (int i = 0; i < g.nx; ++i)
      for (int j = 0; j < g.ny; ++j)
        for (size_t p = 0; p < 4; ++p)
          for (size_t r = 0; r < 4; ++r)
            f.segment<2>(2 * g.node(i + kCornerI[p], j + kCornerJ[p])) -=
                mass(static_cast<Eigen::Index>(p), static_cast<Eigen::Index>(r)) *
                sets[l].acceleration.segment<2>(2 * g.node(i + kCornerI[r], j + kCornerJ[r]));
    for (const NodalForce& point : sets[l].forces) f.segment<2>(2 * point.node) += point.force;
    for (int i = 0; i <= g.nx; ++i)
      for (int j = 0; j <= g.ny; ++j)
        if (const int row = solver.row(g.node(i, j), 0); row >= 0)
          out.row(static_cast<Eigen::Index>(l)).segment<2>(row) = f.segment<2>(2 * g.node(i, j));
  }
  return out;
}

Deflections compare(double omega, double step) {
  RotatingPlate p;
  p.omega = omega;
  p.nx = 20;
  p.ny = 4;
  testing::Scene scene = testing::make_scene(p);
  const Grid grid{0, -p.width() / 2, p.whole(), p.width(), 240, 40};
  const AttachedMass tip{p.tip_mass, p.tip()};
  MotionSettings settings;
  settings.step = step;
  for (int k = 1; k <= 20; ++k) settings.stops.push_back(0.05 * k);
  std::vector<EslSet> sets;
  integrate(scene.model, scene.moving_roots, settings, [&](const MotionStep& s) {
    if (s.stop)
      sets.push_back(
          equivalent_static_load(s.model, s.x, scene.moving_roots[0], grid, {&tip, 1}, {}, {}));
  });
  StaticSolver solver(grid, p.section);
  solver.factorize(VectorXd::Ones(grid.n_cells()));
  MatrixXd u = forces(sets, solver, p.section);
  std::vector<int> roots;
  for (const EslSet& set : sets) roots.push_back(set.root_column);
  solver.solve(u, roots);
  Deflections out;
  for (size_t l = 0; l < sets.size(); ++l) {
    const int i = grid.nx, j = grid.ny / 2;
    out.time.push_back(sets[l].time);
    out.dynamic.push_back(sets[l].deformation[2 * grid.node(i, j) + 1]);
    out.statics.push_back(u(static_cast<Eigen::Index>(l), solver.row(grid.node(i, j), 1)));
  }
  return out;
}

TEST(InertiaLoads, ReproduceTheDynamicDeflection) {
  const double omega = 2 * std::numbers::pi;
  const Deflections full = compare(omega, 1e-3), quarter = compare(omega / 4, 2e-3);
  full.print("omega");
  quarter.print("omega / 4");
  ASSERT_EQ(full.time.size(), 20u);
  EXPECT_LT(full.difference(), 0.06);
  // The centrifugal tension makes the plate stiffer than its linear statics at all times; a quarter
  // of the angular velocity gives a sixteenth of the tension. The remaining difference is that of
  // the two meshes.
  EXPECT_GT(full.excess(), 0.01);
  EXPECT_NEAR(quarter.excess() / full.excess(), 1.0 / 16, 0.06);
  EXPECT_LT(quarter.difference(), 0.01);
}

}  // namespace
}  // namespace flexmorph::fem
