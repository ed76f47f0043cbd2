#include "cases/run/verify_part.h"

#include <algorithm>
#include <filesystem>

#include "cases/assembly/drawn_part.h"
#include "cases/check/ready.h"
#include "cases/output/kept_case.h"
#include "cases/output/paraview_script.h"
#include "cases/results/parts/part_checks.h"
#include "cases/results/warnings.h"
#include "cases/run/finished_run.h"
#include "cases/run/run.h"
#include "geometry/text.h"
#include "io/files.h"
#include "io/tables.h"

namespace flexmorph::cases {
namespace {

namespace fs = std::filesystem;

/// A part that is given on the command line: the body and the path of the drawing.
struct GivenPart {
  std::string body, path;
};

/// Reads the parts from the options.
/// @throws Error (input) for an option that is not BODY=FILE, and for a repeated body
std::vector<GivenPart> given_parts(const std::vector<std::string>& options) {
  std::vector<GivenPart> out;
  for (const std::string& each : options) {
    const size_t at = each.find('=');
    if (at == std::string::npos || at == 0 || at + 1 == each.size())
      throw Error::input("--part " + each +
                         ": a part has the form BODY=FILE, for example plate=part.dxf");
    GivenPart part{each.substr(0, at), each.substr(at + 1)};
    if (std::any_of(out.begin(), out.end(),
                    [&](const GivenPart& other) { return other.body == part.body; }))
      throw Error::input("--part " + each + ": the body '" + part.body +
                         "' has two parts; give one part for each body");
    out.push_back(std::move(part));
  }
  return out;
}

/// The given case. `run` is the folder of the finished run from which its designs come; it is empty
/// if the user gave a case.
struct GivenCase {
  io::CaseFile file;
  Scene scene;
  std::string run;
};

/// Reads the case for the verification. Designs of moving bodies are verified by a motion on their
/// cells, unless the case has another [verify] or does not allow a motion on cells.
Scene read_verified(const std::string& path, std::vector<std::string> changes) {
  Scene plain = read_scene(io::CaseFile(path, changes));
  if (plain.domain || plain.verify || plain.designs.empty()) return plain;
  changes.emplace_back("verify.cells=1");
  try {
    return read_scene(io::CaseFile(path, changes));
  } catch (const Error&) {  // motion_notes() reports that there is no motion on cells
    return plain;
  }
}

/// Reads the given case or finished run and switches off optimization, corrections and certificate.
/// @throws Error (input) for a case that cannot be read, or a folder without a finished run
GivenCase given_case(const VerifyOptions& options) {
  const bool is_run = fs::is_directory(options.case_name);
  if (!fs::exists(options.case_name) && options.case_name.find('/') != std::string::npos)
    throw Error::input("'" + options.case_name +
                       "': there is no run folder or case file of this name");
  const std::string path = is_run ? finished_case(options.case_name) : find_case(options.case_name);
  std::vector<std::string> changes = options.overrides;
  io::CaseFile file(path, changes);
  if (is_run)
    for (std::string& each : changes_to_designs(options.case_name, read_scene(file)))
      changes.push_back(std::move(each));
  GivenCase out{std::move(file), read_verified(path, changes),
                is_run ? options.case_name : std::string()};
  Scene& scene = out.scene;
  scene.optimizer.max_iterations = 0;
  scene.cycle.correction = {};
  scene.certify.reset();
  for (BodyDesign& design : scene.designs) {
    design.jitter = 0;
    design.starts = 1;
  }
  return out;
}

std::vector<std::string> bodies_of(const Scene& scene) {
  std::vector<std::string> out;
  for (const BodyDesign& design : scene.designs) out.push_back(design.body);
  return out;
}

/// Returns the scene in which parts replace designs.
/// @throws Error (input) for bodies without a design, parts that cannot be read, and designed
///         bodies that have neither a part nor a design
Scene with_parts(const GivenCase& given, const std::vector<GivenPart>& parts) {
  Scene out = given.scene;
  for (const GivenPart& part : parts) {
    const auto design = std::find_if(out.designs.begin(), out.designs.end(),
                                     [&](const BodyDesign& d) { return d.body == part.body; });
    if (design == out.designs.end())
      throw Error::input("--part " + part.body + "=" + part.path + ": the case has no design of '" +
                         part.body + "'" +
                         (out.designs.empty()
                              ? std::string()
                              : "; the designed bodies are " + joined(bodies_of(out))));
    DrawnPart drawn = read_part(part.path, given.scene, *design);
    design->part = std::move(drawn.regions);
    out.notes.insert(out.notes.end(), drawn.notes.begin(), drawn.notes.end());
  }
  for (const BodyDesign& design : out.designs)
    if (!design.part && design.start.empty())
      throw Error::input("the body '" + design.body +
                         "' has neither a part nor a finished design. Give a part with --part " +
                         design.body +
                         "=FILE, or give the folder of a finished run instead of the case");
  return out;
}

std::string directory_of(const VerifyOptions& options, const GivenCase& given) {
  if (!options.directory.empty()) return options.directory;
  constexpr const char* kEnding = "_verify";
  if (!given.run.empty()) {
    fs::path run = fs::path(given.run).lexically_normal();
    if (!run.has_filename()) run = run.parent_path();  // of "runs/arm/"
    return run.string() + kEnding;
  }
  const std::string& set = given.scene.output.directory;
  return (set.empty() ? "runs/" + given.scene.name : set) + kEnding;
}

/// Evaluates the design of the finished run in a separate folder, without uniform material and
/// without frames.
EndedRun evaluate_design(const GivenCase& given, const std::string& directory,
                         const VerifyOptions& options, Progress& progress) {
  Scene scene = given.scene;
  scene.output.vtk = false;
  const PreparedCase prepared(std::move(scene));
  RunFolder folder(directory, prepared.scene(), options.threads > 1);
  keep_case(given.file, false, folder);
  const RunClock clock;
  RunFiles files(prepared.scene(), folder, options.threads, clock);
  progress.say("The design of the run " + given.run + " is evaluated.");
  RunContext context{prepared, &folder, progress, keeps_running, options.threads};
  context.uniform = false;
  EndedRun out = run_prepared(context);
  if (out.error) {
    files.write_failed(out.result, "the evaluation of the design did not finish");
    return out;
  }
  out.result = files.write(std::move(out.result), "done", "");
  remove_progress([&](const std::string& ending) { return folder.files_of(ending); });
  return out;
}

/// Copies the drawings of the parts into the folder, and returns a comparison without numbers.
PartComparison begin_comparison(const Scene& scene, const GivenCase& given,
                                const std::vector<GivenPart>& parts, RunFolder& folder) {
  PartComparison out;
  out.design = given.run;
  for (const GivenPart& part : parts) {
    const std::string type = fs::path(part.path).extension().string();
    const std::string name = "inputs/part_" + part.body + type;
    folder.write_text(name, io::read_regular_file(part.path, "a part"));
    out.files.emplace_back(part.body, name);
  }
  out.notes = motion_notes(scene);
  if (given.run.empty())
    out.notes.emplace_back(
        "the part is not compared with a design; for this comparison, give the folder of a "
        "finished run instead of the case");
  return out;
}

void write_numbers(const std::vector<ComparedNumber>& numbers, RunFolder& folder) {
  const std::vector<std::string> columns = {"body", "name", "unit", "part", "design", "uniform"};
  io::CsvWriter csv(folder.file("verify.csv"), columns);
  const auto cell = [](const std::optional<double>& n) { return n ? io::Cell(*n) : io::Cell(); };
  for (const ComparedNumber& n : numbers)
    csv.row({n.body, n.name, n.unit, cell(n.part), cell(n.design), cell(n.uniform)});
}

/// Prints the notes and all numbers, one line each.
void say_numbers(const PartComparison& comparison, Progress& progress) {
  for (const std::string& each : comparison.notes) progress.say(each);
  const std::vector<std::vector<std::string>> rows = comparison_rows(comparison);
  for (size_t k = 1; k < rows.size(); ++k) {
    const std::vector<std::string>& r = rows[k];
    const auto beside = [](const char* what, const std::string& value, const std::string& change) {
      return value.empty() ? ""
                           : std::string(", ") + what + " " + value +
                                 (change.empty() ? "" : " (" + change + ")");
    };
    progress.say((r[0].empty() ? "" : r[0] + ": ") + r[1] + " " + r[2] +
                 beside("design", r[3], r[4]) + beside("uniform material", r[5], r[6]));
  }
}

}  // namespace

int verify_parts(const VerifyOptions& options) {
  const RunClock clock = RunClock::since_process_start();
  const std::vector<GivenPart> parts = given_parts(options.parts);
  const GivenCase given = given_case(options);
  const std::string directory = directory_of(options, given);
  const PreparedCase prepared(with_parts(given, parts));
  const Scene& scene = prepared.scene();
  require_buildable(prepared, directory);
  RunFolder folder(directory, scene, options.threads > 1);
  keep_case(given.file, false, folder);
  if (scene.output.vtk) folder.write_text("paraview.py", kParaViewScript);
  PartComparison comparison = begin_comparison(scene, given, parts, folder);
  end_on_signals();
  Progress progress(options.quiet);
  progress.say(scene.title + ": The results are written to " + directory);
  if (!folder.moved_to().empty())
    progress.say("The earlier run in this folder was moved to " + folder.moved_to());
  RunFiles files(scene, folder, options.threads, clock);
  files.write({}, "running", "");
  std::optional<RunResult> design;
  EndedRun ended;
  if (!given.run.empty()) {
    EndedRun evaluated = evaluate_design(given, directory + "/design_of_run", options, progress);
    ended.error = evaluated.error;
    design = std::move(evaluated.result);
  }
  if (!ended.error) {
    progress.say("The part is evaluated.");
    ended = run_prepared({prepared, &folder, progress, keeps_running, options.threads});
  }
  if (!ended.error) {
    comparison.numbers = compared_numbers(scene, ended.result, design ? &*design : nullptr);
    write_numbers(comparison.numbers, folder);
    say_numbers(comparison, progress);
    ended.result.comparison = std::move(comparison);
  }
  return end_run(std::move(ended), !is_another_case(options.overrides), files, progress);
}

}  // namespace flexmorph::cases
