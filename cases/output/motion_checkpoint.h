#pragma once

#include <chrono>
#include <optional>
#include <string>
#include <vector>

#include "cases/output/run_folder.h"

namespace flexmorph::cases {

/// What a motion needs to go on, in a file of its run folder, while the run is not done.
///
/// File: a line with its format and the program's version, then a checksum of what is left: what
/// the motion depends on (its case with the files it reads, its design and mesh) as a checksum, the
/// frames that must be there, and the memory, in the byte order of the machine. It is replaced as a
/// whole, and on the disk when the motion goes on.
class MotionCheckpoint {
 public:
  /// @param name  of the file
  /// @param about  what the motion depends on besides the case
  /// @param every  seconds at least between two files
  MotionCheckpoint(RunFolder& folder, const std::string& name, const std::string& about,
                   double every);

  /// The memory; none where there is no file, or one that cannot be used.
  /// @param why  is why not: "it is damaged"; empty where there is no file
  std::optional<std::string> read(std::string& why) const;

  /// Is it time? Files that take long are written the more seldom: they cost a twentieth at most.
  bool is_due() const;
  /// @param frames  files that the motion has written, as RunFolder::file() takes them
  /// @throws Error (numerical) when it cannot be written; the one before it stays.
  void write(const std::string& memory, std::vector<std::string> frames);

 private:
  using Clock = std::chrono::steady_clock;
  RunFolder& folder_;
  std::string name_, path_;
  std::uint64_t about_;
  std::chrono::duration<double> every_, took_{0};
  Clock::time_point written_ = Clock::now();
};

}  // namespace flexmorph::cases
