#pragma once

#include <string>

/// Files of a run folder after attacks, and disks of a small size.
namespace flexmorph::testing {

/// Is what stands in a run folder, or in folders below, whole? Tables end with whole rows, JSON can
/// be read, XML, STL and DXF come to their ends, nothing is left under a temporary name.
/// @return a line for each file that is not
std::string broken_files(const std::string& folder);

/// Bytes of all files below.
double size_of(const std::string& folder);

/// A small disk of its own (tmpfs) in a folder, while it lives; others do not see it. It is made
/// where twice its size of memory is free.
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
