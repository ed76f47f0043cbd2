#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <string>

#include "geometry/base.h"
#include "io/tables.h"
#include "tests/cases/program.h"
#include "tests/cases/run_json.h"

/// Functions that compare disturbed and resumed runs with undisturbed ones.
namespace flexmorph::test {

namespace fs = std::filesystem;

/// Returns the files of a folder by their path in it, without run times and without data about the
/// process that wrote them.
inline std::map<std::string, std::string> lasting(const std::string& folder) {
  std::map<std::string, std::string> out;
  for (const auto& entry : fs::recursive_directory_iterator(folder)) {
    const std::string path = fs::relative(entry.path(), folder).string(),
                      name = entry.path().filename().string();
    if (!entry.is_regular_file() || name == ".flexmorph" || name == "report.html" ||
        name.ends_with(".log") || name == "sweep.md" || name == "sweep.html")
      continue;
    std::string text = contents_of(entry.path().string());
    if (name == "run.json") {
      json run = json::parse(text);
      for (const char* key :
           {"seconds_wall", "seconds_cpu", "seconds_by_phase", "peak_memory_bytes"})
        run.erase(key);
      for (json& result : run["results"])
        if (result.contains("body_fitted")) result["body_fitted"].erase("seconds");
      text = run.dump();
    }
    if (name == "history.csv" || name == "sweep.csv" || name == "rows.csv") {
      const io::CsvTable table = io::read_csv(entry.path().string());
      text.clear();
      for (size_t c = 0; c < table.columns.size(); ++c) {
        if (table.columns[c].find("seconds") != std::string::npos ||
            table.columns[c] == "peak_memory_bytes")
          continue;
        text += table.columns[c];
        for (const auto& cell : table.texts(table.columns[c])) text += "," + cell;
      }
    }
    out[path] = text;
  }
  return out;
}

inline Words text_of(const std::string& path, const std::string& folder, const Words& changes,
                     bool resume = false) {
  Words out = {"run", path, "-o", folder, "--quiet", "--set", "expect="};
  for (const std::string& change : changes) out.insert(out.end(), {"--set", change});
  if (resume) out.emplace_back("--resume");
  return out;
}

inline void expect_same(const std::map<std::string, std::string>& a,
                        const std::map<std::string, std::string>& b) {
  for (const auto& [name, text] : a) EXPECT_TRUE(b.contains(name) && b.at(name) == text) << name;
  for (const auto& [name, text] : b) EXPECT_TRUE(a.contains(name)) << name;
}

/// Returns the files of a run that are incomplete. At any moment, texts must end with a complete
/// row and indices must name existing frames. Files that are being replaced or removed are skipped.
inline Words unreadable(const std::string& folder) {
  Words out;
  std::error_code code;
  std::vector<fs::path> paths;
  for (fs::recursive_directory_iterator at(folder, code), end; !code && at != end;
       at.increment(code))
    paths.push_back(at->path());
  for (const fs::path& path : paths) {
    const std::string ending = path.extension().string();
    if (ending == ".tmp" || !fs::is_regular_file(path, code)) continue;
    const std::string text = contents_of(path.string());
    if (text.empty()) continue;  // just created, or removed
    bool good = true;
    if (ending == ".json") good = json::accept(text);
    if (ending == ".vti" || ending == ".vtp" || ending == ".vtu")
      good = text.ends_with("</VTKFile>\n");
    if (ending == ".csv") {
      good = text.back() == '\n';
      try {
        io::read_csv(path.string());  // throws if a row is not as long as the header
      } catch (const flexmorph::Error&) {
        good = false;
      }
    }
    const std::string key = "file=\"";
    for (size_t at = ending == ".pvd" ? text.find(key) : std::string::npos; at != std::string::npos;
         at = text.find(key, at + 1)) {
      const size_t begin = at + key.size();
      good = good &&
             fs::exists(path.parent_path() / text.substr(begin, text.find('"', begin) - begin));
    }
    if (!good) out.push_back(path.string());
  }
  return out;
}

inline void expect_readable(const std::string& folder) {
  for (const std::string& file : unreadable(folder)) ADD_FAILURE() << file;
}

}  // namespace flexmorph::test
