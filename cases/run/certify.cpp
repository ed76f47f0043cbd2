#include <cstdio>
#include <nlohmann/json.hpp>

#include "cases/results/correction_messages.h"
#include "cases/results/run_json.h"
#include "cases/run/corrections.h"
#include "cases/run/finished_run.h"
#include "cases/run/motions.h"
#include "io/case_files/case_file.h"
#include "io/case_files/case_parser.h"
#include "io/files.h"
#include "io/json.h"

namespace flexmorph::cases {
namespace {

/// Returns the scene of a finished run, whose designs start from the final designs of the run.
/// @throws Error (input) if there is no such run.
Scene finished_scene(const CertifyOptions& options) {
  const std::string kept = finished_case(options.directory);
  const Scene first = read_scene(io::CaseFile(kept, options.overrides));
  if (first.designs.empty() || first.domain)
    throw Error::input("'" + options.directory +
                       "' has no design of a moving body. An optimality certificate is computed "
                       "only for designs of moving bodies");
  std::vector<std::string> changes = options.overrides;
  for (std::string& each : changes_to_designs(options.directory, first))
    changes.push_back(std::move(each));
  if (!first.certify)
    changes.push_back("certificate.checkpoints=" + std::to_string(Certify().checkpoints));
  return read_scene(io::CaseFile(kept, changes));
}

/// Computes the equivalent static loads of the motion with the given designs.
std::vector<fem::EslSets> loads_of(const RunContext& run,
                                   const std::vector<mmc::BodyProblem>& problems) {
  MotionRequest request = resumable_request(run, "motion", "motion_certified.csv");
  request.checkpoint.clear();
  for (const mmc::BodyProblem& p : problems)
    request.factors.push_back(mmc::dynamic_factors(p, p.design.components()));
  request.loads = true;
  request.balance = false;
  run.progress.begin(request.phase);
  return run_motion(run.prepared, request, run.folder).loads;
}

}  // namespace

int certify_run(const CertifyOptions& options) {
  const PreparedCase prepared(finished_scene(options));
  const Scene& scene = prepared.scene();
  RunFolder folder(options.directory, scene, false, RunFolder::Begin::keep_running);
  Progress progress(options.quiet);
  const RunContext run{prepared, &folder, progress, [] { return true; }};
  const std::vector<mmc::BodyProblem>& problems = prepared.design_problems();
  const mmc::OptimalityCertificate certificate =
      certify_by_motion(run, *scene.certify, loads_of(run, problems), problems);
  const std::string path = folder.file("run.json");
  nlohmann::ordered_json results = nlohmann::ordered_json::parse(io::read_text(path));
  results["certificate"] = nlohmann::ordered_json::parse(certificate_json(certificate));
  io::write_file(path, io::json_text(results));
  folder.finish();
  if (options.quiet) std::printf("%s\n", certificate_text(certificate).c_str());
  return 0;
}

}  // namespace flexmorph::cases
