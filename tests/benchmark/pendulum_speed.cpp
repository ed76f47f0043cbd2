// Prints the cost of a plate in space: the plate pendulum of Sun et al. (2018), section 4.1. 0.3 x
// 0.3 x 0.01 m, 7810 kg/m³, ν 0.3, one corner pinned, released from the horizontal under gravity;
// inertia, membrane and bending.
//
//   pendulum_speed [mesh shape dt end E]
//   pendulum_speed growth [shape]
//
// growth: 40 steps with E 1e8 on 8 x 8 to 64 x 64 elements (h16), and exponents of the cost as
// functions of the number of unknowns. mesh: elements per side (8), shape: h12 or h16 (h12), dt and
// end [s] (5e-4, 0.3), E [Pa] (1e5).
//
// Prints the free corner and, for comparison, that of a public plate element with the same energy
// (Exudyn 1.11, ANCFThinPlate, 8 x 8, dt 5e-4: 6.7 ms of CPU time per step), CPU time of phases,
// the counts of Newton's method, the drift of the energy, and memory. The time of a phase is the
// CPU time of one call, measured at the states of 0.1 s, 0.2 s ... and the end, times the number of
// calls; the rest is the remaining time.
#include <sys/resource.h>

#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <vector>

#include "fem/dynamics/integrators/integrator.h"
#include "fem/loads.h"
#include "fem/solve/linear_solver.h"
#include "tests/benchmark/cpu.h"
#include "tests/support/space_plates.h"

namespace {

using namespace flexmorph;
using testing::ShapeSet;

/// Returns the CPU time [s] of one call: the mean over at least 20 ms.
template <class F>
double seconds(const F& f) {
  f();
  int n = 0;
  const double start = cpu_seconds();
  do {
    f();
    ++n;
  } while (cpu_seconds() - start < 0.02);
  return (cpu_seconds() - start) / n;
}

/// CPU time of one call of each phase [s].
struct Phases {
  double force = 0, tangent = 0, factor = 0, solve = 0;
};

Phases measure(fem::Workspace& model, const fem::State& x, double h) {
  // The weights are those of generalized-alpha with ρ = 0.8 at this step.
  const double beta_h2 = h * h * 0.25 * (1 + 0.2 / 1.8) * (1 + 0.2 / 1.8);
  fem::Constraints c;
  model.constraints(x, c);
  VectorXd force;
  fem::SparseMatrix a;
  Phases out;
  out.force = seconds([&] { model.force(x, force); });
  const auto tangent = [&] { model.kkt(x, c, {1, 0, 1 / beta_h2}, beta_h2, a); };
  out.tangent = seconds(tangent);
  const VectorXd scales = model.scales();
  for (int column = 0; column < a.cols(); ++column)
    for (fem::SparseMatrix::InnerIterator entry(a, column); entry; ++entry)
      for (const Eigen::Index k : {entry.row(), entry.col()})
        if (k < model.n_dofs()) entry.valueRef() /= scales[k];
  fem::DirectSolver solver;
  solver.analyze(a);
  out.factor = seconds([&] { solver.factorize(a); });
  if (!solver.is_cholesky() && solver.border().empty()) std::printf("NOT BY CHOLESKY\n");
  const VectorXd right = VectorXd::LinSpaced(a.rows(), -1, 1);
  VectorXd y;
  out.solve = seconds([&] { solver.solve(a, right, y, false); });
  return out;
}

struct Location {
  double t, x, y, z;
};
constexpr Location kPublic[] = {{0.1, 0.30000, 0.30000, -0.049049},
                                {0.2, 0.29568, 0.29568, -0.196177},
                                {0.3, 0.23272, 0.23272, -0.43761}};

fem::Workspace pendulum(int mesh, ShapeSet shapes, double youngs_modulus) {
  testing::SpacePlate plate;
  plate.length = plate.width = 0.3;
  plate.nx = plate.ny = mesh;
  plate.shapes = shapes;
  plate.section = {0.01, youngs_modulus, 0.3, 7810};
  plate.terms = {"inertia", "membrane", "bending"};
  plate.hold({{fem::HoldLocation::at({0, 0}), fem::NodeVector::r, {0, 1, 2}}});
  return plate.model(fem::make_gravity(plate.section, testing::vector(0, 0, -9.81)));
}

/// Costs of a run [s]: per call of a phase (mean over the measured states) and per step.
struct Costs {
  int unknowns = 0;
  Phases one;
  double step = 0;
};

Phases mean(const std::vector<Phases>& at) {
  Phases out;
  const double share = 1.0 / static_cast<double>(at.size());
  for (const Phases& p : at) {
    out.force += share * p.force;
    out.tangent += share * p.tangent;
    out.factor += share * p.factor;
    out.solve += share * p.solve;
  }
  return out;
}

void print(const fem::StepCounts& n, double whole, const Phases& one) {
  std::printf(
      "%d steps, %.3f ms of CPU time each; %d Newton iterations, %d factorizations, %d rejected\n",
      n.steps, 1e3 * whole / n.steps, n.newton, n.factorizations, n.rejected);
  std::printf("%-10s %12s %8s %12s %12s\n", "phase", "us per call", "calls", "ms per step",
              "of all");
  double rest = whole;
  const auto row = [&](const char* name, double cost, int calls) {
    const double sum = cost * calls;
    rest -= sum;
    std::printf("%-10s %12.1f %8d %12.4f %12.3f\n", name, 1e6 * cost, calls, 1e3 * sum / n.steps,
                sum / whole);
  };
  row("force", one.force, n.newton);
  row("tangent", one.tangent, n.factorizations);
  row("factor", one.factor, n.factorizations);
  row("solve", one.solve, n.newton);
  std::printf("%-10s %12s %8s %12.4f %12.3f\n", "rest", "", "", 1e3 * rest / n.steps, rest / whole);
}

Costs run(int mesh, ShapeSet shapes, double h, double end, double youngs_modulus) {
  fem::Workspace model = pendulum(mesh, shapes, youngs_modulus);
  const auto integrator = fem::make_integrator(model, {});
  fem::State x = model.reference();
  double start = cpu_seconds();
  integrator->make_consistent(x);
  std::printf("%d x %d %s, %d unknowns, E %.3g, dt %.3g; start %.1f ms\n", mesh, mesh,
              shapes == ShapeSet::h12 ? "h12" : "h16", model.n_dofs(), youngs_modulus, h,
              1e3 * (cpu_seconds() - start));
  const double energy = model.energies(x).total();
  double whole = 0, drift = 0, largest = 0, asymmetry = 0;
  std::vector<Phases> phases;
  const int steps = static_cast<int>(end / h + 0.5);
  for (int k = 1; k <= steps; ++k) {
    start = cpu_seconds();
    integrator->advance(x, k * h, [](const fem::State&) {});
    whole += cpu_seconds() - start;
    const bool look = k == steps || k % std::max(1, static_cast<int>(0.1 / h + 0.5)) == 0;
    if (!look && k % 10 != 0) continue;
    const fem::Energies e = model.energies(x);
    largest = std::max(largest, e.kinetic);
    drift = std::max(drift, std::abs(e.total() - energy));
    const Vec3 corner = testing::at_point(model, x.q, {0.3, 0.3});
    asymmetry = std::max(asymmetry, std::abs(corner.x() - corner.y()));
    if (!look) continue;
    std::printf("t %.4f  corner %9.6f %9.6f %9.6f", x.t, corner.x(), corner.y(), corner.z());
    for (const Location& p : kPublic)
      if (std::abs(p.t - x.t) < 1e-9) std::printf("   public %9.6f %9.6f %9.6f", p.x, p.y, p.z);
    std::printf("   smallest area ratio %.3f\n", model.smallest_area_ratio(x));
    phases.push_back(measure(model, x, h));
  }
  const Costs out{model.n_dofs(), mean(phases), whole / steps};
  print(integrator->counts(), whole, out.one);
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  std::printf("energy drift %.2e J of %.3g J, |x - y| of the corner %.1e m, peak memory %.0f MB\n",
              drift, largest, asymmetry, static_cast<double>(usage.ru_maxrss) / 1024);
  return out;
}

/// Prints the exponents of the costs as functions of the number of unknowns, by least squares of
/// logarithms.
void growth(ShapeSet shapes) {
  std::vector<Costs> all;
  for (const int mesh : {8, 16, 32, 64}) all.push_back(run(mesh, shapes, 5e-4, 0.02, 1e8));
  const auto row = [&](const char* name, const auto& cost) {
    MatrixXd a(all.size(), 2);
    VectorXd b(all.size());
    for (size_t k = 0; k < all.size(); ++k) {
      a.row(static_cast<Eigen::Index>(k)) << 1, std::log(all[k].unknowns);
      b[static_cast<Eigen::Index>(k)] = std::log(cost(all[k]));
    }
    const VectorXd fit = a.colPivHouseholderQr().solve(b);
    std::printf("%-10s grows as unknowns^%.2f\n", name, fit[1]);
  };
  row("force", [](const Costs& c) { return c.one.force; });
  row("tangent", [](const Costs& c) { return c.one.tangent; });
  row("factor", [](const Costs& c) { return c.one.factor; });
  row("solve", [](const Costs& c) { return c.one.solve; });
  row("step", [](const Costs& c) { return c.step; });
}

}  // namespace

int main(int count, char** text) {
  flexmorph::benchmark::begin(text);
  const auto number = [&](int k, double otherwise) {
    return count > k ? std::atof(text[k]) : otherwise;
  };
  const auto shapes = [&](const std::string& otherwise) {
    const std::string name = count > 2 ? text[2] : otherwise;
    if (name != "h12" && name != "h16") throw Error::input("shape is h12 or h16");
    return name == "h16" ? ShapeSet::h16 : ShapeSet::h12;
  };
  try {
    if (count > 1 && std::string(text[1]) == "growth")
      growth(shapes("h16"));
    else
      run(static_cast<int>(number(1, 8)), shapes("h12"), number(3, 5e-4), number(4, 0.3),
          number(5, 1e5));
  } catch (const Error& error) {
    std::printf("%s\n", error.what());
    return 1;
  }
}
