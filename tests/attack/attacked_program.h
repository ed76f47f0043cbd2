#pragma once

#include <sys/types.h>

#include <string>
#include <vector>

/// The program under attack: what it is allowed, how it ends, and whether its files are whole.
namespace flexmorph::testing {

/// What a process may take; 0: as much as the system gives.
struct Limits {
  double address_space = 0;  ///< ulimit -v [bytes]
  double file_size = 0;      ///< ulimit -f [bytes], SIGXFSZ ignored: writing fails then
};

/// How a process ended.
struct End {
  int code = -1;      ///< exit code; -1: by a signal
  int signal = 0;     ///< that ended it
  bool hung = false;  ///< killed, because it took longer than it was given
  std::string words;  ///< what it said on standard error
  std::string all;    ///< on standard output
};

/// A process that has been started; waited for, or killed with this.
class Attacked {
 public:
  /// @param words  of the command, the program first
  /// @param folder  of the files for its output
  Attacked(const std::vector<std::string>& words, const std::string& folder,
           const Limits& limits = {});
  ~Attacked();
  Attacked(const Attacked&) = delete;
  Attacked& operator=(const Attacked&) = delete;

  pid_t pid() const { return pid_; }
  bool lives() const;
  /// @param seconds  after which it is killed, by the clock on the wall: generous, as it is for
  ///                 those that wait for ever
  End end(double seconds = 300);

 private:
  std::string folder_;
  pid_t pid_ = -1;
};

/// Is what stands in a run folder, or in folders below, whole? Tables end with whole rows, JSON can
/// be read, XML, STL and DXF come to their ends, nothing is left under a temporary name.
/// @return a line for each file that is not
std::string broken_files(const std::string& folder);

/// Bytes of all files below.
double size_of(const std::string& folder);

/// A small disk of its own (tmpfs) in a folder, while it lives; others do not see it.
class SmallDisk {
 public:
  SmallDisk(std::string folder, double bytes);
  ~SmallDisk();
  SmallDisk(const SmallDisk&) = delete;
  SmallDisk& operator=(const SmallDisk&) = delete;

  /// Is it there? Where this process may not mount it is not, and the folder is as it was.
  bool mounted() const { return mounted_; }
  /// Nothing can be written any more; not where files are open for it.
  bool make_read_only();
  /// Takes all that is free but so many bytes, with a file.
  /// @return false when others were faster, several times
  bool fill_up_to(double free_bytes) const;

 private:
  std::string folder_;
  bool mounted_ = false;
};

/// Value of an environment variable as a number.
size_t number_of(const char* name, size_t otherwise);

}  // namespace flexmorph::testing
