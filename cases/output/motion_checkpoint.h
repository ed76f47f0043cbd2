#pragma once

#include <chrono>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "cases/output/run_folder.h"

namespace flexmorph::cases {

/// The checkpoint of a motion: a file in the run folder with the data that are needed to resume the
/// motion while the run is not finished.
///
/// The file consists of a line with its format and the version of the program, a checksum of the
/// rest, and the rest: a checksum of everything that the motion depends on (its case with the files
/// that the case reads, its design and mesh), the names of the frames that must exist, and the size
/// and the bytes of the archive of the motion, in the byte order of the machine. Each write
/// replaces the whole file, which is on the disk before the motion continues.
class MotionCheckpoint {
 public:
  /// Prepares the checkpoint of a motion; nothing is written.
  /// @param folder  run folder; outlives the object
  /// @param name    name of the file
  /// @param about   text of everything that the motion depends on besides the case
  /// @param every   shortest time between two writes [s]
  MotionCheckpoint(RunFolder& folder, const std::string& name, const std::string& about,
                   double every);

  /// Returns the archive of the motion; nothing if there is no file or if it cannot be used.
  /// @param why  receives the reason, such as "it is damaged"; empty if there is no file
  std::optional<std::string> read(std::string& why) const;

  /// Returns true if a new file should be written. The longer a write takes, the longer is the time
  /// until the next one, so that writing takes at most a twentieth of the run time.
  bool is_due() const;
  /// Writes the checkpoint file as a whole.
  /// @param steps   first part of the archive of the motion: what is kept of its steps
  /// @param motion  second part of the archive
  /// @param frames  files that the motion has written, with names as for RunFolder::file()
  /// @throws Error (numerical) when it cannot be written; the previous file is kept.
  void write(std::string_view steps, std::string_view motion, std::vector<std::string> frames);

 private:
  using Clock = std::chrono::steady_clock;
  RunFolder& folder_;
  std::string name_, path_;
  std::uint64_t about_;
  std::chrono::duration<double> every_, took_{0};
  Clock::time_point written_ = Clock::now();
};

}  // namespace flexmorph::cases
