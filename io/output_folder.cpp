#include "io/output_folder.h"

#include <dirent.h>
#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <optional>
#include <sstream>
#include <system_error>
#include <thread>

#include "geometry/base.h"

namespace flexmorph::io {
namespace {

namespace fs = std::filesystem;

const char* const kList = ".flexmorph";
const std::string kOwner = "flexmorph, ";  // begins the line of a process that fills the folder
// less than the 255 bytes that file systems allow, because endings are added
constexpr size_t kLongestPart = 200;

[[noreturn]] void refuse(const std::string& path, const std::string& why) {
  throw Error::input("output folder '" + path + "': " + why);
}

std::string reason_of(int code) { return std::generic_category().message(code); }

std::string list_of(const std::string& folder) { return (fs::path(folder) / kList).string(); }

/// Returns the process that fills a folder, such as "process 1234 on 'machine'", from its list.
std::string owner_of(const std::string& folder) {
  std::ifstream list(list_of(folder));
  std::string out = "another process";
  for (std::string line; std::getline(list, line);)
    if (line.starts_with(kOwner)) out = line.substr(kOwner.size());
  return out;
}

std::string own_text() {
  std::array<char, 256> machine{};
  gethostname(machine.data(), machine.size() - 1);
  return "process " + std::to_string(getpid()) + " on '" + machine.data() + "'";
}

/// Returns true if a name is not a file below the folder, or is that of the list.
bool leaves_folder(const std::string& name) {
  const fs::path relative(name);
  bool leaves = name.empty() || relative.is_absolute() || name == kList || name.back() == '/' ||
                name.find('\n') != std::string::npos;
  for (const fs::path& part : relative)
    leaves = leaves || part == ".." || part == "." || part.native().size() > kLongestPart;
  return leaves;
}

/// Locks a list and returns its file descriptor, or -1 with errno. A process that calls
/// is_being_filled() holds the lock for a moment, therefore several attempts are made.
int lock_of(const std::string& list, int flags) {
  const int file = open(list.c_str(), flags | O_CLOEXEC, 0666);
  if (file < 0) return -1;
  int why = 0;
  for (int attempt = 0; attempt < 5; ++attempt) {
    if (flock(file, LOCK_EX | LOCK_NB) == 0) return file;
    why = errno;
    if (why != EWOULDBLOCK) break;
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  close(file);
  errno = why;
  return -1;
}

[[noreturn]] void refuse_as_taken(const std::string& folder) {
  refuse(folder,
         owner_of(folder) +
             " is writing to it; wait until it has ended, or choose another folder with -o");
}

/// Opens and locks the list of a folder, and adds the process to it.
/// @param empties  true if the previous contents of the list are removed
int take_list(const std::string& folder, int flags, bool empties) {
  const int list = lock_of(list_of(folder), O_RDWR | O_APPEND | O_NOFOLLOW | flags);
  if (list < 0 && (errno == EEXIST || errno == EWOULDBLOCK)) refuse_as_taken(folder);
  if (list < 0) refuse(folder, reason_of(errno));
  const std::string line = kOwner + own_text() + "\n";
  if ((empties && ftruncate(list, 0) != 0) ||
      write(list, line.data(), line.size()) != static_cast<ssize_t>(line.size()))
    refuse(folder, "the list of its files cannot be written: " + reason_of(errno));
  return list;
}

/// Returns the names in the list of a folder that are files below it. The folder is given by its
/// file descriptor, so that no symbolic link can take its place.
/// @return nothing if there is no list
std::optional<std::set<std::string>> names_in(int folder) {
  const int file = openat(folder, kList, O_RDONLY | O_NOFOLLOW | O_CLOEXEC | O_NONBLOCK);
  if (file < 0) return {};
  std::string text;
  std::array<char, 4096> block{};
  for (ssize_t n = 0; (n = read(file, block.data(), block.size())) > 0;)
    text.append(block.data(), static_cast<size_t>(n));
  struct stat status {};
  const bool regular = fstat(file, &status) == 0 && S_ISREG(status.st_mode);
  close(file);
  if (!regular) return {};
  std::set<std::string> out;
  std::istringstream in(text);
  for (std::string line; std::getline(in, line);)
    if (!line.starts_with(kOwner) && !leaves_folder(line)) out.insert(line);
  return out;
}

/// Walks through a folder whose list names its files, and counts or removes these files.
class OwnedWalk {
 public:
  explicit OwnedWalk(bool removes) : removes_(removes) {}

  /// @param shown   path of the folder for messages
  /// @param prefix  path of the folder from the folder with the list, empty or ending with '/'
  /// @param names   names in the list
  void enter(int folder, const std::string& shown, const std::string& prefix,
             const std::set<std::string>& names) {
    for (const std::string& name : entries_of(folder, shown)) {
      struct stat status {};
      if (fstatat(folder, name.c_str(), &status, AT_SYMLINK_NOFOLLOW) != 0) continue;
      const std::string path = shown + "/" + name;
      if (S_ISDIR(status.st_mode)) {
        enter_subfolder(folder, name, path, prefix, names);
      } else if (S_ISREG(status.st_mode) && (names.contains(prefix + name) || name == kList)) {
        if (name == kList) continue;  // is removed last
        out_.bytes += static_cast<double>(status.st_size);
        ++out_.files;
        remove(folder, name, path);
      } else {
        out_.others.push_back(path);
      }
    }
  }
  void remove(int folder, const std::string& name, const std::string& path) const {
    if (removes_ && unlinkat(folder, name.c_str(), 0) != 0 && errno != ENOENT)
      throw Error::input(path + ": cannot be removed: " + reason_of(errno));
  }
  const OwnedFiles& found() const { return out_; }

 private:
  void enter_subfolder(int folder, const std::string& name, const std::string& path,
                       const std::string& prefix, const std::set<std::string>& names) {
    const int inner = openat(folder, name.c_str(), O_RDONLY | O_DIRECTORY | O_NOFOLLOW | O_CLOEXEC);
    // A folder with its own list is another run.
    if (inner < 0 || names_in(inner)) {
      out_.others.push_back(path);
      if (inner >= 0) close(inner);
      return;
    }
    enter(inner, path, prefix + name + "/", names);
    close(inner);
    // The system refuses to remove a folder that is not empty.
    if (removes_) unlinkat(folder, name.c_str(), AT_REMOVEDIR);
  }

  static std::vector<std::string> entries_of(int folder, const std::string& shown) {
    const int copy = openat(folder, ".", O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    DIR* const list = copy < 0 ? nullptr : fdopendir(copy);
    if (list == nullptr) {
      if (copy >= 0) close(copy);
      throw Error::input(shown + ": cannot be read: " + reason_of(errno));
    }
    std::vector<std::string> out;
    while (const dirent* entry = readdir(list)) {
      const std::string name = entry->d_name;
      if (name != "." && name != "..") out.push_back(name);
    }
    closedir(list);
    std::sort(out.begin(), out.end());
    return out;
  }

  bool removes_;
  OwnedFiles out_;
};

/// Opens a folder that is no symbolic link, and calls a function with its file descriptor and the
/// names in its list.
void with_list(const std::string& folder, const auto& use) {
  const int opened = open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_NOFOLLOW | O_CLOEXEC);
  const auto names = opened < 0 ? std::nullopt : names_in(opened);
  if (!names) {
    if (opened >= 0) close(opened);
    refuse(folder, "this is no folder of a run");
  }
  try {
    use(opened, *names);
  } catch (...) {
    close(opened);
    throw;
  }
  close(opened);
}

/// Returns NAME.previous, or the first of NAME.previous.2, NAME.previous.3, ... that does not
/// exist.
std::string free_name(const std::string& path) {
  std::string out = path + ".previous";
  for (int k = 2; fs::symlink_status(out).type() != fs::file_type::not_found; ++k)
    out = path + ".previous." + std::to_string(k);
  return out;
}

}  // namespace

OutputFolder::OutputFolder(std::string path, Begin begin) : path_(std::move(path)) {
  while (path_.size() > 1 && path_.back() == '/') path_.pop_back();
  try {
    make();
    if (begin == Begin::keep_running && fs::is_regular_file(fs::symlink_status(list_of(path_)))) {
      list_ = take_list(path_, 0, false);
      read_list();
      return;
    }
    if (!fs::is_empty(path_)) {
      move_away();
      make();
    }
  } catch (const fs::filesystem_error& error) {
    refuse(path_, error.code().message());
  }
  list_ = take_list(path_, O_CREAT | O_EXCL, false);
}

OutputFolder::~OutputFolder() {
  if (list_ >= 0) close(list_);
}

void OutputFolder::make() { fs::create_directories(path_); }

/// Moves an earlier run away. A folder without a list is not moved, because it belongs to the user.
void OutputFolder::move_away() {
  const std::string list = list_of(path_);
  if (!fs::is_regular_file(fs::symlink_status(list)))
    refuse(path_, "it is not empty, and it does not contain a run; choose another folder with -o");
  const int lock = lock_of(list, O_RDWR | O_NOFOLLOW);
  if (lock < 0 && errno == EWOULDBLOCK) refuse_as_taken(path_);
  moved_to_ = free_name(path_);
  std::error_code code;
  fs::rename(path_, moved_to_, code);
  if (lock >= 0) close(lock);
  if (code)
    refuse(path_, "the run in it cannot be moved to '" + moved_to_ + "': " + code.message());
}

/// Reads the names of an existing list.
void OutputFolder::read_list() {
  std::ifstream list(list_of(path_));
  for (std::string name; std::getline(list, name);)
    if (!name.starts_with(kOwner)) names_.insert(name);
}

std::string OutputFolder::file(const std::string& name) {
  const fs::path relative(name);
  if (leaves_folder(name))
    refuse(path_, "'" + name.substr(0, 80) + "' is not the name of a file in this folder");
  const fs::path whole = fs::path(path_) / relative;
  const std::lock_guard<std::mutex> lock(mutex_);
  struct stat list {};
  if (fstat(list_, &list) != 0 || list.st_nlink == 0)
    throw Error::numerical("output folder '" + path_ + "' was removed during the run");
  std::error_code code;
  if (relative.has_parent_path()) fs::create_directories(whole.parent_path(), code);
  if (!code && !names_.insert(name).second) return whole.string();
  const std::string line = name + "\n";
  if (code || write(list_, line.data(), line.size()) != static_cast<ssize_t>(line.size()))
    throw Error::numerical(whole.string() +
                           ": cannot be written: " + (code ? code.message() : reason_of(errno)));
  return whole.string();
}

std::vector<std::string> OutputFolder::files_of(const std::string& ending) {
  const std::lock_guard<std::mutex> lock(mutex_);
  std::vector<std::string> out;
  for (const std::string& name : names_)
    if (name.ends_with(ending)) out.push_back((fs::path(path_) / name).string());
  return out;
}

std::vector<std::string> OutputFolder::files() {
  const std::lock_guard<std::mutex> lock(mutex_);
  std::vector<std::string> out;
  std::error_code none;
  for (const std::string& name : names_)
    if (fs::is_regular_file(fs::symlink_status(fs::path(path_) / name, none))) out.push_back(name);
  return out;
}

void require_study_folder(const std::string& folder) {
  const std::string list = list_of(folder);
  std::error_code error;
  const bool empty = fs::is_empty(folder, error);
  if (error) refuse(folder, error.message());
  if (empty) {
    const int file = open(list.c_str(), O_WRONLY | O_CREAT | O_NOFOLLOW | O_CLOEXEC, 0666);
    if (file < 0) refuse(folder, reason_of(errno));
    close(file);
    return;
  }
  if (!fs::is_regular_file(fs::symlink_status(list, error)))
    refuse(folder,
           "it contains files that were not written by a study; choose another folder with -o");
  std::ifstream names(list);
  for (std::string name; std::getline(names, name);)
    if (!name.starts_with(kOwner))
      refuse(folder, "it is the folder of a run, which wrote '" + name +
                         "'; choose another folder with -o");
}

FolderLock::FolderLock(const std::string& folder) {
  require_study_folder(folder);
  list_ = take_list(folder, O_CREAT, true);
}

FolderLock::~FolderLock() {
  if (list_ >= 0) close(list_);
}

bool is_being_filled(const std::string& folder) {
  const int list = open(list_of(folder).c_str(), O_RDONLY | O_NOFOLLOW | O_CLOEXEC);
  if (list < 0) return false;
  // A shared lock allows several processes to test at the same time, and it needs no write
  // permission.
  const bool held = flock(list, LOCK_SH | LOCK_NB) != 0 && errno == EWOULDBLOCK;
  close(list);
  return held;
}

bool has_output_list(const std::string& folder) {
  const int opened = open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_NOFOLLOW | O_CLOEXEC);
  if (opened < 0) return false;
  const bool out = names_in(opened).has_value();
  close(opened);
  return out;
}

OwnedFiles owned_files(const std::string& folder) {
  OwnedWalk walk(false);
  with_list(folder, [&](int opened, const auto& names) { walk.enter(opened, folder, "", names); });
  return walk.found();
}

OwnedFiles remove_owned_files(const std::string& folder) {
  OwnedWalk walk(true);
  with_list(folder, [&](int opened, const auto& names) {
    // No process can begin to fill the folder while this one holds the lock.
    const int lock = lock_of(list_of(folder), O_RDONLY | O_NOFOLLOW);
    if (lock < 0 && errno == EWOULDBLOCK) refuse_as_taken(folder);
    walk.enter(opened, folder, "", names);
    walk.remove(opened, kList, list_of(folder));
    if (lock >= 0) close(lock);
  });
  rmdir(folder.c_str());  // the system refuses to remove a folder that is not empty
  return walk.found();
}

}  // namespace flexmorph::io
