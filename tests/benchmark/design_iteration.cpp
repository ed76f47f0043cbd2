// Prints the CPU time of one complete design iteration of rotating_plate_v05 (400 x 40 cells, 160
// components, 100 loads): from the variables through TDF, static analysis and chain rule to the
// next variables of MMA. The loads are those of its own motion, because their rank determines the
// benefit of compression. For comparison it prints CHOLMOD's factorization, block solve and energy
// pass with the same matrix. One thread. It checks nothing.

#include <algorithm>
#include <cstdio>
#include <vector>

#include "cases/assembly/build.h"
#include "cases/check/ready.h"
#include "cases/run/motion_run.h"
#include "tests/benchmark/cpu.h"
#include "tests/benchmark/iteration.h"
#include "tests/benchmark/reference.h"

namespace {

using namespace flexmorph;
using namespace flexmorph::benchmark;

/// Median CPU per iteration   [ms]
/// Returns the loads of the motion of the scene's first design.
fem::EslSets loads_of(const cases::Scene& scene, const mmc::BodyProblem& problem) {
  cases::MotionRequest request;
  request.factors = {mmc::dynamic_factors(problem, problem.design.components())};
  request.loads = true;
  request.balance = false;
  return std::move(cases::run_motion(cases::PreparedCase(scene), request).loads.at(0));
}

/// Measures iterations of MMA on the design problem; each has one evaluation unless a step is
/// refused.
Iteration measure(const cases::Scene& scene, const mmc::BodyProblem& problem,
                  const fem::EslSets& loads, const mmc::ComplianceSettings& settings,
                  VectorXd* stiffness) {
  constexpr int kIterations = 25;
  const mmc::Ersatz ersatz(problem.grid, problem.bands.back().alpha, problem.solid, problem.empty);
  const auto start = problem.design.components();
  const mmc::CellScaleFactors first = ersatz.crisp(area_fractions(
      problem.grid, start, problem.bands.back().min_half_thickness, problem.solid, problem.empty));
  mmc::ComplianceEvaluator compliance(loads, problem.section, settings, first.stiffness,
                                      first.mass);
  const mmc::Plate plate = mmc::plate_of(problem);
  mmc::MmcProblem state({plate, problem.design, ersatz, compliance}, problem.bands.front(),
                        problem.goal);
  optim::Settings optimizer = scene.optimizer;
  optimizer.max_iterations = kIterations;
  const Iteration out = measure_iterations(state, optimizer, compliance.n_right_hand_sides());
  *stiffness = state.factors().stiffness;
  return out;
}

void print(const char* name, const Iteration& t, double reference) {
  std::printf("%-34s %4d %7.1f %7.1f %7.1f %7.1f %7.1f %7.1f  %5.2f   %4.1f %%\n", name,
              t.right_hand_sides, t.tdf, t.factor, t.solve, t.sensitivity, t.optimizer, t.total,
              t.total / reference, 100 * (t.tdf + t.optimizer) / t.total);
}

/// The measurements of one scene: all load definitions with and without compression.
struct Bench {
  cases::Scene scene;
  mmc::BodyProblem problem;
  fem::EslSets loads;

  explicit Bench(const std::vector<std::string>& changes)
      : scene(cases::read_scene(io::CaseFile(cases::find_case("rotating_plate_v05"), changes))),
        problem(cases::build_problems(scene).at(0)),
        loads(loads_of(scene, problem)) {}

  Iteration measure(mmc::LoadDefinition definition, mmc::Support support, bool compress) {
    return ::measure(scene, problem, loads, {definition, support, compress}, &stiffness);
  }
  VectorXd stiffness;  // scale factors of the last measured design
};

void compare(Bench& bench, mmc::LoadDefinition definition, mmc::Support support, const char* name,
             double reference) {
  const Iteration few = bench.measure(definition, support, true);
  const Iteration all = bench.measure(definition, support, false);
  print(name, few, reference);
  print("  not compressed", all, reference);
  std::printf("  gain %.2f\n", all.total / few.total);
}

}  // namespace

int main(int, char** argv) {
  begin(argv);
  using mmc::LoadDefinition, mmc::Support;
  Bench growing({});
  growing.measure(LoadDefinition::inertia, Support::moving_root, true);
  const ReferenceTimes natural = reference_times(growing.stiffness, Ordering::natural);
  const ReferenceTimes amd = reference_times(growing.stiffness, Ordering::amd);
  const double reference = std::min(natural.total(), amd.total());
  std::printf(
      "CPU ms per design iteration%12s     tdf  factor   solve   sens.     mma   total"
      "  ratio   tdf + mma\n",
      "rhs");
  for (const auto& [name, t] :
       {std::pair{"CHOLMOD, natural order", natural}, std::pair{"CHOLMOD, AMD", amd}})
    print(name, {0, t.factor, t.solve, t.energies, 0, t.total(), kLoads}, reference);
  compare(growing, LoadDefinition::inertia, Support::moving_root, "inertia, moving root",
          reference);
  compare(growing, LoadDefinition::frozen, Support::far_end, "frozen, far end", reference);
  // Every location of the root and every shape of the growing element has loads of its own:
  // compression is useful for plates that do not grow.
  std::printf("the same plate, as long as it gets but not growing\n");
  Bench still({"body.flow.speed=0", "body.length=1.0"});
  compare(still, LoadDefinition::inertia, Support::moving_root, "inertia, root at rest", reference);
  compare(still, LoadDefinition::frozen, Support::far_end, "frozen, far end", reference);
}
