// Prints the CPU time of one MMA subproblem: worst cases over m - 1 loads with a volume constraint,
// for the numbers of variables of the shipped cases; and of the KKT residual of the same rows,
// which every iteration computes, too. One thread. It checks nothing.

#include <cmath>
#include <cstdio>
#include <random>

#include "optim/kkt.h"
#include "optim/mma_subproblem.h"
#include "tests/benchmark/cpu.h"
#include "tests/benchmark/reference.h"

namespace {

using namespace flexmorph;
using namespace flexmorph::benchmark;

constexpr double kDemanded = 5;                  // [ms]
constexpr double kDistance = 0.1, kMove = 0.05;  // of the asymptotes, of the bounds

/// Returns log C_l - bound <= 0 for smoothly varying loads, V - 1 <= 0; the bound is the last
/// variable.
/// @param spread  range of log C_l: with a small one more loads are near the worst
optim::ProblemValues worst_case(int n, int m, double spread) {
  std::mt19937 generator(static_cast<unsigned>(n + m));
  std::normal_distribution<double> normal;
  constexpr int kShapes = 8;
  MatrixXd shapes(n, kShapes);
  for (double& s : shapes.reshaped()) s = 0.02 * normal(generator);
  optim::ProblemValues r;
  r.f = 0;
  r.df = VectorXd::Zero(n);
  r.g = VectorXd::Zero(m);
  r.dg.resize(m, n);
  for (int i = 0; i < m; ++i) {
    const double t = m > 1 ? i / (m - 1.0) : 0;
    for (int j = 0; j < n; ++j) {
      r.dg(i, j) = -std::abs(shapes(j, 0));
      for (int k = 1; k < kShapes; ++k) r.dg(i, j) += 0.5 * shapes(j, k) * std::cos(3 * k * t);
    }
    r.g[i] = -spread * (1 + std::cos(9 * t)) / 2;
  }
  r.dg.row(m - 1) = 0.5 * shapes.col(0).cwiseAbs().transpose();  // volume
  r.g[m - 1] = 0;
  if (m == 1) {
    r.df = -shapes.col(1).cwiseAbs();
  } else {
    r.dg.col(n - 1).setConstant(-10);
    r.dg(m - 1, n - 1) = 0;
    r.df[n - 1] = 10;
  }
  return r;
}

/// Returns the subproblem that mma builds with its default settings.
optim::MmaSubproblem subproblem(const optim::ProblemValues& r) {
  constexpr double kConvexity = 0.01, kScale = 10, kPrice = 1000;
  const Eigen::Index n = r.df.size(), m = r.g.size();
  optim::MmaSubproblem p;
  p.low = VectorXd::Constant(n, -kDistance);
  p.upp = VectorXd::Constant(n, kDistance);
  p.alpha = VectorXd::Constant(n, -kMove);
  p.beta = VectorXd::Constant(n, kMove);
  const auto part = [&](const auto& slope, double sign) -> VectorXd {
    const auto with = (sign * slope.array()).max(0), against = (-sign * slope.array()).max(0);
    return kDistance * kDistance * (1.001 * with + 0.001 * against + kConvexity).matrix();
  };
  p.p0 = part(kScale * r.df, 1);
  p.q0 = part(kScale * r.df, -1);
  p.P.resize(n, m);
  p.Q.resize(n, m);
  for (Eigen::Index i = 0; i < m; ++i) {
    p.P.col(i) = part(r.dg.row(i).transpose(), 1);
    p.Q.col(i) = part(r.dg.row(i).transpose(), -1);
  }
  p.b = (p.P + p.Q).colwise().sum().transpose() / kDistance - r.g;
  p.a = VectorXd::Zero(m);
  p.c = VectorXd::Constant(m, kPrice);
  p.d = VectorXd::Ones(m);
  return p;
}

void print_row(int n, int m, double spread) {
  const optim::ProblemValues r = worst_case(n, m, spread);
  const optim::MmaSubproblem p = subproblem(r);
  optim::MmaSolver solver(n, m);
  const double ms = milliseconds([&] { solver.solve(p); });
  const optim::MmaSolution& s = solver.solve(p);
  const VectorXd x = VectorXd::Zero(n), bound = VectorXd::Ones(n);
  const double kkt_ms = milliseconds([&] { optim::kkt_point(r, x, -bound, bound, 1e-4); });
  std::printf("%5d %4d  %6.3f   %6ld  %6d  %8.3f  %6.2f   %7.1e  %9.3f\n", n, m, spread,
              static_cast<long>((s.lambda.array() > 1e-6).count()), s.newton_steps, ms,
              ms / kDemanded, s.kkt, kkt_ms);
}

}  // namespace

int main(int, char** argv) {
  begin(argv);
  std::printf("    n    m  spread   active   steps        ms    of 5   KKT      KKT of x, ms\n");
  for (const int n : {112, 672, 1120}) {
    for (const int m : {1, 2, 11, 101}) print_row(n, m, 0.3);
  }
  std::printf("many loads near the worst, and all of them\n");
  for (const double spread : {0.01, 0.0}) {
    for (const int n : {112, 672, 1120}) print_row(n, 101, spread);
  }
}
