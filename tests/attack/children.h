#pragma once

#include <chrono>
#include <filesystem>
#include <string>
#include <thread>

#include "io/output_folder.h"

namespace flexmorph::testing {

/// Children of a killed study end with it, a moment later: until none fills a folder in that of the
/// study any more.
inline void wait_for_children(const std::string& folder) {
  for (bool lives = true; lives;) {
    lives = false;
    for (const auto& entry : std::filesystem::directory_iterator(folder))
      lives = lives || (entry.is_directory() && io::is_being_filled(entry.path().string()));
    if (lives) std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
}

}  // namespace flexmorph::testing
