#pragma once

#include <string>
#include <vector>

/// Completion of the command line in shells.
namespace flexmorph::cases {

/// One command of the program with its options, as far as completion needs them.
struct CommandWords {
  std::string name;  ///< Name of the command.

  /// Kind of the positional argument: "case", "run", "run_or_case", "table" or "shell"; empty if
  /// the command has none.
  std::string positional;
  std::vector<std::string> options;  ///< Options, such as "--set" and "-o".
  std::vector<std::string> valued;   ///< Options that are followed by a value.
};

/// Returns a completion script that a shell can source. The script runs the program to get the
/// names of cases when they are needed.
/// @param shell  "bash" or "zsh"
std::string completion_script(const std::string& shell, const std::vector<CommandWords>& commands);

}  // namespace flexmorph::cases
