// Shows which design a search delivers, and that its verdict describes how far the design is from
// an optimum.
#include <gtest/gtest.h>

#include <cmath>

#include "optim/search.h"
#include "tests/optim/problems.h"

namespace flexmorph::optim {
namespace {

VectorXd at(double x, double z) { return Eigen::Vector2d(x, z); }

/// minimize z, z >= (x - 1)^2 + 1, z >= 2 - x, x <= 1.5: the first two rows only bound the
/// objective max((x - 1)^2 + 1, 2 - x).
test::Analytic largest_of_two() {
  return {"largest of two",
          at(0, 0),
          at(3, 3),
          at(0.5, 0.1),
          3,
          [](const VectorXd& x, ProblemValues& r) {
            r.f = x[1];
            r.df = at(0, 1);
            r.g = Eigen::Vector3d((x[0] - 1) * (x[0] - 1) + 1 - x[1], 2 - x[0] - x[1], x[0] - 1.5);
            r.dg.resize(3, 2);
            r.dg << 2 * (x[0] - 1), -1, -1, -1, 1, 0;
            r.n_bounds = 2;
          },
          1};
}

TEST(Search, RanksDesignsByTheObjectiveThatTheyAttain) {
  test::Analytic problem = largest_of_two();
  const Settings settings;
  const Observer none;
  Search search(problem, settings, none);
  Point point = search.start();
  EXPECT_NEAR(attained_objective(point.response), 1.5, 1e-9);
  // The designs: beyond its limit; at the optimum, with a variable z that is too small; worse, with
  // all rows satisfied.
  for (const VectorXd& x : {at(1.6, 0.5), at(1, 0.9), at(1.4, 1.2)}) {
    point.x = x;
    search.evaluate(x, point.response);
  }
  const Result result = search.result();
  EXPECT_EQ(result.x, at(1, 0.9));
  EXPECT_NEAR(attained_objective(result.response), 1, 1e-12);
  EXPECT_EQ(result.violation, 0);
  EXPECT_NEAR(violation(result.response), 0.1, 1e-12);
}

/// minimize x subject to x <= limit, with the lower bound -10.
test::Analytic line(double start, double limit) {
  return {"line",
          VectorXd::Constant(1, -10),
          VectorXd::Constant(1, 10),
          VectorXd::Constant(1, start),
          1,
          [limit](const VectorXd& x, ProblemValues& r) {
            r.f = x[0];
            r.df = VectorXd::Ones(1);
            r.g = VectorXd::Constant(1, x[0] - limit);
            r.dg = MatrixXd::Ones(1, 1);
          },
          -10};
}

/// Returns the verdict after rows with these values of x, which is the objective.
Verdict verdict_after(const std::vector<double>& values, double limit) {
  test::Analytic problem = line(values.front(), limit);
  const Settings settings;
  const Observer none;
  Search search(problem, settings, none);
  Point point = search.start();
  for (size_t k = 0; k < values.size(); ++k) {
    point.x = VectorXd::Constant(1, values[k]);
    search.evaluate(point.x, point.response);
    search.row(static_cast<int>(k) + 1, point);
  }
  return search.result().verdict;
}

/// Returns the row at which a search stops by itself, of at most 100 rows in which the objective
/// decreases by `per_row`.
int last_row(double per_row, double limit, bool plateau) {
  test::Analytic problem = line(1, limit);
  Settings settings;
  settings.plateau = plateau;
  settings.rest.rows = 0;
  const Observer none;
  Search search(problem, settings, none);
  Point point = search.start();
  int row = 0;
  do {
    ++row;
    point.x = VectorXd::Constant(1, 1 - per_row * row);
    search.evaluate(point.x, point.response);
  } while (search.row(row, point) && row < 100);
  return row;
}

std::vector<double> falling(int n, double per_row) {
  std::vector<double> out;
  for (int k = 0; k < n; ++k) out.push_back(1 - per_row * k);
  return out;
}

TEST(Verdict, TellsPlateausFromDesignsOnTheirWay) {
  const Verdict flat = verdict_after(falling(40, 3e-5), 5);
  EXPECT_EQ(flat.kind, Verdict::Kind::stagnated);
  EXPECT_NEAR(flat.improvement, 20 * 3e-5, 1e-9);
  EXPECT_NEAR(flat.kkt, 1, 1e-9);
  EXPECT_EQ(verdict_after(falling(40, 4e-5), 5).kind, Verdict::Kind::unfinished);
  EXPECT_EQ(verdict_after(falling(30, 0), 5).kind, Verdict::Kind::unfinished);  // too few rows
  EXPECT_EQ(verdict_after(falling(31, 0), 5).kind, Verdict::Kind::stagnated);
  const Verdict never = verdict_after(falling(40, 0), 0.5);  // never feasible
  EXPECT_EQ(never.kind, Verdict::Kind::unfinished);
  EXPECT_TRUE(std::isnan(never.improvement));
  EXPECT_EQ(verdict_after({1, -10}, 5).kind, Verdict::Kind::converged);  // at its lower bound
}

// With `plateau`, 30 rows of feasible designs in which the objective decreases by less than 1e-3
// end a search.
TEST(Verdict, PlateauEndsASearchThatIsAskedTo) {
  EXPECT_EQ(last_row(3e-5, 5, true), 31);
  EXPECT_EQ(last_row(4e-5, 5, true), 100);
  EXPECT_EQ(last_row(3e-5, 5, false), 100);
  EXPECT_EQ(last_row(3e-5, 0.5, true), 100);
}

TEST(Verdict, SaysItsNumbers) {
  const std::string unfinished = text_of({Verdict::Kind::unfinished, 0.04, 0.021});
  for (const char* part : {"unfinished", " 2.1 %", " 20 iterations", "KKT", " 4.0e-02"})
    EXPECT_NE(unfinished.find(part), std::string::npos) << part << ": " << unfinished;
  const std::string stagnated = text_of({Verdict::Kind::stagnated, 0.04, 0});
  for (const char* part : {"stagnated", " 0.1 %", " 30 iterations", "KKT", " 4.0e-02"})
    EXPECT_NE(stagnated.find(part), std::string::npos) << part << ": " << stagnated;
}

}  // namespace
}  // namespace flexmorph::optim
