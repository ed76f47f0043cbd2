#pragma once

#include <string>

/// Checks of the files of a run folder after attacks, and disks of a small size.
namespace flexmorph::testing {

/// Checks that the files in a run folder and its subfolders are complete: tables end with complete
/// rows, JSON can be read, XML, STL and DXF have their ends, and no file has a temporary name.
/// @returns a line for each incomplete file
std::string broken_files(const std::string& folder);

/// Returns the size of all files in a folder and its subfolders [bytes].
double size_of(const std::string& folder);

/// A small disk (tmpfs) in a folder that exists during the lifetime of the object and is invisible
/// for other processes. It is created only if twice its size of memory is free.
class SmallDisk {
 public:
  SmallDisk(std::string folder, double bytes);
  ~SmallDisk();
  SmallDisk(const SmallDisk&) = delete;
  SmallDisk& operator=(const SmallDisk&) = delete;

  /// Returns whether the disk exists. If this process may not mount it, the folder is unchanged.
  bool mounted() const { return mounted_; }
  /// Prevents all further writing; fails if files are open for writing.
  bool make_read_only();
  /// Fills the disk with a file until this number of bytes is free.
  /// @returns false if other processes changed the free space several times
  bool fill_up_to(double free_bytes) const;

 private:
  std::string folder_;
  bool mounted_ = false;
};

/// Returns the value of an environment variable as a number.
size_t number_of(const char* name, size_t otherwise);

}  // namespace flexmorph::testing
