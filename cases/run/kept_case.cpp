#include "cases/run/kept_case.h"

#include <filesystem>
#include <fstream>
#include <iterator>
#include <set>

#include "cases/scene/scene.h"

namespace flexmorph::cases {
namespace {

namespace fs = std::filesystem;

std::string contents_of(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  if (!in) throw Error::input(path + ": cannot be read");
  return {std::istreambuf_iterator<char>(in), {}};
}

/// inputs/NAME, or inputs/2_NAME where another file of the case has the name.
std::string free_name(const std::string& path, std::set<std::string>& taken) {
  const std::string name = fs::path(path).filename().string();
  std::string out = "inputs/" + name;
  for (int k = 2; !taken.insert(out).second; ++k) out = "inputs/" + std::to_string(k) + "_" + name;
  return out;
}

}  // namespace

void keep_case(const io::CaseFile& file, bool explain, RunFolder& folder) {
  std::vector<std::string> changes;
  std::set<std::string> taken;
  for (const std::string& each : overrides_of_files(file)) {
    const size_t at = each.find('=');  // "drive.0.csv='/data/turn.csv'"
    const std::string path = each.substr(at + 2, each.size() - at - 3);
    const std::string name = free_name(path, taken);
    folder.write_text(name, contents_of(path));
    changes.push_back(each.substr(0, at) + "='" + name + "'");
  }
  folder.write_text("case.toml", explain ? file.explained(changes) : file.text(changes));
}

}  // namespace flexmorph::cases
