#include "tests/benchmark/compared_case.h"

#include <filesystem>
#include <utility>

#include "cases/assembly/build.h"
#include "cases/assembly/verified_loads.h"
#include "cases/check/ready.h"
#include "cases/run/motion_run.h"
#include "geometry/cpu_time.h"
#include "optim/mmc/cycles/body_design.h"
#include "optim/mmc/cycles/design_verification.h"

namespace flexmorph::benchmark {
namespace {

cases::Scene scene_of(const std::string& path, std::span<const std::string> changes) {
  const bool is_file = std::filesystem::exists(path);
  return cases::read_scene(io::CaseFile(is_file ? path : cases::find_case(path), changes));
}

fem::EslSets loads_of_motion(const cases::Scene& scene, const mmc::BodyProblem& problem) {
  cases::MotionRequest request;
  request.factors = {mmc::dynamic_factors(problem, problem.design.components())};
  request.loads = true;
  request.balance = false;
  return std::move(cases::run_motion(cases::PreparedCase(scene), request).loads.at(0));
}

}  // namespace

ComparedCase::ComparedCase(const std::string& path, std::span<const std::string> changes)
    : scene(scene_of(path, changes)), problem(cases::build_problems(scene).at(0)) {
  if (scene.domain) {
    loads = cases::build_static_loads(scene, problem);
    by_position = cases::loads_by_position(scene, problem);
    return;
  }
  sets = loads_of_motion(scene, problem);
  const mmc::CellScaleFactors first =
      mmc::ersatz_of(problem).crisp(mmc::fractions_of(problem, problem.design.components()));
  loads = std::make_unique<mmc::ComplianceEvaluator>(sets, problem.section, problem.compliance,
                                                     first.stiffness, first.mass);
  by_position = mmc::loads_by_position(problem, sets);
}

double ComparedCase::domain_area() const {
  const Grid& g = problem.grid;
  return mmc::plate_of(problem).n_domain_cells() * g.dx() * g.dy();
}

ComparedDesign compared(const ComparedCase& of, std::vector<Region> regions, double seconds) {
  ComparedDesign out;
  const double cell = mmc::point_reach(of.problem);
  verification::VerificationSettings settings;
  settings.tolerance = kVerificationTolerance;
  settings.size = 2 * cell;
  settings.reach = cell;
  out.verdict = verification::verify_outline(regions, of.problem.section, of.by_position, settings);
  out.volume = area(regions) / of.domain_area();
  const Features features = mmc::features_of(of.problem, regions);
  out.feature = features.solid;
  out.gap = features.gap;
  out.seconds = seconds;
  out.regions = std::move(regions);
  return out;
}

ComparedDesign design_by_components(ComparedCase& of) {
  const double clock = cpu_seconds();
  bool is_running = true;
  const mmc::DesignSettings settings{0, of.scene.optimizer, false, nullptr};
  mmc::design_body(
      of.problem, *of.loads, 1, settings, [](const auto&) { return true; }, is_running);
  const double seconds = cpu_seconds() - clock;
  return compared(of, mmc::exported_regions(of.problem), seconds);
}

}  // namespace flexmorph::benchmark
