#include <algorithm>
#include <cctype>
#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <sstream>

#include "cases/stability/judge.h"
#include "cases/study/study.h"
#include "io/tables.h"

namespace flexmorph::cases {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

/// Keys of run.json that say with null that there is nothing to say.
bool may_be_null(const std::string& key) {
  static const std::vector<std::string> kKeys = {"min_feature",
                                                 "min_gap",
                                                 "found",
                                                 "dynamic_amplitude",
                                                 "uniform_dynamic_amplitude",
                                                 "scene_mesh_amplitude",
                                                 "scene_mesh_uniform_amplitude"};
  return std::find(kKeys.begin(), kKeys.end(), key) != kKeys.end();
}

/// Json has no NaN: the program writes null in its place. @return the path to the first one.
std::string first_null(const json& value, const std::string& path) {
  if (value.is_null()) return path;
  if (!value.is_structured()) return "";
  size_t index = 0;
  for (auto at = value.begin(); at != value.end(); ++at, ++index) {
    const std::string key = value.is_object() ? at.key() : std::to_string(index);
    if (at->is_null() && may_be_null(key)) continue;
    const std::string found = first_null(*at, path.empty() ? key : path + "." + key);
    if (!found.empty()) return found;
  }
  return "";
}

/// NaN or infinity as a word of its own in a line; empty: none.
std::string unreal_word(const std::string& line) {
  std::string lower = line;
  std::transform(lower.begin(), lower.end(), lower.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  const auto in_word = [&](size_t i) {
    return i < lower.size() &&
           (std::isalnum(static_cast<unsigned char>(lower[i])) != 0 || lower[i] == '_');
  };
  for (const std::string word : {"nan", "inf", "infinity"})
    for (size_t at = lower.find(word); at != std::string::npos; at = lower.find(word, at + 1))
      if (!(at > 0 && in_word(at - 1)) && !in_word(at + word.size())) return word;
  return "";
}

std::string unreal_line(const fs::path& path) {
  std::istringstream in(text_of(path.string()));
  size_t number = 0;
  for (std::string line; std::getline(in, line);) {
    ++number;
    if (const std::string word = unreal_word(line); !word.empty())
      return std::string(":").append(std::to_string(number)).append(": ").append(word);
  }
  return "";
}

json run_of(const std::string& folder) {
  return json::parse(text_of(folder + "/run.json"), nullptr, false);
}

std::optional<double> of_column(const std::vector<double>& values, const std::string& what) {
  if (values.empty()) return {};
  if (what.empty()) return values.back();
  const auto [low, high] = std::minmax_element(values.begin(), values.end());
  if (what == "span") return *high - *low;
  return std::max(std::abs(*low), std::abs(*high));
}

}  // namespace

std::string first_unreal(const std::string& folder) {
  std::vector<fs::path> files;
  std::error_code error;
  for (fs::recursive_directory_iterator at(folder, error), end; !error && at != end;
       at.increment(error))
    if (at->is_regular_file()) files.push_back(at->path());
  std::sort(files.begin(), files.end());
  for (const fs::path& file : files) {
    const std::string name = fs::relative(file, folder).generic_string();
    const std::string ending = file.extension().string();
    if (name == "run.json") {
      if (const std::string key = first_null(run_of(folder), ""); !key.empty())
        return "run.json: " + key + " is no number";
      continue;
    }
    // Of VTK files the writer itself refuses what is not finite; their base64 is no text.
    if (ending != ".csv" && ending != ".svg" && ending != ".dxf" && ending != ".stl" &&
        ending != ".step")
      continue;
    if (const std::string place = unreal_line(file); !place.empty()) return name + place;
  }
  return "";
}

std::optional<double> quantity_in(const std::string& folder, const std::string& quantity) {
  const json run = run_of(folder);
  if (quantity == "events") {
    if (!run.is_object() || !run.contains("motion")) return {};
    return static_cast<double>(run["motion"].value("events", json::array()).size());
  }
  if (run.is_object() && run.contains("results") && run["results"].is_array() &&
      !run["results"].empty()) {
    const json& first = run["results"][0];
    if (first.contains(quantity) && first[quantity].is_number())
      return first[quantity].get<double>();
    if (first.contains(quantity) && first[quantity].is_boolean())
      return first[quantity].get<bool>() ? 1 : 0;
  }
  for (const char* name : {"/motion.csv", "/path.csv"}) {
    if (!fs::exists(folder + name)) continue;
    const io::CsvTable table = io::read_csv(folder + name);
    for (const std::string& column : table.columns) {
      if (column == quantity) return of_column(table.numbers(column), "");
      for (const std::string what : {"largest", "span"})
        if (column + "." + what == quantity) return of_column(table.numbers(column), what);
    }
  }
  return {};
}

}  // namespace flexmorph::cases
