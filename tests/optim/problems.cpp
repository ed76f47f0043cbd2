#include "tests/optim/problems.h"

#include <Eigen/LU>
#include <cmath>

namespace flexmorph::optim::test {
VectorXd vec(std::initializer_list<double> values) {
  return Eigen::Map<const VectorXd>(values.begin(), static_cast<Eigen::Index>(values.size()));
}

// Weight of a cantilever of five hollow boxes with a displacement limit at its tip: min 0.0624 Σ x,
// 61/x₁³ + 37/x₂³ + 19/x₃³ + 7/x₄³ + 1/x₅³ <= 1. Printed optimum: 1.340. In closed form: x_j = (3
// c_j λ / 0.0624)^¼ with the constraint active.
Analytic cantilever() {
  const VectorXd c = vec({61, 37, 19, 7, 1});
  const double root = c.array().pow(0.25).sum();
  const double s = std::cbrt(root);  // x_j = s c_j^¼
  Analytic problem(
      "cantilever", VectorXd::Constant(5, 1), VectorXd::Constant(5, 10), VectorXd::Constant(5, 5),
      1,
      [c](const VectorXd& x, ProblemValues& r) {
        r.f = 0.0624 * x.sum();
        r.df.setConstant(0.0624);
        r.g[0] = (c.array() / x.array().cube()).sum() - 1;
        r.dg.row(0) = -3 * c.array() / x.array().pow(4);
      },
      0.0624 * s * root);
  problem.solution = s * c.array().pow(0.25);
  return problem;
}

// Weight of a truss of two bars with stress limits; area x₁ and half distance of the feet x₂. With
// the first constraint active, 16 x₂³ + x₂² = 1. Printed optimum: 1.51 at (1.41, 0.38).
Analytic two_bar_truss() {
  double low = 0, high = 1;
  for (int k = 0; k < 100; ++k) {
    const double x = 0.5 * (low + high);
    (16 * x * x * x + x * x < 1 ? low : high) = x;
  }
  const double x2 = low;
  const double x1 = 0.124 * std::sqrt(1 + x2 * x2) * (8 + 1 / x2);
  Analytic problem(
      "two_bar_truss", vec({0.2, 0.1}), vec({4, 1.6}), vec({1.5, 0.5}), 2,
      [](const VectorXd& x, ProblemValues& r) {
        const double a = x[0], b = x[1], w = std::sqrt(1 + b * b);
        r.f = a * w;
        r.df << w, a * b / w;
        for (int i = 0; i < 2; ++i) {
          const double sign = i == 0 ? 1 : -1;
          const double force = 8 / a + sign / (a * b);
          r.g[i] = 0.124 * w * force - 1;
          r.dg(i, 0) = -0.124 * w * force / a;
          r.dg(i, 1) = 0.124 * (b / w * force - sign * w / (a * b * b));
        }
      },
      x1 * std::sqrt(1 + x2 * x2));
  problem.solution = vec({x1, x2});
  return problem;
}

// Weight of a pyramid of eight steel bars (7800 kg/m³) under (40, 20, 200) kN at its top, stresses
// within ±100 N/mm², areas of at least 100 mm². Young's modulus cancels, because all bars meet in
// the only free node. Printed: 13.05 kg at the start and 11.23 kg at the optimum, which more than
// one set of areas reaches. More digits: TRUSPYR2 of the CUTEst collection is this truss with
// limits on tension only; at the optimum all bars are in tension.
Analytic eight_bar_truss() {
  constexpr int kBars = 8;
  Eigen::Matrix<double, 3, kBars> bar;                   // [m], from the foot to the top
  bar << 0.25, 0.25, -0.25, -0.25, 0.375, 0, -0.375, 0,  //
      0.25, -0.25, -0.25, 0.25, 0, 0.375, 0, -0.375,     //
      0.375, 0.375, 0.375, 0.375, 0.375, 0.375, 0.375, 0.375;
  const Eigen::Vector<double, kBars> length = bar.colwise().norm();
  const Eigen::Matrix<double, 3, kBars> e = bar * length.cwiseInverse().asDiagonal();
  const Eigen::Vector3d load(4, 2, 20);  // [10 kN = cm² · 100 N/mm²]
  const Eigen::Vector<double, kBars> weight = 0.78 * length;
  return {"eight_bar_truss",
          VectorXd::Constant(kBars, 1),
          VectorXd::Constant(kBars, 50),
          VectorXd::Constant(kBars, 4),
          2 * kBars,
          [=](const VectorXd& x, ProblemValues& r) {
            const Eigen::Matrix3d K = e * x.cwiseQuotient(length).asDiagonal() * e.transpose();
            const Eigen::Matrix3d flexibility = K.inverse();
            const VectorXd stress = (e.transpose() * flexibility * load).cwiseQuotient(length);
            const MatrixXd d_stress = length.cwiseInverse().asDiagonal() *
                                      (e.transpose() * flexibility * e) * (-stress).asDiagonal();
            r.f = weight.dot(x);
            r.df = weight;
            r.g << stress.array() - 1, -stress.array() - 1;
            r.dg << d_stress, -d_stress;
          },
          11.2287408808};
}

// Numbers 35, 43, 76 and 100 of Hock & Schittkowski (1981), Test Examples for Nonlinear Programming
// Codes. Where the source has no bounds, finite bounds are added that are not active.
Analytic hock_schittkowski_35() {
  Analytic problem(
      "HS35", VectorXd::Zero(3), VectorXd::Constant(3, 10), VectorXd::Constant(3, 0.5), 1,
      [](const VectorXd& x, ProblemValues& r) {
        r.f = 9 - 8 * x[0] - 6 * x[1] - 4 * x[2] + 2 * x[0] * x[0] + 2 * x[1] * x[1] + x[2] * x[2] +
              2 * x[0] * x[1] + 2 * x[0] * x[2];
        r.df << -8 + 4 * x[0] + 2 * x[1] + 2 * x[2], -6 + 4 * x[1] + 2 * x[0],
            -4 + 2 * x[2] + 2 * x[0];
        r.g[0] = x[0] + x[1] + 2 * x[2] - 3;
        r.dg << 1, 1, 2;
      },
      1.0 / 9);
  problem.solution = vec({4.0 / 3, 7.0 / 9, 4.0 / 9});
  return problem;
}

Analytic hock_schittkowski_43() {
  Analytic problem(
      "HS43", VectorXd::Constant(4, -10), VectorXd::Constant(4, 10), VectorXd::Zero(4), 3,
      [](const VectorXd& x, ProblemValues& r) {
        const Eigen::Array4d s = x.array().square();
        r.f = s[0] + s[1] + 2 * s[2] + s[3] - 5 * x[0] - 5 * x[1] - 21 * x[2] + 7 * x[3];
        r.df << 2 * x[0] - 5, 2 * x[1] - 5, 4 * x[2] - 21, 2 * x[3] + 7;
        r.g << s.sum() + x[0] - x[1] + x[2] - x[3] - 8,
            s[0] + 2 * s[1] + s[2] + 2 * s[3] - x[0] - x[3] - 10,
            2 * s[0] + s[1] + s[2] + 2 * x[0] - x[1] - x[3] - 5;
        r.dg.row(0) << 2 * x[0] + 1, 2 * x[1] - 1, 2 * x[2] + 1, 2 * x[3] - 1;
        r.dg.row(1) << 2 * x[0] - 1, 4 * x[1], 2 * x[2], 4 * x[3] - 1;
        r.dg.row(2) << 4 * x[0] + 2, 2 * x[1] - 1, 2 * x[2], -1;
      },
      -44);
  problem.solution = vec({0, 1, 2, -1});
  return problem;
}

Analytic hock_schittkowski_76() {
  Analytic problem(
      "HS76", VectorXd::Zero(4), VectorXd::Constant(4, 10), VectorXd::Constant(4, 0.5), 3,
      [](const VectorXd& x, ProblemValues& r) {
        r.f = x[0] * x[0] + 0.5 * x[1] * x[1] + x[2] * x[2] + 0.5 * x[3] * x[3] - x[0] * x[2] +
              x[2] * x[3] - x[0] - 3 * x[1] + x[2] - x[3];
        r.df << 2 * x[0] - x[2] - 1, x[1] - 3, 2 * x[2] - x[0] + x[3] + 1, x[3] + x[2] - 1;
        r.g << x[0] + 2 * x[1] + x[2] + x[3] - 5, 3 * x[0] + x[1] + 2 * x[2] - x[3] - 4,
            1.5 - x[1] - 4 * x[2];
        r.dg.row(0) << 1, 2, 1, 1;
        r.dg.row(1) << 3, 1, 2, -1;
        r.dg.row(2) << 0, -1, -4, 0;
      },
      -4.681818181818182);
  problem.solution = vec({3.0 / 11, 23.0 / 11, 0, 6.0 / 11});
  return problem;
}

// f and g are divided by 100: the values of the source are in the hundreds.
Analytic hock_schittkowski_100() {
  return {"HS100",
          VectorXd::Constant(7, -10),
          VectorXd::Constant(7, 10),
          vec({1, 2, 0, 4, 0, 1, 1}),
          4,
          [](const VectorXd& x, ProblemValues& r) {
            const auto power = [&](int j, int p) { return std::pow(x[j], p); };
            r.f = power(2, 4) + 10 * power(4, 6) + 7 * power(5, 2) + power(6, 4) - 4 * x[5] * x[6] -
                  10 * x[5] - 8 * x[6] + std::pow(x[0] - 10, 2) + 5 * std::pow(x[1] - 12, 2) +
                  3 * std::pow(x[3] - 11, 2);
            r.df << 2 * (x[0] - 10), 10 * (x[1] - 12), 4 * power(2, 3), 6 * (x[3] - 11),
                60 * power(4, 5), 14 * x[5] - 4 * x[6] - 10, 4 * power(6, 3) - 4 * x[5] - 8;
            r.g << 2 * power(0, 2) + 3 * power(1, 4) + x[2] + 4 * power(3, 2) + 5 * x[4] - 127,
                7 * x[0] + 3 * x[1] + 10 * power(2, 2) + x[3] - x[4] - 282,
                23 * x[0] + power(1, 2) + 6 * power(5, 2) - 8 * x[6] - 196,
                4 * power(0, 2) + power(1, 2) - 3 * x[0] * x[1] + 2 * power(2, 2) + 5 * x[5] -
                    11 * x[6];
            r.dg.row(0) << 4 * x[0], 12 * power(1, 3), 1, 8 * x[3], 5, 0, 0;
            r.dg.row(1) << 7, 3, 20 * x[2], 1, -1, 0, 0;
            r.dg.row(2) << 23, 2 * x[1], 0, 0, 0, 12 * x[5], -8;
            r.dg.row(3) << 8 * x[0] - 3 * x[1], 2 * x[1] - 3 * x[0], 4 * x[2], 0, 0, 5, -11;
            r.f /= 100;
            r.df /= 100;
            r.g /= 100;
            r.dg /= 100;
          },
          6.806300573};
}

// Closed form: x_j = √(c_j / (λ a_j)) between its bounds, with λ by bisection.
Analytic many_bars(int n) {
  VectorXd a(n), c(n);
  for (int j = 0; j < n; ++j) {
    a[j] = 1 + 0.5 * std::sin(0.7 * j);
    c[j] = 1 + 0.9 * std::cos(1.3 * j);
  }
  const double limit = 0.5 * a.sum();
  const auto bars = [&](double lambda) -> VectorXd {
    return (c.array() / (lambda * a.array())).sqrt().max(0.2).min(0.7);
  };
  double low = 1e-3, high = 1e3;
  for (int k = 0; k < 200; ++k) {
    const double lambda = std::sqrt(low * high);
    (a.dot(bars(lambda)) > limit ? low : high) = lambda;
  }
  const VectorXd x = bars(high);
  Analytic problem(
      "many_bars", VectorXd::Constant(n, 0.2), VectorXd::Constant(n, 0.7),
      VectorXd::Constant(n, 0.5), 1,
      [a, c, n, limit](const VectorXd& at, ProblemValues& r) {
        r.f = (c.array() / at.array()).sum() / n;
        r.df = -c.array() / at.array().square() / n;
        r.g[0] = a.dot(at) / limit - 1;
        r.dg.row(0) = a / limit;
      },
      (c.array() / x.array()).sum() / n);
  problem.solution = x;
  return problem;
}

std::vector<Analytic> published_problems() {
  std::vector<Analytic> problems = hock_schittkowski_problems();
  problems.push_back(cantilever());
  problems.push_back(two_bar_truss());
  problems.push_back(eight_bar_truss());
  return problems;
}

std::vector<Analytic> all_problems() {
  return {cantilever(),           two_bar_truss(),        hock_schittkowski_35(),
          hock_schittkowski_43(), hock_schittkowski_76(), hock_schittkowski_100(),
          many_bars(1000)};
}

Settings for_small_problems(const std::string& optimizer) {
  Settings s;
  s.name = optimizer;
  s.max_iterations = 600;
  s.kkt_tolerance = optimizer == "ipopt" ? 1e-8 : 1e-6;  // ipopt uses second-order information
  s.feasibility = 1e-7;
  s.rest.rows = 0;
  s.move_limit = 1;  // the problems are smooth, and steps of one unit are allowed
  // Asymptotes at half a unit reach optima several units away quickly. Asymptotes that may come as
  // near as 1e-4 do not oscillate about a minimum of large curvature (4 raa0 / asymin is larger).
  if (optimizer == "mma" || optimizer == "gcmma") {
    s.options = {{"asyinit", 0.5}, {"asyincr", 1.2}, {"asydecr", 0.7}, {"asymin", 1e-4}};
  }
  // The problems are no structures, therefore no box is used; f and g are already of the order of
  // 1.
  if (optimizer.starts_with("nlopt")) s.options = {{"box", 0}, {"scale", 1}};
  return s;
}

}  // namespace flexmorph::optim::test
