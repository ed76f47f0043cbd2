#include "cases/check/templates.h"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <cctype>
#include <cerrno>
#include <filesystem>
#include <system_error>

#include "cases/check/ready.h"
#include "geometry/text.h"
#include "io/case_files/case_parser.h"
#include "io/files.h"
#include "io/tables.h"

namespace flexmorph::cases {
namespace {

namespace fs = std::filesystem;

constexpr size_t kLongestName = 100;  // because names become parts of folder names
const std::string kEnding = ".toml";

std::string templates_folder() { return cases_folder() + "/templates"; }

/// Throws for a name that could not be used on the command line, in a folder name, or as a case.
void require_name(const std::string& name) {
  const auto is_letter = [](unsigned char c) {
    return c < 128 && (std::isalnum(c) != 0 || c == '_' || c == '-');
  };
  if (name.empty() || name.size() > kLongestName || name[0] == '-' || name[0] == '_' ||
      !std::all_of(name.begin(), name.end(), is_letter))
    throw Error::input("new: '" + name +
                       "' is no name of a case; a name has letters, digits, _ and -, begins with a "
                       "letter or digit, and has at most " +
                       std::to_string(kLongestName) + " characters");
  const std::vector<std::string> shipped = shipped_cases();
  if (std::find(shipped.begin(), shipped.end(), name) != shipped.end())
    throw Error::input("new: '" + name + "' is the name of a shipped case; choose another name");
}

/// Creates a file that did not exist.
void write_only_new(const std::string& path, const std::string& text) {
  const int file = open(path.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
  if (file < 0 && errno == EEXIST)
    throw Error::input("new: '" + path + "' exists already; choose another name");
  const auto reason = [] { return std::generic_category().message(errno); };
  if (file < 0) throw Error::input("new: '" + path + "' cannot be created: " + reason());
  size_t written = 0;
  while (written < text.size()) {
    const ssize_t n = write(file, text.data() + written, text.size() - written);
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) break;
    written += static_cast<size_t>(n);
  }
  const std::string why = reason();
  if (close(file) == 0 && written == text.size()) return;
  unlink(path.c_str());
  throw Error::numerical(path + ": cannot be written: " + why);
}

}  // namespace

std::vector<std::string> template_kinds() {
  std::vector<std::string> out;
  std::error_code none;  // ignored: the folder is missing if the program was moved without it
  for (const auto& entry : fs::directory_iterator(templates_folder(), none))
    if (entry.path().extension() == kEnding) out.push_back(entry.path().stem().string());
  std::sort(out.begin(), out.end());
  return out;
}

std::string list_of_templates() {
  std::vector<std::vector<std::string>> rows;
  for (const std::string& kind : template_kinds())
    rows.push_back({"  " + kind, title_of_case(find_template(kind))});
  return io::aligned_table(rows);
}

std::string find_template(const std::string& kind) {
  const std::vector<std::string> kinds = template_kinds();
  if (std::find(kinds.begin(), kinds.end(), kind) != kinds.end())
    return templates_folder() + "/" + kind + kEnding;
  const std::string close = io::nearest(kind, kinds);
  throw Error::input("new: there is no kind '" + kind + "'; the kinds are: " + joined(kinds) +
                     (close.empty() ? "" : "; did you mean '" + close + "'?"));
}

std::string write_new_case(const std::string& name, const std::string& kind) {
  const std::string stem =
      name.ends_with(kEnding) ? name.substr(0, name.size() - kEnding.size()) : name;
  require_name(stem);
  const std::string text = io::read_regular_file(find_template(kind), "a case");
  std::string path = stem + kEnding;
  write_only_new(path, "# " + path + " was written by: flexmorph new " + stem + " --kind " + kind +
                           "\n# What it contains, and what it costs: flexmorph check " + path +
                           "\n# The run, with its results in runs/" + stem + ": flexmorph run " +
                           path +
                           "\n# All keys of case files, with units and default values: flexmorph "
                           "keys\n" +
                           text);
  return path;
}

}  // namespace flexmorph::cases
