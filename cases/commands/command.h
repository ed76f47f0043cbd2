#pragma once

#include <functional>
#include <string>
#include <vector>

namespace CLI {
class App;
class Option;
}  // namespace CLI

/// Commands of the program: their options, their help texts, and the functions that execute them.
namespace flexmorph::cases {

/// A command of the program. The function `run` owns the values of its options.
struct Command {
  CLI::App* app;                 ///< Name, options and help text.
  std::function<int()> run;      ///< Executes the command and returns its exit code.
  bool computes = true;          ///< True if the command needs the buffers of OpenBLAS.
  const int* threads = nullptr;  ///< Number of threads that the user asked for; null: one thread.
};

/// Exit codes of the program, for the end of help texts.
extern const char* const kExitCodes;

/// Returns a command that prints a text and ends with 0.
Command printing(CLI::App* app, const std::function<std::string()>& text, bool computes = false);

/// Adds a command whose help text ends with an example and the exit codes.
/// @param example  arguments of the example
CLI::App* add_command(CLI::App& app, const std::string& name, const std::string& text,
                      const std::string& example);

/// Adds an argument, or an option with a value, which the help text calls `shown`.
CLI::Option* add_value(CLI::App& command, const std::string& names, std::string& value,
                       const std::string& shown, const std::string& text);
/// Adds an option whose value is a list of words with commas between them.
CLI::Option* add_list(CLI::App& command, const std::string& names, std::vector<std::string>& value,
                      const std::string& shown, const std::string& text);
/// Adds an option that may be given several times.
CLI::Option* add_repeated(CLI::App& command, const std::string& names,
                          std::vector<std::string>& values, const std::string& shown,
                          const std::string& text);
/// Adds an option with a number from `low` to `high`; the help text ends with this range and,
/// except for 0, with the default, which is the current value.
CLI::Option* add_number(CLI::App& command, const std::string& names, int& value, int low, int high,
                        const std::string& text);
/// Adds an option with a number from `low` to `high`; the help text ends with this range and,
/// except for 0, with the default, which is the current value.
void add_number(CLI::App& command, const std::string& names, double& value, double low, double high,
                const std::string& text);

/// Adds the option --set KEY=VALUE.
void add_overrides(CLI::App& command, std::vector<std::string>& overrides);
/// Adds the option --threads.
void add_threads(CLI::App& command, int& threads);
/// Adds the argument for a case, and the option --set.
void add_case(CLI::App& command, std::string& name, std::vector<std::string>& overrides);

/// Returns the commands that compute one case: run, check, modes, certify, verify.
std::vector<Command> commands_of_runs(CLI::App& app);
/// Returns the commands that compute many cases: compare, sweep, accuracy, stability.
std::vector<Command> commands_of_studies(CLI::App& app);
/// Returns the commands for the files of a user: new, clean.
std::vector<Command> commands_of_folders(CLI::App& app);
/// Returns the command that prints manual pages.
Command manual_command(CLI::App& app);
/// Returns the commands that print texts: cases, keys, completion, manual.
std::vector<Command> commands_of_texts(CLI::App& app);

}  // namespace flexmorph::cases
