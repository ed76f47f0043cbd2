#include "io/files.h"

#include <fcntl.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <charconv>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <system_error>

#include "geometry/base.h"

namespace flexmorph::io {
namespace {

[[noreturn]] void fail(const std::string& path, const std::string& reason) {
  throw Error::numerical(path + ": cannot be written: " + reason);
}

std::string reason_of(int code) { return std::generic_category().message(code); }

/// Returns true if an open file or folder is on the disk, or if its file system cannot synchronize.
bool synced(int file) {
  return fsync(file) == 0 || errno == EINVAL || errno == ENOTSUP || errno == ENOSYS;
}

void sync_folder(const std::filesystem::path& folder) {
  const std::string name = folder.empty() ? "." : folder.string();
  const int file = open(name.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  const bool done = file >= 0 && synced(file);
  const int why = errno;
  if (file >= 0) close(file);
  if (!done) fail(name, reason_of(why));
}

}  // namespace

void write_file(const std::string& path, std::string_view contents, Sync sync) {
  const std::filesystem::path target(path);
  std::error_code code;
  const std::string temporary = path + ".tmp";
  std::FILE* file = std::fopen(temporary.c_str(), "wb");
  if (!file) fail(path, reason_of(errno));
  const bool written = std::fwrite(contents.data(), 1, contents.size(), file) == contents.size() &&
                       std::fflush(file) == 0 && (sync == Sync::later || synced(fileno(file)));
  const int write_error = errno;
  const bool closed = std::fclose(file) == 0;  // the last block may fail here (a full disk)
  if (!written || !closed) {
    const std::string reason = reason_of(written ? errno : write_error);
    std::remove(temporary.c_str());
    fail(path, reason);
  }
  std::filesystem::rename(temporary, target, code);
  if (code) {
    std::remove(temporary.c_str());
    fail(path, code.message());
  }
  if (sync == Sync::now) sync_folder(target.parent_path());
}

void sync_file(const std::string& path) {
  const int file = open(path.c_str(), O_RDONLY | O_CLOEXEC);
  const bool done = file >= 0 && synced(file);
  const int why = errno;
  if (file >= 0) close(file);
  if (!done) fail(path, reason_of(why));
  sync_folder(std::filesystem::path(path).parent_path());
}

std::string to_text(double value) {
  std::array<char, 32> buffer;
  const auto end = std::to_chars(buffer.data(), buffer.data() + buffer.size(), value);
  return {buffer.data(), end.ptr};
}

std::string to_text(long long value) { return std::to_string(value); }

std::string to_text(double value, int digits) {
  std::array<char, 64> buffer;
  const auto end = std::to_chars(buffer.data(), buffer.data() + buffer.size(), value,
                                 std::chars_format::general, digits);
  return {buffer.data(), end.ptr};
}

std::string read_regular_file(const std::string& path, const std::string& what) {
  // A pipe or a device may never end, or never deliver data.
  std::error_code code;
  const auto status = std::filesystem::status(path, code);
  if (std::filesystem::exists(status) && !std::filesystem::is_regular_file(status))
    throw Error::input(path + ": " + what + " is read from a regular file, not from a " +
                       (std::filesystem::is_directory(status) ? "folder" : "pipe or device"));
  std::ifstream file(path, std::ios::binary);
  if (!file) throw Error::input(path + ": cannot be read");
  const auto size = std::filesystem::file_size(path, code);
  std::string out(code ? 0 : size, '\0');
  for (size_t done = 0;; out.resize(2 * out.size() + 1)) {
    file.read(out.data() + done, static_cast<std::streamsize>(out.size() - done));
    done += static_cast<size_t>(file.gcount());
    if (file && file.peek() != std::ifstream::traits_type::eof()) continue;
    out.resize(done);
    return out;
  }
}

}  // namespace flexmorph::io
