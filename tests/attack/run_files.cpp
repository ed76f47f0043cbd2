#include "tests/attack/run_files.h"

#include <fcntl.h>
#include <sched.h>
#include <sys/mount.h>
#include <sys/statvfs.h>
#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "geometry/base.h"
#include "io/tables.h"
#include "tests/io/scratch.h"

namespace flexmorph::testing {
namespace {

namespace fs = std::filesystem;

/// Returns why a file is incomplete; empty if it is complete.
std::string complaint(const fs::path& path) {
  const std::string ending = path.extension().string(), text = contents_of(path.string());
  if (ending == ".tmp") return "is left under a temporary name";
  if (ending == ".csv") {
    if (text.empty()) return "";  // no row at all
    if (text.back() != '\n') return "ends within a row";
    try {
      io::read_csv(path.string());
    } catch (const Error& error) {
      return error.what();
    }
  }
  if (ending == ".json" && !nlohmann::json::accept(text)) return "is no JSON";
  const auto must_end = [&](const std::string& with) {
    return text.ends_with(with) ? "" : "does not end with " + with;
  };
  if (ending == ".vtu" || ending == ".vti" || ending == ".vtp" || ending == ".pvd")
    return must_end("</VTKFile>\n");
  if (ending == ".svg") return must_end("</svg>\n");
  if (ending == ".html") return must_end("</html>\n");
  if (ending == ".dxf") return must_end("EOF\n");
  if (ending == ".step") return must_end("END-ISO-10303-21;\n");
  if (ending == ".toml" && text.empty()) return "is empty";
  return "";
}

/// Returns whether this amount of memory is free two times.
bool has_memory(double bytes) {
  std::ifstream in("/proc/meminfo");
  for (std::string line; std::getline(in, line);)
    if (line.starts_with("MemAvailable:")) return 1024 * std::stod(line.substr(13)) > 2 * bytes;
  return false;
}

/// Separates the mounts of this process from those of others. @returns true if that succeeded
bool own_mounts() {
  static const bool done = [] {
    if (unshare(CLONE_NEWNS) != 0) return false;
    return mount("none", "/", nullptr, MS_REC | MS_PRIVATE, nullptr) == 0;
  }();
  return done;
}

}  // namespace

std::string broken_files(const std::string& folder) {
  std::string out;
  std::error_code none;
  for (const auto& entry : fs::recursive_directory_iterator(folder, none)) {
    if (!entry.is_regular_file()) continue;
    const std::string why = complaint(entry.path());
    if (!why.empty()) out += entry.path().string() + " " + why + "\n";
  }
  return out;
}

double size_of(const std::string& folder) {
  double out = 0;
  for (const auto& entry : fs::recursive_directory_iterator(folder))
    if (entry.is_regular_file()) out += static_cast<double>(entry.file_size());
  return out;
}

SmallDisk::SmallDisk(std::string folder, double bytes) : folder_(std::move(folder)) {
  fs::create_directories(folder_);
  const std::string size = "size=" + std::to_string(static_cast<long>(bytes));
  mounted_ = has_memory(bytes) && own_mounts() &&
             mount("none", folder_.c_str(), "tmpfs", 0, size.c_str()) == 0;
}

SmallDisk::~SmallDisk() {
  if (mounted_) umount2(folder_.c_str(), MNT_DETACH);
}

bool SmallDisk::make_read_only() {
  return mount("none", folder_.c_str(), "tmpfs", MS_REMOUNT | MS_RDONLY, nullptr) == 0;
}

bool SmallDisk::fill_up_to(double free_bytes) const {
  const int file = open((folder_ + "/of_others").c_str(), O_WRONLY | O_CREAT, 0600);
  bool done = false;
  // Other processes may write at the same time and reduce the free space.
  for (int attempt = 0; attempt < 50 && !done; ++attempt) {
    struct statvfs disk {};
    statvfs(folder_.c_str(), &disk);
    const double there = static_cast<double>(disk.f_bavail) * static_cast<double>(disk.f_bsize);
    done = there <= free_bytes ||
           posix_fallocate(file, 0, static_cast<off_t>(there - free_bytes)) == 0;
  }
  close(file);
  return done;
}

size_t number_of(const char* name, size_t otherwise) {
  const char* text = std::getenv(name);
  return text ? std::strtoull(text, nullptr, 10) : otherwise;
}

}  // namespace flexmorph::testing
