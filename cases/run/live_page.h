#pragma once

#include <chrono>
#include <string>

#include "cases/output/run_folder.h"

namespace flexmorph::cases {

/// The page of a run that goes on: report.html with the designs and iterations so far. It is
/// written again at intervals, so that at most a twentieth of the time is spent on it, and
/// refreshes itself in a browser until the final page replaces it.
class LivePage {
 public:
  /// Prepares the page; the scene and the folder have to outlive it.
  LivePage(const Scene& scene, RunFolder& folder) : scene_(scene), folder_(folder) {}

  /// Writes the page if the last one is old enough. Errors are ignored, because the page is written
  /// again, and at the end of the run an error is reported.
  /// @param words  position of the run in words
  void update(const std::string& words);

 private:
  using Clock = std::chrono::steady_clock;

  const Scene& scene_;
  RunFolder& folder_;
  Clock::time_point begin_ = Clock::now(), next_ = begin_;
};

/// Opens a file with the program that the desktop has for it (xdg-open).
/// @return message if there is no such program; empty if it was started
std::string open_on_desktop(const std::string& path);

}  // namespace flexmorph::cases
