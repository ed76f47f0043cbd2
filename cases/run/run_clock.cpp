#include "cases/run/run_clock.h"

#include <sys/resource.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "geometry/cpu_time.h"
#include "io/files.h"

namespace flexmorph::cases {
namespace {

using Json = nlohmann::json;

constexpr std::chrono::milliseconds kBetweenWrites(500);
/// Phases whose CPU times are those of one call. The other phases are summed in history.csv.
constexpr std::array kPhasesOfCalls = {"unloaded_components", "motion", "outline_verification",
                                       "verification"};

std::string key_of(const std::string& phase) { return "seconds_" + phase; }

double number(const Json& object, const std::string& key) {
  const auto found = object.find(key);
  return found != object.end() && found->is_number() ? found->get<double>() : 0;
}

/// Returns the times in a file; zeros if there is no such file or it has no times.
RunInfo times_in(const std::string& path) {
  RunInfo out;
  if (!std::filesystem::is_regular_file(path)) return out;
  const Json times = Json::parse(io::read_regular_file(path, "a file of times"), nullptr, false);
  if (!times.is_object()) return out;
  out.seconds_wall = number(times, "seconds_wall");
  out.seconds_cpu = number(times, "seconds_cpu");
  out.peak_memory_bytes = number(times, "peak_memory_bytes");
  const Json phases = times.value("seconds_by_phase", Json::object());
  for (const char* phase : kPhasesOfCalls)
    if (phases.contains(key_of(phase)))
      out.phases.emplace_back(phase, number(phases, key_of(phase)));
  return out;
}

}  // namespace

RunClock::RunClock() : cpu_begin_(cpu_seconds()) {}

RunClock RunClock::since_process_start() {
  RunClock out;
  out.cpu_begin_ = 0;
  return out;
}

void RunClock::add_earlier(const std::string& folder) {
  const RunInfo ended = times_in(folder + "/run.json"), kept = times_in(folder + "/" + kTimesFile);
  earlier_ = kept.seconds_cpu > ended.seconds_cpu ? kept : ended;
  if (earlier_.phases.empty()) earlier_.phases = kept.phases;
}

void RunClock::keep(const std::string& path) {
  const Clock::time_point now = Clock::now();
  if (now < next_) return;
  next_ = now + kBetweenWrites;
  RunInfo info;
  read(info);
  Json phases = Json::object();
  for (const auto& [phase, seconds] : earlier_.phases) phases[key_of(phase)] = seconds;
  try {
    io::write_file(path, Json{{"seconds_wall", info.seconds_wall},
                              {"seconds_cpu", info.seconds_cpu},
                              {"peak_memory_bytes", info.peak_memory_bytes},
                              {"seconds_by_phase", phases}}
                             .dump());
  } catch (const Error&) {
  }
}

void RunClock::read(RunInfo& info) const {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  info.seconds_wall =
      earlier_.seconds_wall + std::chrono::duration<double>(Clock::now() - begin_).count();
  info.seconds_cpu = earlier_.seconds_cpu + cpu_seconds() - cpu_begin_;
  info.peak_memory_bytes =
      std::max(earlier_.peak_memory_bytes, 1024.0 * static_cast<double>(usage.ru_maxrss));
  for (auto& [name, seconds] : info.phases)
    for (const auto& [phase, before] : earlier_.phases)
      if (name == phase) seconds += before;
}

}  // namespace flexmorph::cases
