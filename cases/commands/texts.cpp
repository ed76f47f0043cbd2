#include <CLI/CLI.hpp>
#include <memory>

#include "cases/check/ready.h"
#include "cases/commands/command.h"
#include "cases/keys/book.h"
#include "cases/keys/completion.h"
#include "cases/results/schema.h"
#include "io/case_files/case_parser.h"
#include "io/files.h"
#include "io/screen.h"

namespace flexmorph::cases {

namespace {

/// Options of the command `keys`.
struct KeysOptions {
  std::string table, renewed;  ///< Table or word, and updated file; empty: all tables, no file.
  bool schema = false, markdown = false;
};

/// Returns the text that the command `keys` prints; empty if it updates a file.
std::string keys_text(const KeysOptions& options) {
  if (options.renewed.empty())
    return options.schema     ? keys_as_schema()
           : options.markdown ? keys_as_markdown()
                              : keys_for_terminal(options.table, io::screen_width());
  io::write_file(options.renewed, with_references(io::read_text(options.renewed)));
  return "";
}

Command keys_command(CLI::App& app) {
  const auto options = std::make_shared<KeysOptions>();
  CLI::App* command = add_command(app, "keys", "prints the keys of case files", "body.flow");
  add_value(
      *command, "word", options->table, "WORD",
      "prints only this table, such as time, body.flow or top, or else the keys with this word "
      "in their names and descriptions");
  command->add_flag("--schema", options->schema, "prints a JSON schema for editors");
  command->add_flag("--markdown", options->markdown, "prints the reference in cases/docs/keys.md");
  add_value(*command, "--renew", options->renewed, "FILE", "updates the reference in this file");
  return printing(command, [options] { return keys_text(*options); });
}

/// Returns the names and options of all commands, for the completion script of a shell.
std::vector<CommandWords> command_texts(const CLI::App& app) {
  std::vector<CommandWords> out;
  for (const CLI::App* command : app.get_subcommands([](const CLI::App*) { return true; })) {
    CommandWords& words = out.emplace_back();
    words.name = command->get_name();
    for (const CLI::Option* option : command->get_options()) {
      if (option->get_positional()) words.positional = option->get_name(true);
      std::vector<std::string> names;
      for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
      for (const std::string& name : option->get_snames()) names.push_back("-" + name);
      words.options.insert(words.options.end(), names.begin(), names.end());
      if (option->get_expected_max() > 0)
        words.valued.insert(words.valued.end(), names.begin(), names.end());
    }
  }
  return out;
}

Command cases_command(CLI::App& app) {
  return printing(add_command(app, "cases", "lists the shipped cases", ""), list_of_cases);
}

Command completion_command(CLI::App& app) {
  const auto shell = std::make_shared<std::string>();
  CLI::App* completion = add_command(app, "completion", "prints a script for a shell", "bash");
  add_value(*completion, "shell", *shell, "SHELL", "bash or zsh")
      ->required()
      ->check(CLI::IsMember({"bash", "zsh"}).description(""));
  return printing(completion,
                  [shell, &app] { return completion_script(*shell, command_texts(app)); });
}

}  // namespace

std::vector<Command> commands_of_texts(CLI::App& app) {
  return {cases_command(app), keys_command(app), completion_command(app), manual_command(app)};
}

}  // namespace flexmorph::cases
