#include <CLI/CLI.hpp>
#include <memory>

#include "cases/assembly/resource_estimate.h"
#include "cases/check/templates.h"
#include "cases/commands/command.h"
#include "cases/output/old_runs.h"
#include "geometry/text.h"
#include "io/screen.h"

namespace flexmorph::cases {

namespace {

/// Options of the command `new`.
struct NewOptions {
  std::string name, kind;
};

Command new_command(CLI::App& app) {
  const auto options = std::make_shared<NewOptions>();
  CLI::App* command = add_command(app, "new", "writes a short case from which you can begin",
                                  "my_crane --kind crane");
  add_value(*command, "name", options->name, "NAME", "name of the case; its file is NAME.toml")
      ->required();
  const std::vector<std::string> kinds = template_kinds();
  add_value(*command, "--kind", options->kind, "KIND", "kind of the mechanism: " + joined(kinds))
      ->required();
  return printing(command, [options] {
    const std::string path = write_new_case(options->name, options->kind);
    return path + " was written. Next:\n  flexmorph check " + path + "\n  flexmorph run " + path +
           "\n";
  });
}

/// Options of the command `clean` as they are typed.
struct CleanWords {
  CleanOptions options;
  std::string older;
  int keep = 0;
};

Command clean_command(CLI::App& app) {
  const auto words = std::make_shared<CleanWords>();
  CLI::App* command = add_command(app, "clean", "lists run folders, and removes old ones",
                                  "runs --older 30d --keep 3 --yes");
  add_value(*command, "folder", words->options.folder, "FOLDER",
            "folder with run folders (default " + words->options.folder + ")");
  add_value(*command, "--older", words->older, "TIME",
            "selects runs whose results are older, such as 12h or 30d");
  CLI::Option* keep = add_number(*command, "--keep", words->keep, 0, 1'000'000,
                                 "selects all runs except this number of newest runs of each case");
  command->add_flag("--all", words->options.selection.all, "selects all runs");
  command->add_flag("--yes", words->options.yes,
                    "removes the selected run folders; without it they are only listed");
  return printing(command, [words, keep] {
    CleanOptions options = words->options;
    if (!words->older.empty()) options.selection.older = read_duration("--older", words->older);
    if (keep->count() > 0) options.selection.keep = words->keep;
    return clean_runs(options);
  });
}

}  // namespace

std::vector<Command> commands_of_folders(CLI::App& app) {
  return {new_command(app), clean_command(app)};
}

}  // namespace flexmorph::cases
