#include "cases/run/live_page.h"

#include <spawn.h>
#include <unistd.h>

#include <cstdlib>

#include "cases/output/report.h"

namespace flexmorph::cases {
namespace {

constexpr std::chrono::seconds kMinPause(5);  // between two pages
constexpr int kTimeFactor = 20;               // of the pause to the time of writing a page

}  // namespace

void LivePage::update(const std::string& words) {
  const Clock::time_point now = Clock::now();
  if (now < next_) return;
  RunResult result;
  result.info.message = words;
  result.info.seconds_wall = std::chrono::duration<double>(now - begin_).count();
  try {
    write_live_report(scene_, result, folder_);
  } catch (const Error&) {
  }
  const Clock::time_point end = Clock::now();
  next_ = end + std::max<Clock::duration>(kMinPause, kTimeFactor * (end - now));
}

std::string open_on_desktop(const std::string& path) {
  const auto has = [](const char* variable) {
    const char* value = std::getenv(variable);
    return value != nullptr && *value != '\0';
  };
  if (!has("DISPLAY") && !has("WAYLAND_DISPLAY"))
    return "There is no display. Open " + path + " in a browser.";
  const char* const words[] = {"xdg-open", path.c_str(), nullptr};
  pid_t process = 0;
  const int error =
      posix_spawnp(&process, words[0], nullptr, nullptr, const_cast<char* const*>(words), environ);
  return error == 0 ? "" : "xdg-open is not installed. Open " + path + " in a browser.";
}

}  // namespace flexmorph::cases
