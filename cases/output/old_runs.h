#pragma once

#include <optional>
#include <string>
#include <vector>

/// Run folders of earlier runs: what they are, and their removal.
namespace flexmorph::cases {

/// A run folder that was found.
struct OldRun {
  std::string path;       ///< Path of the folder.
  std::string case_name;  ///< Name of the case; empty if the folder has no results.
  /// State: "finished", "failed", "interrupted" (also if the run was killed), or "running" (a
  /// process fills the folder).
  std::string state;
  double age = 0;    ///< Time since the run has written its results [s].
  double bytes = 0;  ///< Size of the files that the run has written [bytes].
};

/// Returns all run folders in a folder and below it, sorted by path. A run folder has a list of its
/// files (io::OutputFolder) that names results. Symbolic links are not followed.
/// @throws Error (input) when the folder does not exist or is a symbolic link.
std::vector<OldRun> find_old_runs(const std::string& folder);

/// Selection of run folders; a folder is selected if it meets all conditions that are set. Running
/// runs are never selected.
struct OldRunSelection {
  std::optional<double> older = {};  ///< The results are older than this [s].
  std::optional<int> keep = {};      ///< The run is none of this number of newest runs of its case.
  bool all = false;  ///< True: all runs that meet the other conditions are selected.

  /// Tells whether any condition is set.
  bool any() const { return older || keep || all; }
};
/// Returns for each run whether it is selected.
std::vector<bool> selected_runs(const std::vector<OldRun>& runs, const OldRunSelection& selection);

/// Options of the command `clean`.
struct CleanOptions {
  std::string folder = "runs";  ///< Folder with the run folders.
  OldRunSelection selection;    ///< Run folders that are removed.
  bool yes = false;             ///< True: the selected folders are removed; false: only listed.
};
/// Lists run folders, and removes the selected ones.
/// @return text about all run folders, and about what was removed
/// @throws Error (input) as find_old_runs()
std::string clean_runs(const CleanOptions& options);

}  // namespace flexmorph::cases
