#include "cases/output/motion_checkpoint.h"

#include <algorithm>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>

#include "cases/scene/version.h"
#include "io/files.h"

namespace flexmorph::cases {
namespace {

namespace fs = std::filesystem;

const std::string kFormat = "flexmorph motion 3";
/// Largest fraction of the time between two writes that a write may take.
constexpr double kTimeFraction = 0.05;

/// Returns the contents of a file; empty if it cannot be read.
std::string contents_of(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

/// Returns the names and contents of the case of a folder and of the files that it reads, sorted by
/// name.
std::string case_of(const std::string& folder) {
  std::vector<std::string> paths = {folder + "/case.toml"};
  if (fs::is_directory(folder + "/inputs"))
    for (const auto& entry : fs::directory_iterator(folder + "/inputs"))
      paths.push_back(entry.path().string());
  std::sort(paths.begin() + 1, paths.end());
  std::string out;
  for (const std::string& path : paths)
    if (fs::is_regular_file(path)) out += path.substr(folder.size()) + "\n" + contents_of(path);
  return out;
}

}  // namespace

MotionCheckpoint::MotionCheckpoint(RunFolder& folder, const std::string& name,
                                   const std::string& about, double every)
    : folder_(folder),
      name_(name),
      path_(folder.file(name)),
      about_(checksum(case_of(folder.path()) + about)),
      every_(every) {}

std::optional<std::string> MotionCheckpoint::read(std::string& why) const {
  why.clear();
  if (!fs::exists(path_)) return {};
  const std::string text = contents_of(path_);
  const size_t head = text.find('\n');
  if (!text.starts_with(kFormat + ", ") || head == std::string::npos) {
    why = "it does not have the format of a checkpoint";
    return {};
  }
  const std::string version = text.substr(kFormat.size() + 2, head - kFormat.size() - 2);
  if (version != kVersion) {
    why = "it was written by version " + version.substr(0, 40) + ", but the program has version " +
          kVersion;
    return {};
  }
  try {
    const size_t rest = head + 1 + sizeof(std::uint64_t);
    std::uint64_t sum = 0, about = 0, size = 0;
    if (text.size() < rest) throw Error::input("");
    std::memcpy(&sum, text.data() + head + 1, sizeof sum);
    if (checksum(std::string_view(text).substr(rest)) != sum) throw Error::input("");
    std::vector<std::string> frames;
    Archive file(text.substr(rest));
    file(about, frames, size);
    if (size > text.size() - rest) throw Error::input("");
    if (about != about_) why = "it belongs to another case or design";
    for (const std::string& frame : frames)
      if (why.empty() && !fs::exists(folder_.path() + "/" + frame))
        why = "the file " + frame + " is missing";
    if (why.empty()) return text.substr(text.size() - size);
  } catch (const Error&) {
    why = "it is damaged";
  }
  return {};
}

bool MotionCheckpoint::is_due() const {
  return Clock::now() - written_ >= std::max(every_, took_ / kTimeFraction);
}

void MotionCheckpoint::write(std::string_view steps, std::string_view motion,
                             std::vector<std::string> frames) {
  const Clock::time_point begin = Clock::now();
  Archive head;
  std::uint64_t sum = 0, size = steps.size() + motion.size();
  head(about_, frames, size);
  // Archives are large: the contents are put together in one string, which is written as it is.
  std::string contents = kFormat + ", " + kVersion + "\n";
  const size_t at = contents.size();
  contents.reserve(at + sizeof sum + head.bytes().size() + size);
  contents.append(sizeof sum, '\0').append(head.bytes()).append(steps).append(motion);
  sum = checksum(std::string_view(contents).substr(at + sizeof sum));
  std::memcpy(contents.data() + at, &sum, sizeof sum);
  io::write_file(folder_.file(name_), contents, io::Sync::now);
  written_ = Clock::now();
  took_ = written_ - begin;
}

}  // namespace flexmorph::cases
