// CPU time of one whole design iteration of rotating_plate_v05 (400 x 40 cells, 160 components,
// 100 loads): from the variables through TDF, statics and chain rule to the next variables of MMA.
// The loads are those of its own motion, because their rank decides what compression is worth.
// Beside it CHOLMOD's factorization, block solve and energy pass on the same matrix. One thread.
// Prints a table and asserts nothing.

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <vector>

#include "cases/build.h"
#include "cases/motion_run.h"
#include "cases/run.h"
#include "tests/benchmark/reference.h"

namespace {

using namespace flexmorph;
using namespace flexmorph::benchmark;

/// Median CPU per iteration   [ms]
struct Iteration {
  double tdf = 0, factor = 0, solve = 0, sensitivity = 0, optimizer = 0, total = 0;
  int right_hand_sides = 0;
};

double median(std::vector<double> values) {
  std::nth_element(values.begin(), values.begin() + values.size() / 2, values.end());
  return 1e3 * values[values.size() / 2];
}

/// Loads of the motion of the scene's first design.
fem::EslSets loads_of(const cases::Scene& scene, const mmc::BodyProblem& problem) {
  const auto folder = std::filesystem::temp_directory_path() / "flexmorph_design_iteration";
  cases::MotionWishes wishes;
  wishes.factors = {mmc::dynamic_factors(problem, problem.design.components())};
  wishes.loads = true;
  wishes.balance = false;
  cases::RunFolder files(folder.string(), scene, "");
  cases::MotionOutcome motion = cases::run_motion(scene, wishes, files);
  std::filesystem::remove_all(folder);
  return std::move(motion.loads.at(0));
}

/// Iterations of MMA on the design problem; one evaluation each unless a step is refused.
Iteration measure(const cases::Scene& scene, const mmc::BodyProblem& problem,
                  const fem::EslSets& loads, const mmc::ComplianceSettings& settings,
                  VectorXd* stiffness = nullptr) {
  constexpr int kIterations = 25;
  const mmc::Ersatz ersatz(problem.grid, problem.stages.back().alpha, problem.solid, problem.empty);
  const auto start = problem.design.components();
  const mmc::CellFactors first = ersatz.sharp(area_fractions(
      problem.grid, start, problem.stages.back().min_half_thickness, problem.solid, problem.empty));
  mmc::Compliance compliance(loads, problem.section, settings, first.stiffness, first.mass);
  mmc::MmcProblem state(problem.grid, problem.design, ersatz, compliance, problem.stages.front(),
                        problem.max_volume);
  optim::Settings optimizer = scene.optimizer;
  optimizer.max_iterations = kIterations;
  std::vector<double> tdf, factor, solve, sensitivity, mma, total;
  double mark = mmc::cpu_seconds();
  int evaluations = 0;
  optim::make_optimizer(optimizer)->minimize(state, [&](const optim::Iterate& iterate) {
    const double now = mmc::cpu_seconds();
    if (iterate.evaluations == evaluations + 1 && iterate.iteration > 2) {
      const mmc::Compliance::Seconds s = state.seconds();
      tdf.push_back(state.seconds_tdf());
      factor.push_back(s.factor);
      solve.push_back(s.solve);
      sensitivity.push_back(s.sensitivity);
      mma.push_back(iterate.seconds);
      total.push_back(now - mark);
    }
    evaluations = iterate.evaluations;
    mark = mmc::cpu_seconds();
    return true;
  });
  if (stiffness) *stiffness = state.factors().stiffness;
  return {median(tdf),
          median(factor),
          median(solve),
          median(sensitivity),
          median(mma),
          median(total),
          compliance.n_right_hand_sides()};
}

void print(const char* name, const Iteration& t, double reference) {
  std::printf("%-34s %4d %7.1f %7.1f %7.1f %7.1f %7.1f %7.1f  %5.2f   %4.1f %%\n", name,
              t.right_hand_sides, t.tdf, t.factor, t.solve, t.sensitivity, t.optimizer, t.total,
              t.total / reference, 100 * (t.tdf + t.optimizer) / t.total);
}

}  // namespace

int main() {
  use_one_thread();
  const io::CaseFile file(cases::find_case("rotating_plate_v05"));
  const cases::Scene scene = cases::read_scene(file);
  const mmc::BodyProblem problem = cases::build_problems(scene).at(0);
  const fem::EslSets loads = loads_of(scene, problem);

  using mmc::LoadDefinition, mmc::Support;
  VectorXd stiffness;
  const Iteration compressed = measure(scene, problem, loads, {}, &stiffness);
  const ReferenceTimes natural = reference_times(stiffness, Ordering::natural);
  const ReferenceTimes amd = reference_times(stiffness, Ordering::amd);
  const double reference = std::min(natural.total(), amd.total());
  std::printf(
      "CPU ms per design iteration%12s     tdf  factor   solve   sens.     mma   total"
      "  ratio   tdf + mma\n",
      "rhs");
  for (const auto& [name, t] :
       {std::pair{"CHOLMOD, natural order", natural}, std::pair{"CHOLMOD, AMD", amd}}) {
    print(name, {0, t.factor, t.solve, t.energies, 0, t.total(), kLoads}, reference);
  }
  print("inertia, moving root", compressed, reference);
  print("  not compressed",
        measure(scene, problem, loads, {LoadDefinition::inertia, Support::moving_root, false}),
        reference);
  print("frozen, moving root",
        measure(scene, problem, loads, {LoadDefinition::frozen, Support::moving_root}), reference);
  const Iteration few =
      measure(scene, problem, loads, {LoadDefinition::frozen, Support::far_end, true});
  const Iteration all =
      measure(scene, problem, loads, {LoadDefinition::frozen, Support::far_end, false});
  print("frozen, far end", few, reference);
  print("  not compressed", all, reference);
  std::printf("compression of frozen loads at the far end: %.2f times faster\n",
              all.total / few.total);
}
