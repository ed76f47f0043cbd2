#include "cases/output/kept_case.h"

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

/// Returns a unique name of a copy: inputs/NAME, or inputs/2_NAME if another file has this name.
std::string free_name(const std::string& path, std::set<std::string>& taken) {
  const std::string name = fs::path(path).filename().string();
  std::string out = "inputs/" + name;
  for (int k = 2; !taken.insert(out).second; ++k) out = "inputs/" + std::to_string(k) + "_" + name;
  return out;
}

/// Overrides that make a case read the copies of its files, with the paths of the originals and the
/// names of the copies.
struct Copies {
  std::vector<std::string> changes, sources, names;

  explicit Copies(const io::CaseFile& file) {
    std::set<std::string> taken;
    for (const std::string& each : overrides_of_files(file)) {
      const size_t at = each.find('=');  // such as "drive.0.csv='/data/turn.csv'"
      sources.push_back(each.substr(at + 2, each.size() - at - 3));
      names.push_back(free_name(sources.back(), taken));
      changes.push_back(each.substr(0, at) + "='" + names.back() + "'");
    }
  }
};

}  // namespace

void keep_case(const io::CaseFile& file, bool explain, RunFolder& folder) {
  const Copies copies(file);
  for (size_t i = 0; i < copies.names.size(); ++i)
    folder.write_text(copies.names[i], contents_of(copies.sources[i]));
  folder.write_text("case.toml",
                    explain ? file.explained(copies.changes) : file.text(copies.changes));
}

bool keeps_case(const std::string& folder, const io::CaseFile& file) {
  const Copies copies(file);
  const auto holds = [&](const std::string& name, const std::string& text) {
    const std::string path = folder + "/" + name;
    return fs::is_regular_file(path) && contents_of(path) == text;
  };
  if (!holds("case.toml", file.text(copies.changes))) return false;
  for (size_t i = 0; i < copies.names.size(); ++i)
    if (!holds(copies.names[i], contents_of(copies.sources[i]))) return false;
  return true;
}

}  // namespace flexmorph::cases
