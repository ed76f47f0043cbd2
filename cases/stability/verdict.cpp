#include "cases/stability/verdict.h"

#include <algorithm>
#include <cctype>
#include <csignal>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <sstream>

namespace flexmorph::cases {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

std::optional<double> number(const json& object, const char* key) {
  if (!object.is_object() || !object.contains(key) || !object[key].is_number()) return {};
  return object[key].get<double>();
}

auto numbers_of(const json& run) {
  const json motion = run.value("motion", json()), path = run.value("static", json());
  const json& solved = motion.is_null() ? path : motion;
  const auto iterations = number(solved, "newton_iterations"),
             steps = number(solved, motion.is_null() ? "equilibria" : "steps");
  std::optional<double> newton, condition;
  if (iterations && steps && *steps > 0) newton = *iterations / *steps;
  std::vector<json> solvers = {motion, path};
  for (const json& body : run.value("results", json::array())) solvers.push_back(body);
  for (const json& solver : solvers)
    if (const auto c = number(solver, "condition")) condition = std::max(*c, condition.value_or(1));
  return decltype(Assessment::numbers){
      number(motion, "energy_error"),       number(motion, "constraint_drift"),
      number(motion, "velocity_drift"),     newton,
      number(solved, "rejected_steps"),     condition,
      number(motion, "smallest_area_ratio")};
}

bool is_non_finite(std::string cell) {
  std::transform(cell.begin(), cell.end(), cell.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  if (cell.starts_with("-")) cell.erase(0, 1);
  return cell == "nan" || cell == "inf";
}

/// Returns the number of the line of a CSV file with the first NaN or infinity; 0 if there is none.
size_t non_finite_line(const fs::path& file) {
  std::istringstream in(text_of(file.string()));
  size_t number = 0;
  for (std::string line; std::getline(in, line);) {
    ++number;
    std::istringstream cells(line);
    for (std::string cell; std::getline(cells, cell, ',');)
      if (is_non_finite(cell)) return number;
  }
  return 0;
}

/// Returns a message on the first number in run.json and in the tables of a folder that is not
/// finite; empty if there is none. A run writes null for NaN to run.json, because JSON has no NaN.
std::string first_non_finite(const std::string& folder, const json& run) {
  for (const char* part : {"motion", "static"})
    if (run.is_object() && run.contains(part) && run[part].is_object())
      for (const auto& [key, value] : run[part].items())
        if (value.is_null())
          return std::string("run.json: ") + part + "." + key + " is not a number";
  std::vector<fs::path> files;
  std::error_code error;
  for (fs::recursive_directory_iterator at(folder, error), end; !error && at != end;
       at.increment(error))
    if (at->is_regular_file() && at->path().extension() == ".csv") files.push_back(at->path());
  std::sort(files.begin(), files.end());
  for (const fs::path& file : files)
    if (const size_t line = non_finite_line(file); line > 0)
      return fs::relative(file, folder).generic_string() + ":" + std::to_string(line) +
             ": a number is not finite";
  return "";
}

}  // namespace

std::string to_string(StabilityVerdict verdict) {
  switch (verdict) {
    case StabilityVerdict::stable:
      return "stable";
    case StabilityVerdict::refused:
      return "refused";
    case StabilityVerdict::degraded:
      return "degraded";
    case StabilityVerdict::wrong:
      break;
  }
  return "WRONG";
}

Assessment assess(const VariantResult& result) {
  Assessment out;
  const Ending& ending = result.ending;
  const json run = json::parse(text_of(result.directory + "/run.json"), nullptr, false);
  if (run.is_object()) out.numbers = numbers_of(run);
  out.reason = result.message;
  if (ending.over_time && ending.signal == SIGKILL) {
    out.reason = "the run did not end after SIGINT";
  } else if (std::string found = first_non_finite(result.directory, run); !found.empty()) {
    out.reason = std::move(found);
  } else if (ending.over_time) {
    out.verdict = StabilityVerdict::degraded;
  } else if (result.done()) {
    const json warnings = run.value("warnings", json::array());
    out.verdict = warnings.empty() ? StabilityVerdict::stable : StabilityVerdict::degraded;
    if (!warnings.empty()) out.reason = warnings.front().get<std::string>();
  } else if ((ending.code == 2 || ending.code == 3) && !result.message.empty()) {
    out.verdict = StabilityVerdict::refused;
  }
  return out;
}

}  // namespace flexmorph::cases
