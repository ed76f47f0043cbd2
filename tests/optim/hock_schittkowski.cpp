#include <Eigen/Core>
#include <cmath>
#include <numbers>
#include <unsupported/Eigen/AutoDiff>

#include "tests/optim/problems.h"

// Problems of Hock & Schittkowski (1981), Test Examples for Nonlinear Programming Codes, Lecture
// Notes in Economics and Mathematical Systems 187: a choice of those with inequality constraints
// only. They are written as min f(x) subject to c(x) >= 0, with x(1) the first entry; gradients by
// forward differentiation. Where the book has no bounds, wide ones (±100, 0 to 100; 1 to 1000 for
// number 64) are added that are not active at the optimum. Units are chosen so that x, f and g are
// of the order of 1 or 10, and a start outside of its bounds (number 65) is moved onto them.
//
// Number 33 is left out: f and all constraints are stationary in x(2) at its published start, where
// first-order methods stay.
namespace flexmorph::optim::test {
namespace {

using Gradient = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, 16, 1>;
using Ad = Eigen::AutoDiffScalar<Gradient>;

VectorXd all(int n, double value) { return VectorXd::Constant(n, value); }

/// The variables x(1) to x(n) with the numbering of the book.
struct Variables {
  std::vector<Ad> entries;
  const Ad& operator()(int i) const { return entries[static_cast<size_t>(i - 1)]; }
};

Ad square(const Ad& a) { return a * a; }

struct Printed {
  std::string name;
  VectorXd lower, upper, start;
  int n_constraints = 1;
  std::function<Ad(const Variables& x, std::vector<Ad>& c)> functions;  // returns f
  double optimum = 0;
  double f_unit = 1, c_unit = 1;
  VectorXd x_unit = {};  // empty: all 1
};

Analytic problem(const Printed& p) {
  const VectorXd unit = p.x_unit.size() > 0 ? p.x_unit : all(static_cast<int>(p.lower.size()), 1);
  const auto evaluate = [p, unit](const VectorXd& y, ProblemValues& r) {
    Variables x;
    for (int j = 0; j < y.size(); ++j) {
      x.entries.emplace_back(unit[j] * y[j], y.size(), j);
      x.entries.back().derivatives() *= unit[j];
    }
    std::vector<Ad> c(static_cast<size_t>(p.n_constraints));
    const Ad f = p.functions(x, c);
    r.f = f.value() / p.f_unit;
    r.df = f.derivatives() / p.f_unit;
    for (int i = 0; i < p.n_constraints; ++i) {
      const Ad& ci = c[static_cast<size_t>(i)];
      r.g[i] = -ci.value() / p.c_unit;
      r.dg.row(i) = -ci.derivatives().transpose() / p.c_unit;
    }
  };
  return {p.name,
          p.lower.cwiseQuotient(unit),
          p.upper.cwiseQuotient(unit),
          p.start.cwiseQuotient(unit),
          p.n_constraints,
          evaluate,
          p.optimum / p.f_unit};
}

std::vector<Printed> of_two_variables() {
  const double root3 = std::numbers::sqrt3;
  return {
      {"HS10", all(2, -100), all(2, 100), vec({-10, 10}), 1,
       [](const Variables& x, std::vector<Ad>& c) -> Ad {
         c[0] = -3 * square(x(1)) + 2 * x(1) * x(2) - square(x(2)) + 1;
         return x(1) - x(2);
       },
       -1},
      {"HS11", all(2, -100), all(2, 100), vec({4.9, 0.1}), 1,
       [](const Variables& x, std::vector<Ad>& c) -> Ad {
         c[0] = x(2) - square(x(1));
         return square(x(1) - 5) + square(x(2)) - 25;
       },
       -8.498464223},
      {"HS12", all(2, -100), all(2, 100), vec({0, 0}), 1,
       [](const Variables& x, std::vector<Ad>& c) -> Ad {
         c[0] = 25 - 4 * square(x(1)) - square(x(2));
         return 0.5 * square(x(1)) + square(x(2)) - x(1) * x(2) - 7 * x(1) - 7 * x(2);
       },
       -30},
      {"HS22", all(2, -100), all(2, 100), vec({2, 2}), 2,
       [](const Variables& x, std::vector<Ad>& c) -> Ad {
         c[0] = 2 - x(1) - x(2);
         c[1] = x(2) - square(x(1));
         return square(x(1) - 2) + square(x(2) - 1);
       },
       1},
      {"HS24", all(2, 0), all(2, 100), vec({1, 0.5}), 3,
       [root3](const Variables& x, std::vector<Ad>& c) -> Ad {
         c[0] = x(1) / root3 - x(2);
         c[1] = x(1) + root3 * x(2);
         c[2] = 6 - x(1) - root3 * x(2);
         const Ad cube = x(2) * x(2) * x(2);
         return (square(x(1) - 3) - 9) * cube / (27 * root3);
       },
       -1},
  };
}

std::vector<Printed> of_three_variables() {
  const auto product = [](const Variables& x) -> Ad { return -x(1) * x(2) * x(3); };
  const auto towers = [](const Variables& x, std::vector<Ad>& c) {
    c[0] = x(2) - exp(x(1));
    c[1] = x(3) - exp(x(2));
  };
  return {
      {"HS29", all(3, -100), all(3, 100), vec({1, 1, 1}), 1,
       [product](const Variables& x, std::vector<Ad>& c) -> Ad {
         c[0] = 48 - square(x(1)) - 2 * square(x(2)) - 4 * square(x(3));
         return product(x);
       },
       -16 * std::numbers::sqrt2},
      {"HS30", vec({1, -10, -10}), all(3, 10), vec({1, 1, 1}), 1,
       [](const Variables& x, std::vector<Ad>& c) -> Ad {
         c[0] = square(x(1)) + square(x(2)) - 1;
         return square(x(1)) + square(x(2)) + square(x(3));
       },
       1},
      {"HS31", vec({-10, 1, -10}), vec({10, 10, 1}), vec({1, 1, 1}), 1,
       [](const Variables& x, std::vector<Ad>& c) -> Ad {
         c[0] = x(1) * x(2) - 1;
         return 9 * square(x(1)) + square(x(2)) + 9 * square(x(3));
       },
       6},
      {"HS34", all(3, 0), vec({100, 100, 10}), vec({0, 1.05, 2.9}), 2,
       [towers](const Variables& x, std::vector<Ad>& c) -> Ad {
         towers(x, c);
         return -x(1);
       },
       -std::log(std::log(10.0))},
      {"HS36", all(3, 0), vec({20, 11, 42}), vec({10, 10, 10}), 1,
       [product](const Variables& x, std::vector<Ad>& c) -> Ad {
         c[0] = 72 - x(1) - 2 * x(2) - 2 * x(3);
         return product(x);
       },
       -3300, 1000, 10},
      {"HS37", all(3, 0), all(3, 42), vec({10, 10, 10}), 2,
       [product](const Variables& x, std::vector<Ad>& c) -> Ad {
         c[0] = 72 - x(1) - 2 * x(2) - 2 * x(3);
         c[1] = x(1) + 2 * x(2) + 2 * x(3);
         return product(x);
       },
       -3456, 1000, 10},
      {"HS64", all(3, 1), all(3, 1000), vec({1, 1, 1}), 1,
       [](const Variables& x, std::vector<Ad>& c) -> Ad {
         c[0] = 1 - 4 / x(1) - 32 / x(2) - 120 / x(3);
         return 5 * x(1) + 50000 / x(1) + 20 * x(2) + 72000 / x(2) + 10 * x(3) + 144000 / x(3);
       },
       6299.842428, 1000, 1, all(3, 100)},
      {"HS65", vec({-4.5, -4.5, -5}), vec({4.5, 4.5, 5}), vec({-4.5, 4.5, 0}), 1,
       [](const Variables& x, std::vector<Ad>& c) -> Ad {
         c[0] = 48 - square(x(1)) - square(x(2)) - square(x(3));
         return square(x(1) - x(2)) + square(x(1) + x(2) - 10) / 9 + square(x(3) - 5);
       },
       0.9535288567},
      {"HS66", all(3, 0), vec({100, 100, 10}), vec({0, 1.05, 2.9}), 2,
       [towers](const Variables& x, std::vector<Ad>& c) -> Ad {
         towers(x, c);
         return 0.2 * x(3) - 0.8 * x(1);
       },
       0.5181632741},
  };
}

/// Number 83 (Colville's third problem): three quantities, each between two bounds.
Printed himmelblau() {
  return {
      "HS83",
      vec({78, 33, 27, 27, 27}),
      vec({102, 45, 45, 45, 45}),
      vec({78, 33, 27, 27, 27}),
      6,
      [](const Variables& x, std::vector<Ad>& c) -> Ad {
        const Ad a =
            85.334407 + 0.0056858 * x(2) * x(5) + 0.0006262 * x(1) * x(4) - 0.0022053 * x(3) * x(5);
        const Ad b =
            80.51249 + 0.0071317 * x(2) * x(5) + 0.0029955 * x(1) * x(2) + 0.0021813 * square(x(3));
        const Ad d =
            9.300961 + 0.0047026 * x(3) * x(5) + 0.0012547 * x(1) * x(3) + 0.0019085 * x(3) * x(4);
        c = {a, 92 - a, b - 90, 110 - b, d - 20, 25 - d};
        return 5.3578547 * square(x(3)) + 0.8356891 * x(1) * x(5) + 37.293239 * x(1) - 40792.141;
      },
      -30665.53867,
      10000,
      1,
      all(5, 10)};
}

/// Number 93: the design of a transformer.
Printed transformer() {
  return {"HS93",
          all(6, 0),
          all(6, 100),
          vec({5.54, 4.4, 12.02, 11.82, 0.702, 0.852}),
          2,
          [](const Variables& x, std::vector<Ad>& c) -> Ad {
            const Ad a = x(1) * x(4) * (x(1) + x(2) + x(3));
            const Ad b = x(2) * x(3) * (x(1) + 1.57 * x(2) + x(4));
            const Ad a5 = a * square(x(5)), b6 = b * square(x(6));
            c[0] = 0.001 * x(1) * x(2) * x(3) * x(4) * x(5) * x(6) - 2.07;
            c[1] = 1 - 0.00062 * a5 - 0.00058 * b6;
            return 0.0204 * a + 0.0187 * b + 0.0607 * a5 + 0.0437 * b6;
          },
          135.075961,
          100,
          1,
          vec({10, 10, 10, 10, 1, 1})};
}

/// Number 104: the design of a reactor. The bounds of the book on f itself are not active.
Printed reactor() {
  return {
      "HS104",
      all(8, 0.1),
      all(8, 10),
      vec({6, 3, 0.4, 0.2, 6, 6, 1, 0.5}),
      6,
      [](const Variables& x, std::vector<Ad>& c) -> Ad {
        const Ad f = 0.4 * pow(x(1), 0.67) * pow(x(7), -0.67) +
                     0.4 * pow(x(2), 0.67) * pow(x(8), -0.67) + 10 - x(1) - x(2);
        c[0] = 1 - 0.0588 * x(5) * x(7) - 0.1 * x(1);
        c[1] = 1 - 0.0588 * x(6) * x(8) - 0.1 * x(1) - 0.1 * x(2);
        c[2] = 1 - 4 * x(3) / x(5) - 2 * pow(x(3), -0.71) / x(5) - 0.0588 * pow(x(3), -1.3) * x(7);
        c[3] = 1 - 4 * x(4) / x(6) - 2 * pow(x(4), -0.71) / x(6) - 0.0588 * pow(x(4), -1.3) * x(8);
        c[4] = f - 1;
        c[5] = 4.2 - f;
        return f;
      },
      3.9511634396};
}

/// Number 113: ten variables, eight constraints.
Printed wong() {
  return {"HS113",
          all(10, -100),
          all(10, 100),
          vec({2, 3, 5, 5, 1, 2, 7, 3, 6, 10}),
          8,
          [](const Variables& x, std::vector<Ad>& c) -> Ad {
            c[0] = 105 - 4 * x(1) - 5 * x(2) + 3 * x(7) - 9 * x(8);
            c[1] = -10 * x(1) + 8 * x(2) + 17 * x(7) - 2 * x(8);
            c[2] = 8 * x(1) - 2 * x(2) - 5 * x(9) + 2 * x(10) + 12;
            c[3] = 120 - 3 * square(x(1) - 2) - 4 * square(x(2) - 3) - 2 * square(x(3)) + 7 * x(4);
            c[4] = 40 - 5 * square(x(1)) - 8 * x(2) - square(x(3) - 6) + 2 * x(4);
            c[5] = 30 - 0.5 * square(x(1) - 8) - 2 * square(x(2) - 4) - 3 * square(x(5)) + x(6);
            c[6] = 2 * x(1) * x(2) - square(x(1)) - 2 * square(x(2) - 2) - 14 * x(5) + 6 * x(6);
            c[7] = 3 * x(1) - 6 * x(2) - 12 * square(x(9) - 8) + 7 * x(10);
            return square(x(1)) + square(x(2)) + x(1) * x(2) - 14 * x(1) - 16 * x(2) +
                   square(x(3) - 10) + 4 * square(x(4) - 5) + square(x(5) - 3) +
                   2 * square(x(6) - 1) + 5 * square(x(7)) + 7 * square(x(8) - 11) +
                   2 * square(x(9) - 10) + square(x(10) - 7) + 45;
          },
          24.3062091,
          10,
          10};
}

}  // namespace

std::vector<Analytic> hock_schittkowski_problems() {
  std::vector<Analytic> problems = {hock_schittkowski_35(), hock_schittkowski_43(),
                                    hock_schittkowski_76(), hock_schittkowski_100()};
  for (const std::vector<Printed>& group :
       {of_two_variables(), of_three_variables(),
        std::vector<Printed>{himmelblau(), transformer(), reactor(), wong()}}) {
    for (const Printed& printed : group) problems.push_back(problem(printed));
  }
  return problems;
}

}  // namespace flexmorph::optim::test
