// Shows that shipped scenes, some on coarser meshes, have the same solution with this program's
// integrator and with IDA of SUNDIALS, an independent integrator of another family: positions,
// velocities and multipliers at the end of intervals without changes of a mesh. Each integrator has
// an error estimate: for IDA the change caused by ten times its tolerance, for generalized_alpha
// the change of the extrapolated value if it is made from steps h / 2, h / 4 instead of h, h / 2.
// The difference must be below the sum of both estimates (that of IDA times 3), and this sum must
// be small.
#include <gtest/gtest.h>

#include <cmath>
#include <iostream>
#include <limits>

#include "cases/assembly/build.h"
#include "fem/dynamics/starts/start.h"
#include "tests/cases/scenes.h"
#include "tests/support/ida.h"

namespace flexmorph::cases {
namespace {

/// The start of an interval. Jumps of the mesh or of the crank's velocity excite vibrations that no
/// reasonable step resolves, and extrapolation estimates only errors of resolved motions. Therefore
/// ten steps with rho_inf = 0 damp these vibrations first.
enum class From { start, after_start, after_first_change };

struct Interval {
  std::string scene;
  Changes changes;   // changes of the scene
  double longest;    // [s]
  int steps;         // number of steps of generalized_alpha, coarsest level
  double tolerance;  // finer tolerance of IDA
  From from = From::start;
};

/// Returns the time of the next change of the mesh of any body after t; infinity if there is none.
double next_change(const Mechanism& m, double t) {
  double out = std::numeric_limits<double>::infinity();
  for (const fem::MovingRoot& g : m.moving_roots)
    out =
        std::min(out, fem::next_change(m.model.body(g.body), g, t, m.motion.end, m.motion.step).t);
  return out;
}

fem::State begin(Mechanism& m, From from) {
  fem::MotionSettings s = m.motion;
  fem::State x;
  if (from == From::start) {
    x = fem::start_state(m.model, m.moving_roots, 0, s.start, s.body_poses);
  } else {
    m.model.prepare(0);
    s.alpha.rho_inf = 0;
    s.end = (from == From::after_first_change ? next_change(m, 0) : 0) + 10 * s.step;
    x = fem::integrate(m.model, m.moving_roots, s, [](const fem::MotionStep&) {}).final;
  }
  const auto scheme = fem::make_integrator(m.model, {s.integrator, s.alpha, {}, {}});
  scheme->project_velocity(x);
  scheme->make_consistent(x);
  return x;
}

/// Unknowns scaled to displacements [m] and velocities [m/s], and unscaled multipliers.
struct End {
  VectorXd q, v, lambda;
  End operator-(const End& o) const { return {q - o.q, v - o.v, lambda - o.lambda}; }
  static double most(const VectorXd& x) { return x.size() ? x.lpNorm<Eigen::Infinity>() : 0.0; }
};
End end_of(const fem::Model& model, const fem::State& x) {
  const VectorXd s = model.scales();
  return {x.q.cwiseProduct(s), x.v.cwiseProduct(s), x.lambda};
}

End extrapolated(const End& coarse, const End& fine) {
  return {(4 * fine.q - coarse.q) / 3, (4 * fine.v - coarse.v) / 3,
          (4 * fine.lambda - coarse.lambda) / 3};
}

/// The common values at the end of an interval, the difference of both integrators, and their error
/// estimates.
struct Verdict {
  End end, difference, ida, alpha;
};

Verdict verify(const Interval& interval) {
  Mechanism m = build_mechanism(read(interval.scene, interval.changes));
  const fem::State start = begin(m, interval.from);
  m.model.prepare(start.t);
  const double until = std::min(start.t + interval.longest, next_change(m, start.t));
  const auto by_alpha = [&](int n) {
    fem::AlphaSettings settings = m.motion.alpha;
    settings.tolerance = 1e-13;
    const auto scheme = fem::make_integrator(m.model, {"generalized_alpha", settings, {}, {}});
    fem::State x = start;
    scheme->make_consistent(x);
    for (int k = 1; k <= n; ++k)
      scheme->advance(x, start.t + (until - start.t) * k / n, [](const fem::State&) {});
    return end_of(m.model, x);
  };
  const int n = interval.steps;
  const End coarse = by_alpha(n), middle = by_alpha(2 * n), fine = by_alpha(4 * n);
  const End alpha = extrapolated(middle, fine);

  const End first = end_of(m.model, start);
  testing::IdaSettings settings;
  settings.size = End::most(first.q);
  settings.speed = std::max(End::most(first.v), End::most(alpha.v));
  testing::IdaCounts counts;
  const auto by_ida = [&](double tolerance) {
    settings.tolerance = tolerance;
    const double times[] = {until};
    return end_of(m.model, testing::solve_by_ida(m.model, start, times, settings, &counts).back());
  };
  const End loose = by_ida(10 * interval.tolerance), ida = by_ida(interval.tolerance);
  Verdict out{alpha, ida - alpha, ida - loose, alpha - extrapolated(coarse, middle)};
  std::cout << interval.scene << ", " << start.t << " to " << until << " s: IDA " << counts.steps
            << " steps, " << counts.residuals << " residuals, " << counts.jacobians
            << " Jacobians; generalized_alpha " << 4 * n << " steps, off by "
            << End::most((fine - alpha).q) << " m without extrapolation\n";
  const auto row = [](const char* what, double size, double d, double i, double a) {
    std::cout << "  " << what << " of " << size << ": difference " << d << ", IDA " << i
              << ", extrapolation " << a << '\n';
  };
  row("positions", settings.size, End::most(out.difference.q), End::most(out.ida.q),
      End::most(out.alpha.q));
  row("velocities", settings.speed, End::most(out.difference.v), End::most(out.ida.v),
      End::most(out.alpha.v));
  row("multipliers", End::most(alpha.lambda), End::most(out.difference.lambda),
      End::most(out.ida.lambda), End::most(out.alpha.lambda));
  return out;
}

/// Expects that the error estimates explain the difference and are small compared with the motion.
/// An estimate from two levels is multiplied by 3 (Roache 1994, J. Fluids Eng. 116, 405-413). Here
/// this is the estimate of IDA: its velocities of the platform improve only by a factor of two with
/// a tenth of the tolerance, so that the difference of two runs is about as large as their error,
/// slightly more or less depending on round-off.
void expect_agreement(const Verdict& v, double multipliers) {
  const auto expect = [](const char* what, const VectorXd& end, const VectorXd& difference,
                         const VectorXd& ida, const VectorXd& alpha, double part) {
    const double by_ida = End::most(ida), by_alpha = End::most(alpha);
    EXPECT_LT(End::most(difference), 3 * by_ida + by_alpha) << what;
    EXPECT_LT(by_ida + by_alpha, part * End::most(end)) << what;
  };
  expect("positions", v.end.q, v.difference.q, v.ida.q, v.alpha.q, 1e-6);
  expect("velocities", v.end.v, v.difference.v, v.ida.v, v.alpha.v, 1e-3);
  expect("multipliers", v.end.lambda, v.difference.lambda, v.ida.lambda, v.alpha.lambda,
         multipliers);
}

TEST(SecondIntegrator, PlatePendulum) {
  expect_agreement(verify({"plate_pendulum", {"body.elements=[2, 2]"}, 0.2, 1000, 1e-9}), 1e-6);
}

/// Changes that give a coarse plate. One test covers the time from the start to the first change of
/// the mesh at 0.05 s, another the time after it.
Changes coarse_plate(const std::string& max_length) {
  return {"body.elements=[4, 1]", "body.flow.max_length=" + max_length};
}
TEST(SecondIntegrator, RotatingPlateSlow) {
  expect_agreement(verify({"rotating_plate_v01", coarse_plate("0.13"), 0.05, 1000, 1e-8}), 1e-3);
}
TEST(SecondIntegrator, RotatingPlateSlowAfterInsertion) {
  expect_agreement(verify({"rotating_plate_v01", coarse_plate("0.13"), 0.05, 1500, 1e-8,
                           From::after_first_change}),
                   1e-3);
}
TEST(SecondIntegrator, RotatingPlateFast) {
  expect_agreement(verify({"rotating_plate_v05", coarse_plate("0.15"), 0.05, 1500, 1e-8}), 1e-3);
}
TEST(SecondIntegrator, RotatingPlateFastBetweenInsertions) {
  expect_agreement(verify({"rotating_plate_v05", coarse_plate("0.15"), 0.2, 600, 1e-8,
                           From::after_first_change}),
                   1e-3);
}

// The unknowns contain the pose of the platform, the forces of joints and drives, and the bars.
const Changes kCoarseBars = {"body.bar1.elements=[2, 1]", "body.bar1.flow.max_length=0.32",
                             "body.bar2.elements=[3, 1]", "body.bar2.flow.max_length=0.32"};
TEST(SecondIntegrator, MotionPlatform) {
  expect_agreement(verify({"motion_platform", kCoarseBars, 0.01, 300, 1e-8}), 1e-3);
}
TEST(SecondIntegrator, MotionPlatformAfterInsertion) {
  expect_agreement(
      verify({"motion_platform", kCoarseBars, 0.01, 300, 1e-8, From::after_first_change}), 1e-3);
}

// The interval contains the whole rise of the temperature and a little time before and after it.
// The quintic profile has no jump of the second derivative, which would be a jump of accelerations.
TEST(SecondIntegrator, HeatedSliderCrank) {
  const Changes quick = {"body.heat.start=0.015", "body.heat.duration=0.08",
                         "body.heat.profile=quintic"};
  expect_agreement(verify({"slider_crank_heated", quick, 0.1, 1000, 3e-9, From::after_start}),
                   1e-3);
}

}  // namespace
}  // namespace flexmorph::cases
