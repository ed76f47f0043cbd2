// Prints the CPU time of one complete design iteration of a static plate, a cantilever with the
// settings of short_beam: from the variables through TDF, ersatz material, static analysis and
// chain rule to the next variables of MMA. One core. It checks nothing.
//
//   plate_iteration [large]
//
// Without an argument: 400 x 80 cells with 672 variables under 1, 20 and 100 loads, compared with
// CHOLMOD (factorization, solve of all right-hand sides, one pass for the energies) on the matrix
// of the same design; and the two sizes of the published program. With `large`: 1600 x 320 cells,
// 20 loads.

#include <sys/resource.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <numbers>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "geometry/components/component.h"
#include "optim/mmc/loads/compliance_evaluator.h"
#include "optim/mmc/problem/mmc_problem.h"
#include "optim/optimizer.h"
#include "tests/benchmark/cpu.h"
#include "tests/benchmark/iteration.h"
#include "tests/benchmark/reference.h"

namespace {

using namespace flexmorph;
using namespace flexmorph::benchmark;

const fem::PlaneSection kUnit{1, 1, 0.3, 0};

/// The measured plate: a cantilever clamped at its left edge.
struct Plate {
  Grid grid;
  int boxes_x, boxes_y;  // each box has two crossing components
};
const Plate kStrip{{.width = 5, .height = 1, .nx = 400, .ny = 80}, 24, 2};
const Plate kPublishedStrip{{.width = 5, .height = 1, .nx = 400, .ny = 80}, 10, 2};
const Plate kShortBeam{{.width = 2, .height = 1, .nx = 80, .ny = 40}, 4, 2};
const Plate kLarge{{.width = 5, .height = 1, .nx = 1600, .ny = 320}, 24, 2};

/// Returns a unit force at mid-height of the free end.
std::vector<mmc::LoadCase> tip_load(const Grid& g) {
  return {{"tip", 1, {{g.node(g.nx, g.ny / 2), Vec2(0, -1)}}}};
}

/// Returns a unit load that moves along the upper edge from the clamp to the free end, at n
/// locations. It has a bell-shaped distribution (standard deviation: a third of the height), as the
/// force of a wheel under a rail has: its many locations span few directions.
std::vector<mmc::LoadCase> moving_load(const Grid& g, int n) {
  const double deviation = g.height / 3;
  std::vector<mmc::LoadCase> out;
  for (int l = 0; l < n; ++l) {
    const double centre = g.x0 + g.width * l / (n - 1);
    mmc::LoadCase load{std::to_string(l), 1.0 / n, {}};
    for (int i = 0; i <= g.nx; ++i) {
      const double s = (g.node_position(i, g.ny).x() - centre) / deviation;
      const double share = std::exp(-0.5 * s * s) / std::sqrt(2 * std::numbers::pi) / deviation;
      load.forces.push_back({g.node(i, g.ny), Vec2(0, -share * g.dx())});
    }
    out.push_back(std::move(load));
  }
  return out;
}

/// Median CPU per iteration   [ms]
std::vector<fem::HeldUnknown> clamped_left(const Grid& g) {
  std::vector<fem::HeldUnknown> held;
  for (int j = 0; j <= g.ny; ++j)
    for (int c = 0; c < 2; ++c) held.push_back({g.node(0, j), c});
  return held;
}

/// Returns a design with the settings of short_beam on another mesh.
mmc::Design initial_design(const Plate& plate, double min_thickness) {
  const Grid& g = plate.grid;
  const double wide = g.width / plate.boxes_x, high = g.height / plate.boxes_y;
  const double diagonal = std::hypot(wide, high);
  const double thickness = std::max(min_thickness, 0.1 * wide * high / diagonal);
  return {g,
          crossing_layout(g.x0, g.y0, g.width, g.height, plate.boxes_x, plate.boxes_y, thickness,
                          0.5 * diagonal),
          {0.5 * diagonal, min_thickness, 0.3 * g.height}};
}

/// Measures iterations of MMA with one evaluation each, without the first two.
Iteration measure(const Plate& plate, const std::vector<mmc::LoadCase>& loads, bool compress,
                  VectorXd* stiffness = nullptr, int iterations = 17) {
  const Grid& g = plate.grid;
  const double cell = g.dx();
  TdfSettings tdf;
  tdf.band = 1.5 * cell;
  tdf.sharpness = 3.75 / cell;
  tdf.min_half_thickness = cell;
  const mmc::Ersatz ersatz(g, tdf.alpha, {}, {});
  const mmc::Design design = initial_design(plate, cell);
  mmc::ComplianceEvaluator statics({g, kUnit, {}}, clamped_left(g), loads, compress);
  const mmc::Plate whole{g, kUnit, {}};
  const mmc::Goal goal{.limits = {{mmc::kVolume, 0.4, false, whole}}};
  mmc::MmcProblem problem({whole, design, ersatz, statics}, tdf, goal);
  optim::Settings settings;
  settings.max_iterations = iterations;
  const Iteration out = measure_iterations(problem, settings, statics.n_right_hand_sides());
  if (stiffness) *stiffness = problem.factors().stiffness;
  return out;
}

void print(const std::string& name, const Iteration& t, double reference) {
  std::printf("%-34s %4d %7.1f %7.1f %7.1f %7.1f %7.1f %8.1f  %5.2f\n", name.c_str(),
              t.right_hand_sides, t.tdf, t.factor, t.solve, t.sensitivity, t.optimizer, t.total,
              t.total / reference);
}

/// Prints the times of CHOLMOD with each of its orderings. @returns the least total
double print_reference(const VectorXd& stiffness, int n_loads) {
  double least = 1e300;
  for (const auto& [name, ordering] :
       {std::pair{"CHOLMOD, AMD", Ordering::amd}, std::pair{"CHOLMOD, METIS", Ordering::metis},
        std::pair{"CHOLMOD, its own choice", Ordering::best}}) {
    const ReferenceTimes t = reference_times(stiffness, ordering, n_loads, kStrip.grid, kUnit);
    print(name, {0, t.factor, t.solve, t.energies, 0, t.total(), n_loads}, t.total());
    least = std::min(least, t.total());
  }
  return least;
}

void against_cholmod() {
  std::printf("400 x 80 cells, 672 variables: CPU ms per design iteration, least CHOLMOD = 1\n");
  std::printf("%38s     tdf  factor   solve   energ.    mma    total  ratio\n", "rhs");
  double twenty = 0;
  for (const int n : {1, 20, 100}) {
    const auto loads = n == 1 ? tip_load(kStrip.grid) : moving_load(kStrip.grid, n);
    VectorXd stiffness;
    const Iteration all = measure(kStrip, loads, false, &stiffness);
    if (n == 20) twenty = all.total;
    const double reference = print_reference(stiffness, n);
    print(std::to_string(n) + (n == 1 ? " load" : " loads"), all, reference);
    if (n == 100) {
      const Iteration few = measure(kStrip, loads, true);
      print("100 loads, compressed", few, reference);
      std::printf("100 compressed loads / 20 loads: %.2f\n", few.total / twenty);
    }
  }
}

/// Compares with the seconds per iteration of the published program in Octave, for one load.
void against_published() {
  std::printf("\none load: CPU ms per design iteration, published program in Octave = 1\n");
  for (const auto& [name, plate, published] :
       {std::tuple{"80 x 40, 16 components", kShortBeam, 230.0},
        std::tuple{"400 x 80, 40 components", kPublishedStrip, 3330.0}})
    print(name, measure(plate, tip_load(plate.grid), true, nullptr, 41), published);
}

void large() {
  const Iteration t = measure(kLarge, moving_load(kLarge.grid, 20), false, nullptr, 5);
  std::printf("1600 x 320 cells, 672 variables: CPU ms per design iteration, 6 s = 1\n");
  print("20 loads", t, 6000);
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  std::printf("peak memory %.2f GB\n", static_cast<double>(usage.ru_maxrss) / (1024 * 1024));
}

}  // namespace

int main(int argc, char** argv) {
  begin(argv);
  if (argc > 1 && std::strcmp(argv[1], "large") == 0) {
    large();
    return 0;
  }
  against_cholmod();
  against_published();
}
