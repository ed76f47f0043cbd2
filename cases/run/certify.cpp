#include <cstdio>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "cases/results/run_json.h"
#include "cases/run/corrections.h"
#include "cases/run/motions.h"
#include "cases/run/run.h"
#include "io/case_file.h"
#include "io/case_parser.h"
#include "io/files.h"
#include "io/json.h"

namespace flexmorph::cases {
namespace {

namespace fs = std::filesystem;

/// The case of a finished run with its designs in place of their starts.
/// @throws Error (input) where there is no such run.
Scene finished_scene(const CertifyOptions& options) {
  const std::string directory = fs::absolute(options.directory).string();
  const std::string kept = directory + "/case.toml", results = directory + "/run.json";
  for (const std::string& path : {kept, results})
    if (!fs::is_regular_file(path))
      throw Error::input("'" + options.directory + "' is no finished run: it has no " +
                         fs::path(path).filename().string());
  const nlohmann::json run = nlohmann::json::parse(io::read_text(results));
  if (const std::string status = run.value("status", ""); !status.starts_with("done"))
    throw Error::input("'" + options.directory + "' is no finished run: its status is \"" + status +
                       "\"");
  const Scene first = read_scene(io::CaseFile(kept, options.overrides));
  if (first.designs.empty() || first.domain)
    throw Error::input("'" + options.directory +
                       "' has no design that moves: there is nothing to certify");
  std::vector<std::string> changes = options.overrides;
  for (size_t d = 0; d < first.designs.size(); ++d) {
    const std::string name = components_name(first, first.designs[d].body);
    changes.push_back("design." + std::to_string(d) + ".start='" + directory + "/" + name + "'");
  }
  if (!first.certify)
    changes.push_back("certificate.checkpoints=" + std::to_string(Certify().checkpoints));
  return read_scene(io::CaseFile(kept, changes));
}

/// Loads of the motion with the designs as they are.
std::vector<fem::EslSets> loads_of(const Scene& scene, const RunReport& report, RunFolder& folder,
                                   Progress& progress) {
  MotionWishes wishes;
  for (const mmc::BodyProblem& p : report.problems)
    wishes.factors.push_back(mmc::dynamic_factors(p, p.design.components()));
  wishes.loads = true;
  wishes.balance = false;
  wishes.table = "motion_certified.csv";
  wishes.way = way_of(progress, scene, wishes.phase);
  progress.begin(wishes.phase);
  return run_motion(scene, wishes, folder).loads;
}

}  // namespace

int certify_run(const CertifyOptions& options) {
  const Scene scene = finished_scene(options);
  RunFolder folder(options.directory, scene, false, RunFolder::Begin::go_on);
  Progress progress(options.quiet);
  RunReport report;
  report.problems = build_problems(scene);
  const std::vector<fem::EslSets> loads = loads_of(scene, report, folder, progress);
  certify_by_motion(
      scene, *scene.certify, loads, [] { return true; }, folder, progress, report);
  const std::string path = folder.file("run.json");
  nlohmann::ordered_json run = nlohmann::ordered_json::parse(io::read_text(path));
  run["certificate"] = nlohmann::ordered_json::parse(certificate_json(*report.certificate));
  io::write_file(path, io::json_text(run));
  folder.finish();
  if (options.quiet) std::printf("%s\n", certificate_words(*report.certificate).c_str());
  return 0;
}

}  // namespace flexmorph::cases
