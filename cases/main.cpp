#include <sys/ioctl.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <filesystem>
#include <functional>
#include <new>
#include <system_error>

#include "cases/accuracy/accuracy.h"
#include "cases/check/check.h"
#include "cases/check/ready.h"
#include "cases/keys/book.h"
#include "cases/keys/completion.h"
#include "cases/process/blas_buffers.h"
#include "cases/process/processor.h"
#include "cases/results/schema.h"
#include "cases/run/corrections.h"
#include "cases/run/modes.h"
#include "cases/run/run.h"
#include "cases/run/verify_part.h"
#include "cases/scene/version.h"
#include "cases/stability/stability.h"
#include "cases/study/compare.h"
#include "cases/study/compare_cycles.h"
#include "cases/study/sweep.h"
#include "geometry/plain_numbers.h"
#include "geometry/text.h"
#include "io/case_files/case_document.h"
#include "io/case_files/case_parser.h"
#include "io/files.h"

namespace {

using flexmorph::Error;
using namespace flexmorph::cases;

/// A command of the program: its options, and the function that executes it.
struct Command {
  CLI::App* app;
  std::function<int()> run;
  bool computes = true;  ///< True if the command needs the buffers of OpenBLAS.
};

/// Returns a command that prints a text.
Command printing(CLI::App* app, const std::function<std::string()>& text, bool computes = false) {
  return {app,
          [text] {
            std::fputs(text().c_str(), stdout);
            return 0;
          },
          computes};
}

/// Exit codes, for the end of help texts.
constexpr const char* kExitCodes =
    "Exit codes:\n"
    "  0  done    1  internal error    2  invalid input    4  interrupted\n"
    "  3  numerical failure, a failed run of a study, or a WRONG run of `stability`\n"
    "  5  done, but an expectation of the case is violated, or the result is not usable";

/// Adds a command with an example of its use.
CLI::App* add_command(CLI::App& app, const std::string& name, const std::string& text,
                      const std::string& example) {
  CLI::App* command = app.add_subcommand(name, text);
  const std::string shown = example.empty() ? name : name + " " + example;
  command->footer("Example:\n  flexmorph " + shown + "\n\n" + kExitCodes);
  return command;
}

/// Adds an option with a value, which the help text calls `shown`.
template <class T>
CLI::Option* add_value(CLI::App& command, const std::string& names, T& value,
                       const std::string& shown, const std::string& text) {
  return command.add_option(names, value, text)->type_name(shown);
}

/// Adds an option with a number; the help text ends with its range and, except for 0, its default.
template <class T>
void add_number(CLI::App& command, const std::string& names, T& value, T low, T high,
                const std::string& text) {
  using flexmorph::io::to_text;
  const std::string range = text + ", " + to_text(low) + " to " + to_text(high);
  add_value(command, names, value, "NUMBER",
            value == T() ? range : range + " (default " + to_text(value) + ")")
      ->check(CLI::Range(low, high).description(""));
}

/// Adds an option that may be given several times.
CLI::Option* add_repeated(CLI::App& command, const std::string& name,
                          std::vector<std::string>& values, const std::string& shown,
                          const std::string& text) {
  return add_value(command, name, values, shown, text)->take_all()->allow_extra_args(false);
}

void add_overrides(CLI::App& command, std::vector<std::string>& overrides) {
  add_repeated(command, "--set", overrides, "KEY=VALUE",
               "changes a key of the case; KEY= without a value removes the key");
}

void add_threads(CLI::App& command, int& threads) {
  add_number(command, "--threads", threads, 1, 256,
             "number of threads of a run for loads, cells and independent motions");
}

void add_jobs(CLI::App& command, int& jobs) {
  add_number(command, "--jobs", jobs, 1, 1024, "number of processes at the same time");
}

void add_case(CLI::App& command, std::string& name, std::vector<std::string>& overrides) {
  add_value(command, "case", name, "CASE", "case file, or name of a shipped case")->required();
  add_overrides(command, overrides);
}

void add_study(CLI::App& command, StudyOptions& study, const std::string& folder) {
  add_case(command, study.case_name, study.overrides);
  add_value(command, "-o,--output", study.directory, "FOLDER",
            "folder of the study (default " + folder + ")");
  add_threads(command, study.threads);
  command.add_flag("--quiet", study.quiet, "prints no progress");
}

Command compare_command(CLI::App& app, CompareOptions& options, std::vector<std::string>& cycles) {
  CLI::App* command = add_command(app, "compare", "compares optimizers from common starts",
                                  "short_beam --optimizers mma,ipopt --starts 3 --jobs 2");
  add_study(*command, options.study, "runs/compare_NAME");
  add_jobs(*command, options.study.jobs);
  add_value(*command, "--optimizers", options.optimizers, "NAME,...", "names (default: all)")
      ->delimiter(',');
  add_value(*command, "--cycles", cycles, "NAME,...", "compares cycles: esl, corrected, direct")
      ->delimiter(',');
  add_number(*command, "--starts", options.starts, 1, 10000,
             "number of starts: the start of the case, and starts with jitter");
  add_number(*command, "--jitter", options.jitter, 0.0, 1.0,
             "jitter of the starts as a fraction of the sizes of the components");
  add_number(*command, "--budget", options.budget, 1, 100'000'000,
             "number of state solves of each run (default: iterations of the case + 1)");
  return {command, [&] {
            return cycles.empty() ? compare_case(options) : compare_cycles({options.study, cycles});
          }};
}

Command sweep_command(CLI::App& app, SweepOptions& options) {
  CLI::App* command = add_command(app, "sweep", "runs a case with all combinations of values",
                                  "short_beam --vary design.max_volume=0.3,0.4,0.5 --jobs 3");
  add_study(*command, options.study, "runs/sweep_NAME");
  add_jobs(*command, options.study.jobs);
  add_repeated(*command, "--vary", options.vary, "KEY=V1,V2,...",
               "values of a key, or cases with the key `case`; may be repeated");
  add_number(*command, "--index", options.index, 1, 1'000'000,
             "runs only the variant with this number, for job arrays");
  command->add_flag("--list", options.list, "prints the variants and runs none");
  add_value(*command, "--reference", options.reference, "FILE.csv",
            "columns of motion.csv that are plotted as points (for cases without a design)");
  return {command, [&] { return sweep_case(options); }};
}

Command accuracy_command(CLI::App& app, AccuracyOptions& options) {
  CLI::App* command = add_command(app, "accuracy", "finds the cheapest settings for an error",
                                  "plate_pendulum --budget 2min");
  add_study(*command, options.study, "runs/accuracy_NAME");
  add_value(*command, "--budget", options.budget, "TIME",
            "CPU time of all runs, such as 120s, 2min or 1h (default " + options.budget + ")");
  add_value(*command, "--refinements", options.refinements, "NAME,...",
            "names of refinement series (default: the series that the case names, or all)")
      ->delimiter(',');
  command->add_flag("--verify,!--no-verify", options.verify, "verifies the settings (default)");
  return {command, [&] { return accuracy_case(options); }};
}

Command stability_command(CLI::App& app, StabilityOptions& options) {
  CLI::App* command = add_command(app, "stability", "assesses runs with extreme parameters",
                                  "four_bar --suites stiffness,step --jobs 2");
  add_value(*command, "case", options.cases, "CASE",
            "case files, or names of shipped cases (default: all shipped cases)");
  add_value(*command, "--suites", options.suites, "NAME,...", "names (default: all except long)")
      ->delimiter(',')
      ->allow_extra_args(false);
  add_overrides(*command, options.overrides);
  add_jobs(*command, options.jobs);
  add_number(*command, "--timeout", options.timeout, 0.1, 1e6, "CPU time of each run [s]");
  add_value(*command, "-o,--output", options.directory, "FOLDER",
            "folder of the study (default " + options.directory + ")");
  command->add_flag("--quiet", options.quiet, "prints only the summary and WRONG runs");
  return {command, [&] { return check_stability(options); }};
}

/// Options of the command `keys`.
struct KeysOptions {
  std::string table, renewed;  ///< Table or word, and updated file; empty: all tables, no file.
  bool schema = false, markdown = false;
};

/// Returns the number of columns of the terminal; 100 if the output is not a terminal.
size_t screen_width() {
  winsize size{};
  const bool known = isatty(STDOUT_FILENO) && ioctl(STDOUT_FILENO, TIOCGWINSZ, &size) == 0;
  return known && size.ws_col > 0 ? size.ws_col : 100;
}

/// Returns the text that the command `keys` prints; empty if it updates a file.
std::string keys_text(const KeysOptions& options) {
  if (options.renewed.empty())
    return options.schema     ? keys_as_schema()
           : options.markdown ? keys_as_markdown()
                              : keys_for_terminal(options.table, screen_width());
  flexmorph::io::write_file(options.renewed,
                            with_references(flexmorph::io::read_text(options.renewed)));
  return "";
}

Command keys_command(CLI::App& app, KeysOptions& options) {
  CLI::App* command = add_command(app, "keys", "prints the keys of case files", "body.flow");
  add_value(
      *command, "word", options.table, "WORD",
      "prints only this table, such as time, body.flow or top, or else the keys with this word "
      "in their names and descriptions");
  command->add_flag("--schema", options.schema, "prints a JSON schema for editors");
  command->add_flag("--markdown", options.markdown, "prints the reference in cases/README.md");
  add_value(*command, "--renew", options.renewed, "FILE", "updates the reference in this file");
  return printing(command, [&] { return keys_text(options); });
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

Command run_command(CLI::App& app, RunOptions& options) {
  CLI::App* run = add_command(app, "run", "runs a case and writes its run folder",
                              "short_beam --set design.max_volume=0.4 -o runs/light");
  add_case(*run, options.case_name, options.overrides);
  add_value(*run, "-o,--output", options.directory, "FOLDER", "run folder (default runs/NAME)");
  add_threads(*run, options.threads);
  run->add_flag("--condition", options.condition, "estimates condition numbers for run.json");
  run->add_flag("--explain", options.explain, "writes the case with all default values");
  run->add_flag("--quiet", options.quiet, "prints no progress");
  run->add_flag("--resume", options.resume, "continues a run of this case that is not finished");
  return {run, [&] { return run_case(options); }};
}

Command check_command(CLI::App& app, RunOptions& options) {
  CLI::App* check = add_command(app, "check", "validates a case; prints its content and cost",
                                "four_bar --set time.step=1e-3");
  add_case(*check, options.case_name, options.overrides);
  check->add_flag("--explain", options.explain, "prints only the case with all default values");
  return printing(
      check, [&] { return check_case(options.case_name, options.overrides, options.explain); },
      true);
}

Command modes_command(CLI::App& app, ModesOptions& options) {
  CLI::App* modes = add_command(app, "modes", "computes natural frequencies of the mechanism",
                                "plate_pendulum --time 0.5 --count 6");
  add_case(*modes, options.case_name, options.overrides);
  add_value(*modes, "--time", options.time, "NUMBER",
            "time of the arrangement [s]; load factor of a static analysis (default 0)");
  add_number(*modes, "--count", options.count, 1, 1000,
             "largest number of modes, rigid modes included");
  modes->add_flag("--stopped", options.stopped,
                  "drives and material flow stand still at their positions of this time");
  add_value(*modes, "-o,--output", options.directory, "FOLDER",
            "folder of the results (default runs/NAME_modes)");
  return printing(
      modes, [&] { return modes_of_case(options); }, true);
}

Command certify_command(CLI::App& app, CertifyOptions& options) {
  CLI::App* certify = add_command(app, "certify", "computes how far designs are from an optimum",
                                  "runs/slider_crank_designed");
  add_value(*certify, "run", options.directory, "FOLDER", "folder of the run")->required();
  add_overrides(*certify, options.overrides);
  certify->add_flag("--quiet", options.quiet, "prints only the certificate");
  return {certify, [&] { return certify_run(options); }};
}

Command verify_command(CLI::App& app, VerifyOptions& options) {
  CLI::App* verify = add_command(app, "verify", "compares redrawn parts with the designs",
                                 "runs/rotating_plate_v01 --part plate=part.dxf");
  add_value(*verify, "run_or_case", options.case_name, "FOLDER|CASE",
            "folder of a finished run, or a case")
      ->required();
  add_repeated(*verify, "--part", options.parts, "BODY=FILE",
               "outline (.dxf, .step) in the coordinates of the exported design")
      ->required();
  add_overrides(*verify, options.overrides);
  add_value(*verify, "-o,--output", options.directory, "FOLDER",
            "run folder (default: folder of the run, or runs/NAME, with the ending _verify)");
  add_threads(*verify, options.threads);
  verify->add_flag("--quiet", options.quiet, "prints no progress");
  return {verify, [&] { return verify_parts(options); }};
}

Command cases_command(CLI::App& app) {
  return printing(add_command(app, "cases", "lists the shipped cases", ""), list_of_cases);
}

Command completion_command(CLI::App& app, std::string& shell) {
  CLI::App* completion = add_command(app, "completion", "prints a script for a shell", "bash");
  add_value(*completion, "shell", shell, "SHELL", "bash or zsh")
      ->required()
      ->check(CLI::IsMember({"bash", "zsh"}).description(""));
  return printing(completion, [&] { return completion_script(shell, command_texts(app)); });
}

int parse_and_run(int argc, char** argv) {
  CLI::App app("Topology optimization of flexible mechanisms", "flexmorph");
  app.set_version_flag("--version", std::string("flexmorph ") + kVersion);
  app.footer(std::string("Options of a command: flexmorph COMMAND --help\n\n") + kExitCodes);
  app.require_subcommand(1);
  RunOptions run;
  VerifyOptions verify;
  ModesOptions modes;
  CompareOptions compare;
  SweepOptions sweep;
  AccuracyOptions accuracy;
  StabilityOptions stability;
  CertifyOptions certify;
  KeysOptions keys;
  std::vector<std::string> cycles;
  std::string shell;
  std::vector<Command> commands = {run_command(app, run),
                                   check_command(app, run),
                                   modes_command(app, modes),
                                   compare_command(app, compare, cycles),
                                   sweep_command(app, sweep),
                                   accuracy_command(app, accuracy),
                                   stability_command(app, stability),
                                   certify_command(app, certify),
                                   verify_command(app, verify),
                                   cases_command(app),
                                   keys_command(app, keys),
                                   completion_command(app, shell)};
  CLI::App* help = app.add_subcommand("help", "prints this list");
  const std::string all_help = app.help();  // after parsing it would be the help of one command
  commands.push_back(printing(help, [&] { return all_help; }));
  if (argc > 1)
    refuse_unknown_command(app, argv[1]);
  else
    std::fputs(all_help.c_str(), stdout);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : 2;
  }
  const int threads = std::max(run.threads, verify.threads);
  flexmorph::set_up_processor(threads, argv);
  for (const Command& command : commands) {
    if (!*command.app) continue;
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
