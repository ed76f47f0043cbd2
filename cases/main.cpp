#include <CLI/CLI.hpp>
#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <filesystem>
#include <new>
#include <system_error>

#include "cases/check/ready.h"
#include "cases/commands/command.h"
#include "cases/process/blas_buffers.h"
#include "cases/process/processor.h"
#include "cases/scene/version.h"
#include "geometry/plain_numbers.h"
#include "geometry/text.h"
#include "io/case_files/case_parser.h"
#include "io/screen.h"

namespace {

using flexmorph::Error;
using namespace flexmorph::cases;

/// Verifies the first argument of the program.
/// @throws Error (input) for an argument that is neither a command nor an option.
void refuse_unknown_command(const CLI::App& app, const std::string& word) {
  if (word.empty() || word[0] == '-') return;
  std::vector<std::string> names;
  for (const CLI::App* command : app.get_subcommands({})) names.push_back(command->get_name());
  if (std::find(names.begin(), names.end(), word) != names.end()) return;
  const std::vector<std::string> shipped = shipped_cases();
  if (std::filesystem::is_regular_file(word) ||
      std::find(shipped.begin(), shipped.end(), word) != shipped.end())
    throw Error::input("'" + word + "' is a case, not a command; use: flexmorph run " + word);
  const std::string close = flexmorph::io::nearest(word, names);
  throw Error::input("'" + word + "' is not a command" +
                     (close.empty() ? "; the commands are: " + flexmorph::joined(names)
                                    : ", did you mean '" + close + "'?"));
}

/// Flushes the standard output.
/// @throws Error (input) if it cannot be written, for example on a full disk or a closed pipe.
void finish_output() {
  if (std::fflush(stdout) != 0 || std::ferror(stdout) != 0)
    throw Error::input("the output cannot be written: " + std::generic_category().message(errno));
}

/// Returns the help text of the selected command, or of the program.
std::string shown_help(const CLI::App& app) {
  constexpr size_t kTextOfOptions = 30;  // column of CLI11
  return flexmorph::io::fitted_text(app.help(), flexmorph::io::screen_width(), kTextOfOptions);
}

int parse_and_run(int argc, char** argv) {
  CLI::App app("Topology optimization of flexible mechanisms", "flexmorph");
  app.set_version_flag("--version", std::string("flexmorph ") + kVersion);
  app.footer(std::string("Options of a command: flexmorph COMMAND --help\n\n") + kExitCodes);
  app.require_subcommand(1);
  std::vector<Command> commands;
  for (const auto& make :
       {commands_of_runs, commands_of_studies, commands_of_folders, commands_of_texts})
    for (Command& command : make(app)) commands.push_back(std::move(command));
  CLI::App* help = app.add_subcommand("help", "prints this list");
  std::string all_help = shown_help(app);  // after parsing it would be the help of one command
  commands.push_back(printing(help, [&] { return all_help; }));
  if (argc > 1)
    refuse_unknown_command(app, argv[1]);
  else
    std::fputs(all_help.c_str(), stdout);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    if (error.get_name() != "CallForHelp") return app.exit(error) == 0 ? 0 : 2;
    std::fputs(shown_help(app).c_str(), stdout);
    return 0;
  }
  for (const Command& command : commands) {
    if (!*command.app) continue;
    const int threads = command.threads ? *command.threads : 1;
    flexmorph::set_up_processor(threads, argv);
    if (command.computes) flexmorph::reserve_blas(threads);
    return command.run();
  }
  return 0;
}

}  // namespace

/// Runs the program and returns its exit code, see kExitCodes.
int main(int argc, char** argv) {
  const flexmorph::PlainNumbers plain;  // also for numbers in messages
  try {
    const int code = parse_and_run(argc, argv);
    finish_output();
    return code;
  } catch (const Error& error) {
    std::fprintf(stderr, "flexmorph: %s\n", error.what());
    return error.kind() == Error::Kind::input ? 2 : 3;
  } catch (const std::bad_alloc&) {
    std::fputs("flexmorph: there is not enough memory\n", stderr);
    return 3;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "flexmorph: unexpected error: %s\n", error.what());
    return 1;
  }
}
