#include "cases/commands/command.h"

#include <CLI/CLI.hpp>
#include <cstdio>

#include "geometry/text.h"
#include "io/files.h"

namespace flexmorph::cases {

namespace {

/// Adds an option with a number from `low` to `high`.
template <class T>
CLI::Option* add_range(CLI::App& command, const std::string& names, T& value, T low, T high,
                       const std::string& text) {
  using io::to_text;
  const std::string range = text + ", " + to_text(low) + " to " + to_text(high);
  return command
      .add_option(names, value, value == T() ? range : range + " (default " + to_text(value) + ")")
      ->type_name("NUMBER")
      ->check(CLI::Range(low, high).description(""));
}

}  // namespace

const char* const kExitCodes =
    "Exit codes:\n"
    "  0  done    1  internal error    2  invalid input    4  interrupted\n"
    "  3  numerical failure, a failed run of a study, or a WRONG run of `stability`\n"
    "  5  done, but an expectation is violated, or the result is not usable";

Command printing(CLI::App* app, const std::function<std::string()>& text, bool computes) {
  return {app,
          [text] {
            std::fputs(text().c_str(), stdout);
            return 0;
          },
          computes};
}

CLI::App* add_command(CLI::App& app, const std::string& name, const std::string& text,
                      const std::string& example) {
  CLI::App* command = app.add_subcommand(name, text);
  const std::string shown = example.empty() ? name : name + " " + example;
  command->footer("Example:\n  flexmorph " + shown + "\n\n" + kExitCodes);
  return command;
}

CLI::Option* add_value(CLI::App& command, const std::string& names, std::string& value,
                       const std::string& shown, const std::string& text) {
  return command.add_option(names, value, text)->type_name(shown);
}

CLI::Option* add_list(CLI::App& command, const std::string& names, std::vector<std::string>& value,
                      const std::string& shown, const std::string& text) {
  return command.add_option(names, value, text)->type_name(shown)->delimiter(',');
}

CLI::Option* add_repeated(CLI::App& command, const std::string& names,
                          std::vector<std::string>& values, const std::string& shown,
                          const std::string& text) {
  return command.add_option(names, values, text)
      ->type_name(shown)
      ->option_text(shown)
      ->take_all()
      ->allow_extra_args(false);
}

CLI::Option* add_number(CLI::App& command, const std::string& names, int& value, int low, int high,
                        const std::string& text) {
  return add_range(command, names, value, low, high, text);
}

void add_number(CLI::App& command, const std::string& names, double& value, double low, double high,
                const std::string& text) {
  add_range(command, names, value, low, high, text);
}

void add_overrides(CLI::App& command, std::vector<std::string>& overrides) {
  add_repeated(command, "--set", overrides, "KEY=VALUE",
               "changes a key of the case, may be repeated; KEY= without a value removes the key "
               "or the entry of a list");
}

void add_threads(CLI::App& command, int& threads) {
  add_number(command, "--threads", threads, 1, 256,
             "number of threads of a run for loads, cells and independent motions");
}

void add_case(CLI::App& command, std::string& name, std::vector<std::string>& overrides) {
  add_value(command, "case", name, "CASE", "case file, or name of a shipped case")->required();
  add_overrides(command, overrides);
}

}  // namespace flexmorph::cases
