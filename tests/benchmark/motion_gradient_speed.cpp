// Prints the cost of the gradient of a motion; started by hand: CPU seconds and peak memory for the
// growing, rotating plate on the cells of its design's start layout, for the motion only, for the
// motion with an energy balance, and for the strain energy at its load times with all derivatives.
//
//   motion_gradient_speed <cell [m]> <step [s]> <what> [objectives [checkpoints [end [s]]]]
//
// what: motion, balance or gradient. Each needs a process of its own, because of the memory. With 3
// objectives: also the deflection, and the force at the root.
#include <sys/resource.h>

#include <cstdio>
#include <cstdlib>
#include <string>

#include "cases/assembly/build.h"
#include "fem/dynamics/gradients/motion_gradient.h"
#include "tests/benchmark/cpu.h"

namespace {

using namespace flexmorph;
using namespace flexmorph::cases;

std::vector<fem::MotionObjective> objectives_of(const Scene& scene, const Mechanism& m, size_t n) {
  using Times = fem::MotionObjective::Times;
  const fem::MovingRoot& g = m.moving_roots.at(0);
  std::vector<fem::MotionObjective> out = {
      {fem::measure_strain_energy(), Times::stops, 1},
      {fem::measure_deflection(g.body, {scene.body(g.body).longest(scene.time.end), 0}, g.hub),
       Times::steps, 8},
      {fem::measure_joint_force(m.model.joints().at(0)->name(), g.body), Times::steps, 8}};
  out.resize(std::min(n, out.size()));
  return out;
}

void measure(const std::string& cell, double step, const std::string& what, size_t n_objectives,
             int checkpoints, double end) {
  const Scene scene =
      read_scene(io::CaseFile(std::string(FLEXMORPH_CASES) + "/rotating_plate_v05.toml",
                              std::vector<std::string>{"design.cell=" + cell}));
  Mechanism m = build_mechanism(scene, {.elements = {}, .refine = 1, .cells = 1});
  set_step(scene, step, m.motion);
  const mmc::BodyProblem problem = build_problems(scene).front();
  m.model.set_factors(m.model.bodies()[0],
                      mmc::dynamic_factors(problem, problem.design.components()));
  m.motion.stops = load_times(scene);
  m.motion.end = std::min(end, m.motion.end);
  m.motion.balance = what == "balance";
  const double start = cpu_seconds();
  fem::StepCounts counts;
  if (what == "gradient") {
    const auto objectives = objectives_of(scene, m, n_objectives);
    const fem::MotionGradients g =
        fem::motion_gradients(m.model, m.moving_roots, m.motion, objectives,
                              {.checkpoints = checkpoints, .parameters = {}});
    counts = g.motion.counts;
    std::printf("motion %.2f s, adjoint %.2f s: %d factorizations, %d iterations; ",
                g.seconds_motion, g.seconds_adjoint, g.factorizations, g.iterations);
    for (const fem::MotionGradient& of : g.of)
      std::printf("J %.12g |dJ| %.9g; ", of.value,
                  std::hypot(of.d_factors[0].stiffness.norm(), of.d_factors[0].mass.norm()));
  } else {
    counts =
        fem::integrate(m.model, m.moving_roots, m.motion, [](const fem::MotionStep&) {}).counts;
  }
  rusage used{};
  getrusage(RUSAGE_SELF, &used);
  std::printf(
      "%s: %.2f s, %ld MB; motion of %d steps, %d iterations, %d factorizations, %d unknowns\n",
      what.c_str(), cpu_seconds() - start, used.ru_maxrss / 1024, counts.steps, counts.newton,
      counts.factorizations, m.model.n_dofs());
}

}  // namespace

int main(int argc, char** argv) {
  flexmorph::benchmark::begin(argv);
  if (argc < 4) {
    std::puts(
        "motion_gradient_speed <cell> <step> motion | balance | gradient [objectives "
        "[checkpoints [end]]]");
    return 2;
  }
  measure(argv[1], std::atof(argv[2]), argv[3],
          argc > 4 ? static_cast<size_t>(std::atoi(argv[4])) : 1, argc > 5 ? std::atoi(argv[5]) : 0,
          argc > 6 ? std::atof(argv[6]) : 1.0);
}
