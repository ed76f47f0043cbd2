#include "cases/output/old_runs.h"

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>

#include "cases/assembly/resource_estimate.h"
#include "geometry/text.h"
#include "io/files.h"
#include "io/output_folder.h"
#include "io/screen.h"

namespace flexmorph::cases {
namespace {

namespace fs = std::filesystem;

/// Files with the results of a run, and of the command `modes`.
const char* const kResults[] = {"run.json", "modes.json"};

/// Returns the state of a run from the status in its results.
std::string state_of(const std::string& path, const std::string& status) {
  if (io::is_being_filled(path)) return "running";
  if (status.starts_with("done")) return "finished";
  return status == "failed" ? "failed" : "interrupted";
}

/// Returns the run of a folder; nothing if the folder contains no results of a run.
std::optional<OldRun> run_in(const std::string& path) {
  if (!io::has_output_list(path)) return {};
  for (const char* name : kResults) {
    const fs::path file = fs::path(path) / name;
    std::error_code code;
    if (!fs::is_regular_file(fs::symlink_status(file, code))) continue;
    const nlohmann::json run =
        nlohmann::json::parse(io::read_regular_file(file.string(), "results"), nullptr, false);
    if (!run.is_object() || !run.contains("case") || !run["case"].is_string()) return {};
    const auto age = fs::file_time_type::clock::now() - fs::last_write_time(file, code);
    OldRun out{.path = path, .case_name = run["case"], .state = {}};
    out.state = state_of(path, run.value("status", ""));
    out.age = std::max(0.0, std::chrono::duration<double>(age).count());
    out.bytes = io::owned_files(path).bytes;
    return out;
  }
  return {};
}

/// Returns the path of a folder without slashes at its end, with which a link would be followed.
std::string plain_path(std::string path) {
  while (path.size() > 1 && path.back() == '/') path.pop_back();
  return path;
}

}  // namespace

std::vector<OldRun> find_old_runs(const std::string& folder) {
  const std::string top = plain_path(folder);
  std::error_code code;
  const fs::file_status status = fs::symlink_status(top, code);
  if (fs::is_symlink(status))
    throw Error::input("clean: '" + top +
                       "' is a symbolic link, which is not followed; name the folder itself");
  if (!fs::is_directory(status)) throw Error::input("clean: '" + top + "' is no folder");
  std::vector<std::string> folders = {top};
  fs::recursive_directory_iterator at(top, fs::directory_options::skip_permission_denied, code);
  for (; !code && at != fs::recursive_directory_iterator(); at.increment(code))
    if (fs::is_directory(at->symlink_status())) folders.push_back(at->path().string());
  if (code) throw Error::input("clean: '" + top + "' cannot be read: " + code.message());
  std::sort(folders.begin(), folders.end());
  std::vector<OldRun> out;
  for (const std::string& each : folders)
    if (std::optional<OldRun> run = run_in(each)) out.push_back(std::move(*run));
  return out;
}

std::vector<bool> selected_runs(const std::vector<OldRun>& runs, const OldRunSelection& selection) {
  std::map<std::string, std::vector<double>> ages;  // of the runs of each case
  for (const OldRun& run : runs) ages[run.case_name].push_back(run.age);
  std::vector<bool> out;
  for (const OldRun& run : runs) {
    const std::vector<double>& all = ages.at(run.case_name);
    const auto newer =
        std::count_if(all.begin(), all.end(), [&](double age) { return age < run.age; });
    out.push_back(selection.any() && run.state != "running" &&
                  (!selection.older || run.age > *selection.older) &&
                  (!selection.keep || newer >= *selection.keep));
  }
  return out;
}

std::string clean_runs(const CleanOptions& options) {
  const std::vector<OldRun> runs = find_old_runs(options.folder);
  const std::vector<bool> selected = selected_runs(runs, options.selection);
  std::vector<std::vector<std::string>> rows = {{"folder", "size", "age", "case", "state", ""}};
  double all = 0, chosen = 0;
  size_t count = 0;
  for (size_t i = 0; i < runs.size(); ++i) {
    const OldRun& run = runs[i];
    all += run.bytes;
    chosen += selected[i] ? run.bytes : 0;
    count += selected[i] ? 1 : 0;
    const std::string below = fs::path(run.path).lexically_relative(options.folder).string();
    rows.push_back({below, bytes_text(run.bytes), duration_text(run.age), run.case_name, run.state,
                    selected[i] ? "selected" : ""});
  }
  const auto folders = [](size_t n, double bytes) {
    return std::to_string(n) + (n == 1 ? " run folder, " : " run folders, ") + bytes_text(bytes);
  };
  const size_t width = io::screen_width();
  std::string out = runs.empty() ? "" : io::fitted_table(rows, width, "run.json");
  out += options.folder + ": " + folders(runs.size(), all) + "\n";
  if (!options.selection.any()) return out;
  if (!options.yes)
    return out + io::fitted_text("selected: " + folders(count, chosen) +
                                     "; nothing was removed, --yes removes the selected folders",
                                 width);
  double removed = 0;
  std::string remarks;
  // Folders within others come first, so that the others are empty afterwards.
  for (size_t i = runs.size(); i-- > 0;) {
    if (!selected[i]) continue;
    const io::OwnedFiles found = io::remove_owned_files(runs[i].path);
    removed += found.bytes;
    if (!found.others.empty())
      remarks += io::fitted_text(
          runs[i].path +
              ": files that the run did not write are still there: " + joined(found.others),
          width);
  }
  return out + remarks + "removed: " + folders(count, removed) + "\n";
}

}  // namespace flexmorph::cases
