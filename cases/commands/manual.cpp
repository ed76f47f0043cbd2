#include "cases/keys/manual.h"

#include <CLI/CLI.hpp>
#include <memory>

#include "cases/commands/command.h"

namespace flexmorph::cases {

namespace {

/// Returns the options of a command for a manual page.
std::string options_of(const CLI::App& command) {
  std::string out;
  for (const CLI::Option* option : command.get_options()) {
    const std::string name = option->get_name(option->get_positional(), true);
    if (name == "-h,--help") continue;
    out += ".TP\n.BI \"" + manual_text(name) + "\" \" " +
           (option->get_positional() ? "" : manual_text(option->get_type_name())) + "\"\n" +
           manual_text(option->get_description()) + "\n";
  }
  return out;
}

/// Returns the example of a help text; the exit codes that follow it are equal for all commands.
std::string example_of(const CLI::App& command) {
  const std::string footer = command.get_footer();
  return ".P\n.nf\n" + manual_text(footer.substr(0, footer.find("\n\n"))) + "\n.fi\n";
}

/// Returns the manual page flexmorph(1): all commands with their options.
std::string commands_as_manual(const CLI::App& app) {
  std::string out = manual_head("1", app.get_description());
  out += ".SH SYNOPSIS\n.B flexmorph\n.I COMMAND\n[\\fIargument\\fR ...]\n.SH COMMANDS\n";
  for (const CLI::App* command : app.get_subcommands([](const CLI::App*) { return true; }))
    out += ".SS flexmorph " + manual_text(command->get_name()) + "\n" +
           manual_text(command->get_description()) + ".\n" + options_of(*command) +
           example_of(*command);
  out += ".SH OPTIONS\n" + options_of(app);
  out += ".SH EXIT STATUS\n.nf\n" + manual_text(kExitCodes) + "\n.fi\n";
  out +=
      ".SH ENVIRONMENT\n.TP\n.B NO_COLOR\nWarnings and errors have no colours.\n.TP\n.B "
      "FLEXMORPH_VECTORS\nWidest vectors of the processor that are used: baseline, v3 or v4 (the "
      "default).\n.TP\n.B OPENBLAS_CORETYPE\nKernels of OpenBLAS; by default those of the "
      "processor.\n";
  return out + ".SH SEE ALSO\n.BR flexmorph (5)\n";
}

}  // namespace

Command manual_command(CLI::App& app) {
  const auto section = std::make_shared<std::string>("1");
  CLI::App* manual = add_command(app, "manual", "prints a manual page for `man`", "1 | man -l -");
  add_value(*manual, "section", *section, "SECTION", "1: commands (default), 5: case files")
      ->check(CLI::IsMember({"1", "5"}).description(""));
  return printing(manual, [section, &app] {
    return *section == "5" ? keys_as_manual() : commands_as_manual(app);
  });
}

}  // namespace flexmorph::cases
