#include "cases/run/finished_run.h"

#include <filesystem>
#include <nlohmann/json.hpp>

#include "cases/output/run_folder.h"
#include "io/case_files/case_parser.h"

namespace flexmorph::cases {

namespace fs = std::filesystem;

std::string finished_case(const std::string& directory) {
  const std::string absolute = fs::absolute(directory).string();
  std::string kept = absolute + "/case.toml";
  const std::string results = absolute + "/run.json";
  for (const std::string& path : {kept, results})
    if (!fs::is_regular_file(path))
      throw Error::input("'" + directory +
                         "' is not the folder of a finished run: it does not contain " +
                         fs::path(path).filename().string());
  const nlohmann::json run = nlohmann::json::parse(io::read_text(results));
  if (const std::string status = run.value("status", ""); !status.starts_with("done"))
    throw Error::input("'" + directory +
                       "' is not the folder of a finished run: the status in run.json is \"" +
                       status + "\"");
  return kept;
}

std::vector<std::string> changes_to_designs(const std::string& directory, const Scene& scene) {
  std::vector<std::string> out;
  for (size_t d = 0; d < scene.designs.size(); ++d)
    out.push_back("design." + std::to_string(d) + ".start='" + fs::absolute(directory).string() +
                  "/" + components_name(scene, scene.designs[d].body) + "'");
  return out;
}

}  // namespace flexmorph::cases
