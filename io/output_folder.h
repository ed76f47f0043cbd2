#pragma once

#include <mutex>
#include <set>
#include <string>
#include <vector>

namespace flexmorph::io {

/// A folder that one process fills, and nobody else meanwhile.
///
/// It keeps a list of its files, `.flexmorph`, each written down before it is made: what stands
/// there is ours, all else in the folder belongs to the user and is never touched. The list is
/// locked (flock) while its process lives, on the disks of other machines as well where they know
/// locks; a lock dies with its process, so that none is ever stale.
///
/// A folder that holds an earlier one is moved, whole, to NAME.previous (NAME.previous.2, ... where
/// there is one already): nothing that was computed is removed.
class OutputFolder {
 public:
  /// Takes the folder, which is made where it is missing.
  /// @throws Error (input) when a living process has it (with its number and machine), when it
  ///         holds files but no list, or cannot be made or moved.
  ///         With Begin::go_on what is in it stays, listed files are those of this one, too.
  enum class Begin { anew, go_on };
  explicit OutputFolder(std::string path, Begin begin = Begin::anew);
  ~OutputFolder();
  OutputFolder(const OutputFolder&) = delete;
  OutputFolder& operator=(const OutputFolder&) = delete;

  const std::string& path() const { return path_; }
  /// Where what was in the folder before is now; empty when it was empty.
  const std::string& moved_to() const { return moved_to_; }

  /// Path of a file of the folder, now in its list; folders on the way are made. The only way to a
  /// path in the folder. Several threads may ask.
  /// @throws Error (input) for a name that leaves the folder ("../a", "/a"), that is its list, or
  ///         with a part of more than 200 bytes; Error (numerical) when the list cannot be written,
  ///         or the folder was removed meanwhile.
  std::string file(const std::string& name);
  /// Names in the list whose files are there.
  std::vector<std::string> files();
  /// Paths of the files in its list with this ending; they need not be there.
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

/// Makes an empty folder, which exists, one of studies: several may work in it at the same time,
/// each at runs of its own.
/// @throws Error (input) when it holds files and no study has filled it, or its list cannot be
///         written: tables of a study must not take the place of a user's.
void require_study_folder(const std::string& folder);

/// Keeps a folder for one process that goes on with what is in it, as a study does, where an
/// OutputFolder begins anew.
class FolderLock {
 public:
  /// @param folder  which exists
  /// @throws Error (input) as require_study_folder(), or when a living process has it.
  explicit FolderLock(const std::string& folder);
  ~FolderLock();
  FolderLock(const FolderLock&) = delete;
  FolderLock& operator=(const FolderLock&) = delete;

 private:
  int list_ = -1;
};

/// Does a living process fill this folder?
bool is_being_filled(const std::string& folder);

}  // namespace flexmorph::io
