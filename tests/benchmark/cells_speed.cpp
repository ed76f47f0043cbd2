// Prints the cost of a motion on cells: the plate of rotating_plate_v05 with uniform material
// rotates and grows out of its hub at 0.5 m/s, beginning with 0.5 m, in steps of 1 ms.
//
//   cells_speed [columns rows end]
//   cells_speed growth
//
// columns, rows: numbers of cells at the start (200, 40); end [s] (1). Prints the CPU time of
// phases, the counts of Newton's method and the position of the tip. The time of a phase is the CPU
// time of one call, measured on the final mesh, where it is largest, times the number of calls;
// therefore the remaining time is too small. growth: 0.1 s on 100 x 20 to 400 x 80 cells, and
// exponents of the cost.
#include <Eigen/QR>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <vector>

#include "fem/dynamics/motion.h"
#include "tests/benchmark/cpu.h"
#include "tests/support/models.h"

namespace {

using namespace flexmorph;

/// Returns the CPU time [s] of one call: the mean over at least 0.1 s.
template <class F>
double seconds(const F& f) {
  f();
  int n = 0;
  const double start = cpu_seconds();
  do {
    f();
    ++n;
  } while (cpu_seconds() - start < 0.1);
  return (cpu_seconds() - start) / n;
}

/// CPU time of one call of each phase, or of a step [s].
struct Costs {
  double cells = 0;
  double force = 0, tangent = 0, analysis = 0, factor = 0, border = 0, solve = 0, step = 0;
};

void measure(fem::Workspace& model, const fem::State& x, Costs& out) {
  // The weights are those of generalized-alpha with ρ = 0.8 at this step.
  const double h = 1e-3, beta_h2 = h * h * 0.25 * (1 + 0.2 / 1.8) * (1 + 0.2 / 1.8);
  fem::Constraints c;
  model.constraints(x, c);
  VectorXd force, y;
  fem::SparseMatrix a;
  const fem::Weights w{1, 0.5 * h / beta_h2, 1 / beta_h2};
  out.force = seconds([&] { model.force(x, force); });
  out.tangent = seconds([&] { model.kkt(x, c, w, beta_h2, a); });
  fem::DirectSolver solver;
  const double both = seconds([&] {
    solver.analyze(a);
    solver.factorize(a);
  });
  out.factor = seconds([&] { solver.factorize(a); });
  out.analysis = both - out.factor;
  out.border = seconds([&] {
    model.renew_kkt(x, c, w, beta_h2, solver.border(), a);
    solver.renew_border(a, {});
  });
  const VectorXd right = VectorXd::LinSpaced(a.rows(), -1, 1);
  out.solve = seconds([&] { solver.solve(a, right, y, false); });
}

Costs run(int columns, int rows, double end) {
  testing::RotatingPlate p;
  p.speed = 0.5;
  p.shapes = testing::ShapeSet::q4;
  p.nx = columns;
  p.ny = rows;
  testing::Scene scene = testing::make_scene(p);
  fem::MotionSettings settings;
  settings.end = end;
  const double start = cpu_seconds();
  const fem::MotionResult r =
      fem::integrate(scene.model, scene.moving_roots, settings, [](const fem::MotionStep&) {});
  const double whole = cpu_seconds() - start;
  const fem::StepCounts& n = r.counts;
  const auto events = static_cast<int>(r.events.size());
  const Vec2 tip = testing::in_hub(p, scene.model, r.final, p.tip());
  std::printf(
      "%d x %d cells and %d columns more: %.2f s, %d steps, %d Newton iterations, %d "
      "factorizations, tip in the hub %.9f %.9f\n",
      columns, rows, events, whole, n.steps, n.newton, n.factorizations, tip.x(), tip.y());
  Costs out{.cells = rows * (columns + 0.5 * events), .step = whole / n.steps};
  measure(scene.model, r.final, out);
  double rest = whole;
  const auto row = [&](const char* name, double cost, int calls) {
    rest -= cost * calls;
    std::printf("%-10s %9.2f ms %7d calls %8.2f s\n", name, 1e3 * cost, calls, cost * calls);
  };
  row("force", out.force, n.newton);
  row("solve", out.solve, n.newton);
  row("border", out.border, n.steps - events);
  row("tangent", out.tangent, n.factorizations);
  row("factor", out.factor, n.factorizations);
  row("analysis", out.analysis, events);
  std::printf("%-10s %34.2f s\n", "rest", rest);
  return out;
}

/// Prints the exponents of the costs as functions of the number of cells, by least squares of
/// logarithms.
void growth() {
  std::vector<Costs> all;
  for (const int rows : {20, 40, 80}) all.push_back(run(5 * rows, rows, 0.1));
  const auto row = [&](const char* name, double Costs::*cost) {
    MatrixXd a(all.size(), 2);
    VectorXd b(all.size());
    for (size_t k = 0; k < all.size(); ++k) {
      a.row(static_cast<Eigen::Index>(k)) << 1, std::log(all[k].cells);
      b[static_cast<Eigen::Index>(k)] = std::log(all[k].*cost);
    }
    std::printf("%-10s grows as cells^%.2f\n", name, VectorXd(a.colPivHouseholderQr().solve(b))[1]);
  };
  row("force", &Costs::force);
  row("solve", &Costs::solve);
  row("border", &Costs::border);
  row("tangent", &Costs::tangent);
  row("factor", &Costs::factor);
  row("analysis", &Costs::analysis);
  row("step", &Costs::step);
}

}  // namespace

int main(int count, char** text) {
  flexmorph::benchmark::begin(text);
  if (count > 1 && std::string(text[1]) == "growth") {
    growth();
    return 0;
  }
  run(count > 1 ? std::atoi(text[1]) : 200, count > 2 ? std::atoi(text[2]) : 40,
      count > 3 ? std::atof(text[3]) : 1);
}
