#include <sys/utsname.h>

#include <algorithm>
#include <ctime>
#include <fstream>

#include "cases/output/page/html.h"
#include "cases/output/report_tables.h"
#include "cases/scene/tables.h"
#include "cases/scene/version.h"
#include "fem/solve/linear_solver.h"
#include "io/case_files/case_parser.h"
#include "io/files.h"

/// Sections of the page of a run about the run itself: versions, times, files, settings and the
/// case.
namespace flexmorph::cases {
namespace {

/// A file of a run folder and what it contains.
struct KnownFile {
  const char *begin, *end;  ///< Beginning and ending of its name.
  const char* contents;     ///< What it contains.
};
constexpr KnownFile kKnownFiles[] = {
    {"design", ".dxf", "outline for cutting: lines and arcs; the file names its unit"},
    {"design", ".step", "solid for CAD programs, in mm"},
    {"design", ".stl", "solid for 3D printing"},
    {"design", ".svg", "outline as a picture in full size"},
    {"design", ".inp", "mesh of the outline with its loads, for CalculiX or Abaqus"},
    {"design", ".msh", "mesh of the outline, for Gmsh"},
    {"design", ".geo", "outline, for Gmsh"},
    {"design", ".vtu", "stress and displacement on the mesh of the outline, for ParaView"},
    {"components", ".csv", "components of the final design"},
    {"design_esl", ".svg", "outline before the corrected cycles"},
    {"design/iterations", ".pvd", "design of every iteration, for ParaView"},
    {"design/components", ".pvd", "components of every iteration, for ParaView"},
    {"design/fields", ".pvd", "displacement and energy of some iterations, for ParaView"},
    {"motion/motion", ".pvd", "moving bodies, for ParaView"},
    {"history", ".csv", "a row per design iteration"},
    {"motion_uniform", ".csv", "the motion with uniform material"},
    {"motion_verified_uniform", ".csv", "uniform material in the same motion"},
    {"motion_verified", ".csv", "the motion by which the design is assessed"},
    {"motion", ".csv", "a row per time step of the motion"},
    {"path", ".csv", "a row per equilibrium"},
    {"cycles", ".csv", "a row per cycle and body"},
    {"certificate", ".csv", "derivatives of the objective by every parameter"},
    {"certificate", ".svg", "directions in which components reduce the objective"},
    {"loads/", ".csv", "a row per load"},
    {"inputs/", "", "a file that the case reads"},
    {"plots/", "", "a picture of this page"},
    {"case", ".toml", "the case"},
    {"run", ".json", "all results"},
    {"paraview", ".py", "opens the run in ParaView"}};

const KnownFile* known_file(const std::string& name) {
  for (const KnownFile& each : kKnownFiles)
    if (name.starts_with(each.begin) && name.ends_with(each.end)) return &each;
  return nullptr;
}

std::string present_date() {
  const std::time_t now = std::time(nullptr);
  std::tm local{};
  localtime_r(&now, &local);
  char text[64];
  const size_t size = std::strftime(text, sizeof text, "%Y-%m-%d %H:%M", &local);
  return {text, size};
}

/// Returns the name of the machine and of its processor.
std::string machine() {
  utsname system{};
  uname(&system);
  std::ifstream info("/proc/cpuinfo");
  for (std::string line; std::getline(info, line);)
    if (line.starts_with("model name"))
      return std::string(system.nodename) + ", " + line.substr(line.find(": ") + 2);
  return std::string(system.nodename) + ", " + system.machine;
}

}  // namespace

PageSection run_section(const RunResult& result) {
  const RunInfo& info = result.info;
  std::string libraries;
  for (const auto& [name, version] : library_versions())
    libraries += (libraries.empty() ? "" : ", ") + name + " " + version;
  std::vector<QuantityRow> rows = {
      {{"date", "", ""}, {present_date()}},
      {{"version of Flexmorph", "", ""}, {kVersion}},
      {{"libraries", "", ""}, {libraries}},
      {{"machine", "", ""}, {machine()}},
      {{"kernels of the linear algebra", "", ""}, {fem::blas_kernel()}},
      {{"threads", "", ""}, {io::to_text(info.threads)}},
      {{"wall time", "s", ""}, {io::to_text(info.seconds_wall, 4)}},
      {{"CPU time", "s", ""}, {io::to_text(info.seconds_cpu, 4)}},
      {{"peak memory", "MB", ""}, {io::to_text(info.peak_memory_bytes / 1e6, 4)}}};
  PageSection out{"run", "Run", quantity_table({}, rows)};
  if (info.phases.empty()) return out;
  std::vector<std::vector<std::string>> phases;
  for (const auto& [name, seconds] : info.phases)
    phases.push_back({escaped(spaced_name(name)), io::to_text(seconds, 4)});
  out.html += "<h3>Seconds by phase</h3>\n" +
              sortable_table({{"phase", "", ""}, {"CPU time", "s", ""}}, phases);
  return out;
}

PageSection files_section(RunFolder& folder) {
  std::vector<std::vector<std::string>> rows;
  for (const std::string& name : folder.files()) {
    const bool is_frame =
        (name.starts_with("design/") || name.starts_with("motion/")) && !name.ends_with(".pvd");
    if (is_frame || name == "report.html" || name.ends_with(".checkpoint") ||
        name.ends_with(".log"))
      continue;
    const KnownFile* known = known_file(name);
    rows.push_back({"<a href=\"" + escaped(name) + "\">" + escaped(name) + "</a>",
                    known ? known->contents : ""});
  }
  std::sort(rows.begin(), rows.end());
  return {"files", "Files", sortable_table({{"file", "", ""}, {"contents", "", ""}}, rows)};
}

namespace {

/// Returns a table of values that a case gives, with their defaults.
std::string settings_table(const std::vector<io::Setting>& settings) {
  std::vector<std::vector<std::string>> rows;
  for (const io::Setting& each : settings)
    rows.push_back({term(each.path, each.sentence), escaped(each.value), escaped(each.fallback),
                    each.is_option ? "--set" : "case file"});
  return sortable_table({{"key", "", ""},
                         {"value", "", ""},
                         {"default", "", "Empty if the key has no default."},
                         {"given by", "", ""}},
                        rows);
}

}  // namespace

PageSection settings_section(const Scene& scene) {
  PageSection out{"settings", "Settings that differ from their defaults", ""};
  if (!scene.file) return out;
  const std::vector<io::Setting> changed = scene.file->settings();
  std::vector<io::Setting> dependent = scene.file->dependent_settings();
  // Their sections are others.
  std::erase_if(dependent,
                [](const io::Setting& each) { return tables::only_describes(each.path); });
  out.html = changed.empty() ? paragraph("No value of the case differs from a fixed default.")
                             : settings_table(changed);
  if (!dependent.empty())
    out.html += "<details><summary>" + io::to_text(static_cast<int>(dependent.size())) +
                " given values whose defaults depend on the case</summary>" +
                settings_table(dependent) + "</details>\n";
  return out;
}

PageSection case_section(const RunFolder& folder) {
  PageSection out{"case", "Case", ""};
  try {
    out.html = "<details><summary>case.toml</summary><pre>" +
               escaped(io::read_text(folder.path() + "/case.toml")) + "</pre></details>\n";
  } catch (const Error&) {  // commands that keep no case
  }
  return out;
}

}  // namespace flexmorph::cases
