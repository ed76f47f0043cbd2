// Prints the CPU time of the static part of one design iteration with 400 x 40 cells and 100 loads
// whose root moves from column 200 to 0, compared with CHOLMOD used directly; of the moving root
// compared with refactoring; and of load compression. One thread. It checks nothing.

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <random>
#include <vector>

#include "fem/solve/static_solver.h"
#include "optim/mmc/loads/compliance_evaluator.h"
#include "tests/benchmark/cpu.h"
#include "tests/benchmark/reference.h"

namespace {

using namespace flexmorph;
using namespace flexmorph::benchmark;

/// Returns a design whose cells are solid with probability 1/2, in patches of 4 x 4.
VectorXd random_design(unsigned seed, double empty) {
  std::mt19937 engine(seed);
  std::bernoulli_distribution solid(0.5);
  VectorXd factor(kGrid.n_cells());
  for (int i = 0; i < kGrid.nx; i += 4) {
    for (int j = 0; j < kGrid.ny; j += 4) {
      const double f = solid(engine) ? 1.0 : empty;
      for (int k = 0; k < 16; ++k) factor(kGrid.cell(i + k / 4, j + k % 4)) = f;
    }
  }
  return factor;
}

/// Returns loads of a rotating, growing plate with `n_modes` vibrations in each direction; the root
/// passes through `n_columns` columns from 200 to 0.
fem::EslSets synthetic_loads(int n_modes, int n_columns) {
  const double omega = 2 * std::numbers::pi, v = 0.5;
  fem::EslSets loads{kGrid, {}};
  for (int k = 0; k < kLoads; ++k) {
    const double t = k / (kLoads - 1.0);
    fem::EslSet set;
    set.weight = 1.0 / kLoads;
    const int step = std::min(k * n_columns / kLoads, n_columns - 1);
    set.root_column = 200 - (n_columns > 1 ? 2 * (step * 99 / (n_columns - 1)) : 200);
    const double root = kGrid.x0 + set.root_column * kGrid.dx();
    set.acceleration.resize(2 * kGrid.n_nodes());
    for (int i = 0; i <= kGrid.nx; ++i) {
      for (int j = 0; j <= kGrid.ny; ++j) {
        const Vec2 X = kGrid.node_position(i, j);
        Vec2 a{-omega * omega * (X.x() - root), 2 * omega * v - omega * omega * X.y()};
        for (int m = 1; m <= n_modes; ++m) {
          a.x() += 4.0 / m * std::cos(70 * m * t) * std::sin(1.5 * m * X.x()) * (1 + X.y());
          a.y() += 20.0 / m * std::cos(19 * m * t + m) * std::sin(1.5 * m * X.x());
        }
        set.acceleration.segment<2>(2 * kGrid.node(i, j)) = a;
      }
    }
    const int tip = kGrid.node(kGrid.nx, kGrid.ny / 2);
    set.forces.push_back({tip, -0.5 * set.acceleration.segment<2>(2 * tip)});
    loads.sets.push_back(std::move(set));
  }
  return loads;
}

struct Times {
  double total, factor, solve, sensitivity;
  int right_hand_sides;
};

Times iteration(const fem::EslSets& loads, const mmc::ComplianceSettings& settings) {
  const std::array<VectorXd, 2> k = {random_design(1, 1e-3), random_design(2, 1e-3)};
  const std::array<VectorXd, 2> m = {random_design(1, 0), random_design(2, 0)};
  mmc::ComplianceEvaluator compliance(loads, kSection, settings, k[0], m[0]);
  mmc::ComplianceEvaluator::Value value;
  std::size_t turn = 0;
  Times t{};
  t.total = milliseconds([&] {
    // another design each time, because an unchanged one would not be factored again
    turn = 1 - turn;
    compliance.evaluate(k[turn], m[turn], value);
  });
  const auto s = compliance.seconds();
  t.factor = 1e3 * s.factor;
  t.solve = 1e3 * s.solve;
  t.sensitivity = 1e3 * s.sensitivity;
  t.right_hand_sides = compliance.n_right_hand_sides();
  return t;
}

void print(const char* name, const Times& t, double reference) {
  std::printf("%-44s %4d  %7.1f %7.1f %7.1f %7.1f   %.2f\n", name, t.right_hand_sides, t.factor,
              t.solve, t.sensitivity, t.total, t.total / reference);
}

double reference_iteration(Ordering ordering, const char* name) {
  const ReferenceTimes t = reference_times(random_design(1, 1e-3), ordering);
  print(name, {t.total(), t.factor, t.solve, t.energies, kLoads}, t.total());
  return t.total();
}

void iterations() {
  std::printf("one iteration, ms CPU%28s  factor   solve   sens.   total   ratio\n", "rhs");
  const double natural =
      reference_iteration(Ordering::natural, "CHOLMOD, natural order (reference)");
  reference_iteration(Ordering::amd, "CHOLMOD, AMD");
  using mmc::LoadDefinition, mmc::Support;
  for (int modes : {2, 6, 12}) {
    std::printf("%d + %d vibrations\n", modes, modes);
    const fem::EslSets loads = synthetic_loads(modes, 100);
    print("  inertia, moving root", iteration(loads, {}), natural);
    print("  inertia, moving root, not compressed",
          iteration(loads, {LoadDefinition::inertia, Support::moving_root, false, 0}), natural);
  }
  for (int columns : {1, 4, 100}) {
    std::printf("frozen, far end, 2 + 2 vibrations, %d root columns\n", columns);
    const fem::EslSets loads = synthetic_loads(2, columns);
    print("  compressed", iteration(loads, {LoadDefinition::frozen, Support::far_end, true, 1e-10}),
          natural);
    print("  not compressed",
          iteration(loads, {LoadDefinition::frozen, Support::far_end, false, 0}), natural);
  }
}

void moving_root() {
  std::printf("\nmoving root, one load a time, ms CPU\n");
  std::printf("times   one factorization   refactoring (AMD)   ratio\n");
  const VectorXd design = random_design(1, 1e-3);
  fem::StaticSolver solver(kGrid, kSection);
  for (int k : {1, 2, 4, 8, 20, 100}) {
    std::vector<int> roots;
    for (int t = 0; t < k; ++t) roots.push_back(k > 1 ? 200 - 2 * (t * 100 / (k - 1)) : 0);
    MatrixXd u = MatrixXd::Random(k, solver.n_unknowns());
    const double ours = milliseconds([&] {
      solver.factorize(design);
      solver.solve(u, roots);
    });
    double refactoring = 0;
    for (int root : roots) {
      Reference reference(design, root, Ordering::amd);
      reference.set_loads(1);
      refactoring += milliseconds(
          [&] {
            reference.factorize();
            reference.solve();
          },
          k > 20 ? 1 : 5);
    }
    std::printf("%5d   %17.1f   %17.1f   %.2f\n", k, ours, refactoring, ours / refactoring);
  }
}

}  // namespace

int main(int, char** argv) {
  begin(argv);
  iterations();
  moving_root();
}
