#include "cases/check/ready.h"

#include <dlfcn.h>

#include <algorithm>
#include <filesystem>

#include "cases/assembly/resource_estimate.h"
#include "cases/results/expectations.h"
#include "cases/scene/version.h"
#include "fem/dynamics/starts/rigid_motion.h"
#include "fem/solve/redundancy.h"
#include "geometry/text.h"
#include "io/case_files/case_document.h"
#include "io/files.h"
#include "io/tables.h"

namespace flexmorph::cases {
namespace {

namespace fs = std::filesystem;

/// Returns the path of the running program, or of the shared library that contains this function;
/// empty if it is unknown.
fs::path own_file(const void* function) {
  Dl_info found{};
  const bool known = dladdr(function, &found) != 0 && found.dli_fname != nullptr;
  std::error_code none;  // ignored: some systems have no /proc
  fs::path program = fs::read_symlink("/proc/self/exe", none);
  if (!known) return program;
  fs::path file = fs::canonical(found.dli_fname, none);
  return none ? program : file;
}

/// Throws for joints that contradict each other, and for bodies that do not reach their joints.
void require_start(Mechanism& mechanism) {
  constexpr double kPositionTolerance =
      1e-6;  // relative to the size of the model: coordinates in cases are rounded
  fem::Workspace& model = mechanism.model;
  const fem::State x = fem::start_state(model, mechanism.moving_roots, 0, fem::Start::rigid,
                                        mechanism.motion.body_poses);
  fem::leave_out_redundant(model, x);
  fem::ScaledConstraints rows;
  rows.evaluate(model, x);
  const VectorXd misses = rows.misses();
  const double worst = misses.lpNorm<Eigen::Infinity>();
  if (worst > kPositionTolerance * fem::model_size(rows.scales(), x.q))
    throw Error::input("at the start " + fem::list_joints(fem::heaviest_joints(model, misses, 1)) +
                       " has an error of " + io::to_text(worst, 3) +
                       " m: the undeformed bodies do not reach their joints");
}

/// Throws for limits that the full design violates under its fixed loads.
void require_attainable(const Scene& scene, const mmc::BodyProblem& problem,
                        mmc::ComplianceEvaluator& loads) {
  if (scene.gravity) return;  // more material also increases the load
  const mmc::Figures full = mmc::full_values(problem, loads);
  for (const mmc::Limit& limit : problem.goal.limits) {
    if (!limit.wants_material()) continue;
    const double found = full.at(mmc::key_of(*limit.row));
    if (limit.excess(found) > 0)
      scene.refuse(limit.key_path, "no design can satisfy this limit: the " +
                                       std::string(limit.row->words) + " of the full domain is " +
                                       io::to_text(found, 6) + " " + std::string(limit.row->unit));
  }
}

/// Builds the model, the design problems and the loads of a case, and throws if one cannot be
/// built.
void require_parts(const PreparedCase& prepared) {
  const Scene& scene = prepared.scene();
  if (!scene.domain) {
    // The rigid model is checked first because its joints have the names of the case.
    if (const fem::RigidKinematics* rigid = prepared.rigid())
      fem::require_motion(*rigid, scene.time.end);
    // One evaluation lets loads and terms determine their locations, or throw.
    Mechanism mechanism = prepared.mechanism();
    if (mechanism.model.n_constraints() > 0) require_start(mechanism);
    const fem::State x = mechanism.model.reference();
    VectorXd force;
    mechanism.model.force(x, force);
    if (scene.time.integrator == "energy_momentum") mechanism.model.mean_force(x, x.q, x.q, force);
  }
  check_expectations(prepared);
  const std::vector<mmc::BodyProblem>& problems = prepared.design_problems();
  if (!scene.domain) return;
  const mmc::BodyProblem& problem = problems.front();
  if (problem.grid.n_cells() <= kMaxBuiltCells)
    require_attainable(scene, problem, *build_static_loads(scene, problem));
  else
    static_locations(scene, problem.grid, problem.outside);
}

/// Finds the entry whose quoted name comes first in a message.
class FirstNamed {
 public:
  explicit FirstNamed(const std::string& message) : message_(message) {}

  template <class List>
  void look(const List& list, const std::string& path) {
    for (size_t i = 0; i < list.size(); ++i) {
      if (list[i].name.empty()) continue;
      const size_t at = message_.find("'" + list[i].name + "'");
      if (at >= at_) continue;
      at_ = at;
      path_ = path + "." + std::to_string(i);
    }
  }
  const std::string& path() const { return path_; }

 private:
  const std::string& message_;
  size_t at_ = std::string::npos;
  std::string path_;
};

}  // namespace

std::string cases_folder() {
  std::error_code none;
  const fs::path beside = own_file(reinterpret_cast<const void*>(&cases_folder)).parent_path();
  std::vector<fs::path> prefixes{beside.parent_path(), beside.parent_path().parent_path()};
  if (beside.parent_path().filename() == "dist-packages")  // PREFIX/lib/pythonX.Y/dist-packages
    prefixes.push_back(beside.parent_path().parent_path().parent_path().parent_path());
  for (const fs::path& prefix : prefixes) {
    const fs::path installed = prefix / "share/flexmorph/cases";
    if (!beside.empty() && fs::is_directory(installed, none)) return installed.string();
  }
  // A program that contains the static libraries can be anywhere.
  return fs::is_directory(kCasesFolder, none) ? kCasesFolder : FLEXMORPH_INSTALLED_CASES;
}

std::string located_refusal(const Scene& scene, const std::string& message) {
  if (!scene.file || message.starts_with(scene.file->path() + ":") || message.starts_with("--set "))
    return message;
  FirstNamed named(message);
  named.look(scene.joints, "joint");
  named.look(scene.bodies, "body");
  named.look(scene.rigid_bodies, "rigid_body");
  named.look(scene.springs, "spring");
  named.look(scene.drives, "drive");
  if (scene.domain) named.look(scene.domain->loads, "load");
  return scene.file->where(named.path()) + ": " + message;
}

void require_buildable(const PreparedCase& prepared, const std::string& directory) {
  const Scene& scene = prepared.scene();
  require_disk(scene, this_machine(directory.empty() ? scene.output.directory : directory));
  try {
    require_parts(prepared);
  } catch (const Error& error) {
    const std::string words = located_refusal(scene, error.what());
    throw error.kind() == Error::Kind::input ? Error::input(words) : Error::numerical(words);
  }
}

ReadyCase ready_case(const std::string& name, std::span<const std::string> overrides,
                     const std::string& directory) {
  return ready_case(io::CaseFile(find_case(name), overrides), overrides, directory);
}

ReadyCase ready_case(io::CaseFile file, std::span<const std::string> overrides,
                     const std::string& directory) {
  PreparedCase prepared(read_scene(file));
  require_buildable(prepared, directory);
  return {std::move(file), std::move(prepared), {overrides.begin(), overrides.end()}};
}

std::string title_of_case(const std::string& name) {
  const io::CaseDocument document(find_case(name));
  const io::CaseNode* title = document.root.find("title");
  return title && title->kind == io::CaseNode::Kind::text ? title->text : name;
}

std::string list_of_cases() {
  std::vector<std::vector<std::string>> rows;
  for (const std::string& name : shipped_cases()) rows.push_back({name, title_of_case(name)});
  return io::aligned_table(rows);
}

std::vector<std::string> shipped_cases() {
  std::vector<std::string> out;
  std::error_code
      none;  // ignored: the folder is missing if the program was moved without its cases
  for (const auto& entry : std::filesystem::directory_iterator(cases_folder(), none))
    if (entry.path().extension() == ".toml") out.push_back(entry.path().stem().string());
  std::sort(out.begin(), out.end());
  return out;
}

std::string find_case(const std::string& name) {
  if (name == "-") return "/dev/stdin";
  if (std::filesystem::is_regular_file(name)) return name;
  const std::vector<std::string> shipped = shipped_cases();
  if (std::find(shipped.begin(), shipped.end(), name) != shipped.end())
    return cases_folder() + "/" + name + ".toml";
  // A pipe is accepted, too; the reader of the file throws for a folder.
  if (std::filesystem::exists(name)) return name;
  const std::string stem = std::filesystem::path(name).stem().string();
  const std::string close = io::nearest(stem, shipped);
  throw Error::input("case '" + name + "': this is neither a file nor a shipped case" +
                     (close.empty() ? "; the shipped cases are: " + joined(shipped)
                                    : ", did you mean '" + close + "'?"));
}

}  // namespace flexmorph::cases
