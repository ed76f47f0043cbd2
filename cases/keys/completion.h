#pragma once

#include <string>
#include <vector>

/// Completion of the command line in shells.
namespace flexmorph::cases {

/// What the program says of one of its commands.
struct CommandWords {
  std::string name;
  /// What follows: "case", "run", "run_or_case", "table", "shell"; empty: nothing.
  std::string positional;
  std::vector<std::string> options;  ///< "--set", "-o"
  std::vector<std::string> valued;   ///< those of them that a value follows
};

/// A script to be sourced. Names of cases are asked of the program when they are needed.
/// @param shell  "bash" or "zsh"
std::string completion_script(const std::string& shell, const std::vector<CommandWords>& commands);

}  // namespace flexmorph::cases
