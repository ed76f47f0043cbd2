#pragma once

#include <mutex>
#include <set>
#include <string>
#include <vector>

namespace flexmorph::io {

/// A folder for output files that one process fills at a time.
///
/// The folder contains a list of its files, `.flexmorph`. Each name is added to the list before the
/// file is created. Files in the list belong to Flexmorph; all other files in the folder belong to
/// the user and are never changed. The list is locked (flock) while its process runs, also on
/// network disks that support locks. The operating system removes the lock when the process ends,
/// therefore no stale lock can remain.
///
/// A folder that contains an earlier run is moved as a whole to NAME.previous (NAME.previous.2, ...
/// if that name exists). No results are removed.
class OutputFolder {
 public:
  /// Treatment of a folder with an earlier run: `anew` moves it away, `keep_running` continues in
  /// it, and the files in its list belong to this run, too.
  enum class Begin { anew, keep_running };
  /// Takes the folder, which is created if it is missing.
  /// @throws Error (input) when a running process fills it (with its number and machine), when it
  ///         contains files but no list, or when it cannot be created or moved.
  explicit OutputFolder(std::string path, Begin begin = Begin::anew);
  ~OutputFolder();
  OutputFolder(const OutputFolder&) = delete;
  OutputFolder& operator=(const OutputFolder&) = delete;

  /// Returns the path of the folder.
  const std::string& path() const { return path_; }
  /// Returns the path to which the previous contents of the folder were moved; empty if there were
  /// none.
  const std::string& moved_to() const { return moved_to_; }

  /// Returns the path of a file in the folder after adding it to the list; subfolders are created.
  /// All paths in the folder must be obtained here. Several threads may call the function.
  /// @throws Error (input) for a name that leaves the folder ("../a", "/a"), that is the list, or
  ///         that has a component of more than 200 bytes; Error (numerical) when the list cannot be
  ///         written or the folder was removed meanwhile.
  std::string file(const std::string& name);
  /// Returns the names in the list whose files exist.
  std::vector<std::string> files();
  /// Returns the paths of the files in the list with an ending; the files need not exist.
  std::vector<std::string> files_of(const std::string& ending);

 private:
  void make();
  void read_list();
  void move_away();

  std::string path_, moved_to_;
  int list_ = -1;
  std::mutex mutex_;
  std::set<std::string> names_;
};

/// Turns an empty, existing folder into a folder of studies. Several studies may work in it at the
/// same time, each in folders of its own runs.
/// @throws Error (input) when the folder contains files and no study has filled it, when it is the
///         folder of a run, or when its list cannot be written. Thus tables of a study cannot
///         overwrite files of a user.
void require_study_folder(const std::string& folder);

/// A lock on a folder for one process that continues with the contents of the folder, as a study
/// does. An OutputFolder, in contrast, starts with an empty folder.
class FolderLock {
 public:
  /// Locks a folder.
  /// @param folder  folder; it must exist
  /// @throws Error (input) as require_study_folder(), or when a running process fills the folder.
  explicit FolderLock(const std::string& folder);
  ~FolderLock();
  FolderLock(const FolderLock&) = delete;
  FolderLock& operator=(const FolderLock&) = delete;

 private:
  int list_ = -1;
};

/// Returns true if a running process fills a folder.
bool is_being_filled(const std::string& folder);

/// Returns true if a folder contains the list of an OutputFolder or of a study. A symbolic link to
/// a folder is none.
bool has_output_list(const std::string& folder);

/// The files in a folder and in its subfolders that belong to Flexmorph, see OutputFolder. An
/// OutputFolder within another one does not belong to it.
struct OwnedFiles {
  double bytes = 0;  ///< Size of all of them [bytes].
  size_t files = 0;  ///< Number of files.
  std::vector<std::string>
      others;  ///< Paths of all other files, symbolic links and output folders.
};
/// Returns the files of a folder that belong to Flexmorph. Symbolic links are not followed.
/// @throws Error (input) when the folder has no list or cannot be read.
OwnedFiles owned_files(const std::string& folder);
/// Removes the files of a folder that belong to Flexmorph, and all folders that are empty then,
/// which may include the folder itself. Symbolic links are neither followed nor removed.
/// @return removed files, and the remaining ones
/// @throws Error (input) as owned_files(), when a running process fills the folder, or with the
///         first file that cannot be removed.
OwnedFiles remove_owned_files(const std::string& folder);

}  // namespace flexmorph::io
