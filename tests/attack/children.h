#pragma once

#include <gtest/gtest.h>
#include <signal.h>

#include <chrono>
#include <filesystem>
#include <string>
#include <thread>

#include "io/output_folder.h"
#include "tests/support/watch/watch.h"

namespace flexmorph::testing {

/// Waits until no process fills a subfolder of the folder of a killed study, because its child
/// processes end slightly later. After 30 s all descendants of this test are killed, and the test
/// fails.
inline void wait_for_children(const std::string& folder) {
  using Clock = std::chrono::steady_clock;
  const Clock::time_point end = Clock::now() + std::chrono::seconds(30);
  for (bool lives = true; lives;) {
    lives = false;
    for (const auto& entry : std::filesystem::directory_iterator(folder))
      lives = lives || (entry.is_directory() && io::is_being_filled(entry.path().string()));
    if (lives && Clock::now() > end) {
      ADD_FAILURE() << "children of a killed study still fill " << folder << " after 30 s";
      kill_descendants();
      return;
    }
    if (lives) std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
}

}  // namespace flexmorph::testing
