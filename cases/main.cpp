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
#include "cases/process/blas_room.h"
#include "cases/process/processor.h"
#include "cases/results/schema.h"
#include "cases/run/corrections.h"
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

void add_case(CLI::App& command, std::string& name, std::vector<std::string>& overrides) {
  command.add_option("case", name, "case file, or name of a shipped case")->required();
  command.add_option("--set", overrides, "KEY=VALUE, changes the case")
      ->take_all()
      ->allow_extra_args(false);
}

void add_study(CLI::App& command, StudyOptions& study) {
  add_case(command, study.case_name, study.overrides);
  command.add_option("-o,--output", study.directory, "folder of the study");
  command.add_option("--jobs", study.jobs, "processes at a time")->check(CLI::Range(1, 1024));
  command.add_option("--threads", study.threads, "threads of each")->check(CLI::Range(1, 256));
  command.add_flag("--quiet", study.quiet, "no progress");
}

CLI::App* add_compare(CLI::App& app, CompareOptions& options, std::vector<std::string>& cycles) {
  CLI::App* command = app.add_subcommand(
      "compare", "runs a case with several optimizers from the same starts and compares them");
  add_study(*command, options.study);
  command->add_option("--optimizers", options.optimizers, "names, with commas (default: all)")
      ->delimiter(',');
  command
      ->add_option("--cycles", cycles,
                   "instead of optimizers: esl, corrected, direct (which see the motion itself)")
      ->delimiter(',');
  command->add_option("--starts", options.starts, "the case's own start and jittered ones")
      ->check(CLI::Range(1, 10000));
  command->add_option("--jitter", options.jitter, "of the starts, in parts of components' sizes")
      ->check(CLI::Range(0.0, 1.0));
  command->add_option("--budget", options.budget, "state solves of each run")
      ->check(CLI::Range(1, 100'000'000));
  return command;
}

CLI::App* add_sweep(CLI::App& app, SweepOptions& options) {
  CLI::App* command =
      app.add_subcommand("sweep", "runs a case with every combination of values and collects");
  add_study(*command, options.study);
  command
      ->add_option("--vary", options.vary,
                   "KEY=V1,V2,... (case=A,B: whole cases); several make combinations")
      ->take_all()
      ->allow_extra_args(false);
  command->add_option("--index", options.index, "only this variant, from 1 (job arrays)")
      ->check(CLI::Range(1, 1'000'000));
  command->add_flag("--list", options.list, "prints the variants");
  command->add_option("--reference", options.reference,
                      "CSV with columns of motion.csv, drawn as points (scenes without a design)");
  return command;
}

CLI::App* add_accuracy(CLI::App& app, AccuracyOptions& options) {
  CLI::App* command = app.add_subcommand(
      "accuracy", "error against run time of a case, and its cheapest settings for 1 % and less");
  add_case(*command, options.study.case_name, options.study.overrides);
  command->add_option("-o,--output", options.study.directory, "folder of the study");
  command->add_option("--budget", options.budget, "CPU time for all runs: 120s, 2min, 1h");
  command
      ->add_option("--ladders", options.ladders, "names, with commas (default: as the case says)")
      ->delimiter(',');
  command->add_flag("--verify,!--no-verify", options.verify, "runs what is recommended (default)");
  command->add_option("--threads", options.study.threads, "threads of each run")
      ->check(CLI::Range(1, 256));
  command->add_flag("--quiet", options.study.quiet, "no progress");
  return command;
}

CLI::App* add_stability(CLI::App& app, StabilityOptions& options) {
  CLI::App* command = app.add_subcommand(
      "stability", "makes cases stiff and extreme, runs them, and gives every run a verdict");
  command->add_option("case", options.cases, "case files or names (default: all shipped cases)");
  command->add_option("--suites", options.suites, "names, with commas (default: all but long)")
      ->delimiter(',')
      ->allow_extra_args(false);
  command->add_option("--set", options.overrides, "KEY=VALUE, changes every case")
      ->take_all()
      ->allow_extra_args(false);
  command->add_option("--jobs", options.jobs, "processes at a time")->check(CLI::Range(1, 1024));
  command->add_option("--timeout", options.timeout, "CPU time of each row [s]")
      ->check(CLI::Range(0.1, 1e6));
  command->add_option("-o,--output", options.directory, "folder (default runs/stability)");
  command->add_flag("--quiet", options.quiet, "only the summary, and what is wrong");
  return command;
}

/// Options of the command `keys`.
struct KeysOptions {
  std::string table;
  bool schema = false, markdown = false;
  std::string renewed;  ///< File whose reference is replaced; empty: the reference is printed.
};

CLI::App* add_keys(CLI::App& app, KeysOptions& options) {
  CLI::App* command = app.add_subcommand("keys", "the keys of case files");
  command->add_option("table", options.table, "only this one: time, body.flow, top");
  command->add_flag("--schema", options.schema, "as a JSON schema, for editors");
  command->add_flag("--markdown", options.markdown, "as the reference of cases/README.md");
  command->add_option("--renew", options.renewed, "writes the reference anew in this file");
  return command;
}

/// Returns the number of columns of the terminal; 100 if the output is not a terminal.
size_t screen_width() {
  winsize size{};
  const bool known = isatty(STDOUT_FILENO) && ioctl(STDOUT_FILENO, TIOCGWINSZ, &size) == 0;
  return known && size.ws_col > 0 ? size.ws_col : 100;
}

void print_keys(const KeysOptions& options) {
  if (!options.renewed.empty())
    return flexmorph::io::write_file(options.renewed,
                                     with_references(flexmorph::io::read_text(options.renewed)));
  const std::string text = options.schema     ? keys_as_schema()
                           : options.markdown ? keys_as_markdown()
                                              : keys_for_terminal(options.table, screen_width());
  std::fputs(text.c_str(), stdout);
}

/// Returns the names and options of all commands, for the completion script of a shell.
std::vector<CommandWords> command_words(const CLI::App& app) {
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
    throw Error::input("'" + word + "' is a case: flexmorph run " + word);
  const std::string close = flexmorph::io::nearest(word, names);
  throw Error::input("'" + word + "' is no command" +
                     (close.empty() ? "; there are " + flexmorph::joined(names)
                                    : ", did you mean '" + close + "'?"));
}

/// Flushes the standard output.
/// @throws Error (input) if it cannot be written, for example on a full disk or a closed pipe.
void finish_output() {
  if (std::fflush(stdout) != 0 || std::ferror(stdout) != 0)
    throw Error::input("the output cannot be written: " + std::generic_category().message(errno));
}

/// A command of the program: its options, and the function that executes it.
struct Command {
  CLI::App* app;
  std::function<int()> run;
  bool computes = true;  ///< True if the command needs the buffers of OpenBLAS.
};

Command run_command(CLI::App& app, RunOptions& options) {
  CLI::App* run = app.add_subcommand("run", "runs a case and writes its run folder");
  add_case(*run, options.case_name, options.overrides);
  run->add_option("-o,--output", options.directory, "run folder (default runs/<name>)");
  run->add_option("--threads", options.threads,
                  "threads for loads, cells, and motions side by side")
      ->check(CLI::Range(1, 256));
  run->add_flag("--condition", options.condition,
                "estimates the condition of the last matrices, for run.json");
  run->add_flag("--explain", options.explain, "keeps the case with all its defaults");
  run->add_flag("--quiet", options.quiet, "no progress");
  run->add_flag("--resume", options.resume,
                "goes on with a run of this case that did not come to its end");
  return {run, [&] { return run_case(options); }};
}

Command check_command(CLI::App& app, RunOptions& options) {
  CLI::App* check =
      app.add_subcommand("check", "validates a case; says what it contains and costs");
  add_case(*check, options.case_name, options.overrides);
  check->add_flag("--explain", options.explain, "prints the case with all its defaults instead");
  return {check, [&] {
            std::fputs(check_case(options.case_name, options.overrides, options.explain).c_str(),
                       stdout);
            return 0;
          }};
}

Command certify_command(CLI::App& app, CertifyOptions& options) {
  CLI::App* certify =
      app.add_subcommand("certify", "what the motion itself says of the designs of a finished run");
  certify->add_option("run", options.directory, "folder of the run")->required();
  certify->add_option("--set", options.overrides, "KEY=VALUE, changes the case")
      ->take_all()
      ->allow_extra_args(false);
  certify->add_flag("--quiet", options.quiet, "only the certificate");
  return {certify, [&] { return certify_run(options); }};
}

Command verify_command(CLI::App& app, VerifyOptions& options) {
  CLI::App* verify = app.add_subcommand(
      "verify", "puts redrawn parts in place of designs: their numbers beside the design's");
  verify
      ->add_option("run_or_case", options.case_name,
                   "folder of a finished run, whose design is beside the part; or a case")
      ->required();
  verify
      ->add_option("--part", options.parts,
                   "BODY=FILE (.dxf, .step): outline in the coordinates of the exported design")
      ->required()
      ->take_all()
      ->allow_extra_args(false);
  verify->add_option("--set", options.overrides, "KEY=VALUE, changes the case")
      ->take_all()
      ->allow_extra_args(false);
  verify->add_option("-o,--output", options.directory,
                     "run folder (default: that of the run, or runs/<name>, with _verify)");
  verify
      ->add_option("--threads", options.threads,
                   "threads for loads, cells, and motions side by side")
      ->check(CLI::Range(1, 256));
  verify->add_flag("--quiet", options.quiet, "no progress");
  return {verify, [&] { return verify_parts(options); }};
}

Command cases_command(CLI::App& app) {
  return {app.add_subcommand("cases", "lists the shipped cases"),
          [] {
            for (const std::string& name : shipped_cases()) std::printf("%s\n", name.c_str());
            return 0;
          },
          false};
}

Command completion_command(CLI::App& app, std::string& shell) {
  CLI::App* completion = app.add_subcommand("completion", "a script that completes commands");
  completion->add_option("shell", shell, "bash or zsh")
      ->required()
      ->check(CLI::IsMember({"bash", "zsh"}));
  return {completion,
          [&] {
            std::fputs(completion_script(shell, command_words(app)).c_str(), stdout);
            return 0;
          },
          false};
}

/// The options of all commands.
struct AllOptions {
  RunOptions run;
  CompareOptions compare;
  std::vector<std::string> compared_cycles;
  SweepOptions sweep;
  AccuracyOptions accuracy;
  StabilityOptions stability;
  CertifyOptions certify;
  VerifyOptions verify;
  KeysOptions keys;
  std::string shell;
};

/// Returns the commands in the order of the help text.
std::vector<Command> commands_of(CLI::App& app, AllOptions& all) {
  std::vector<Command> out = {run_command(app, all.run), check_command(app, all.run)};
  out.push_back({add_compare(app, all.compare, all.compared_cycles), [&] {
                   if (all.compared_cycles.empty()) return compare_case(all.compare);
                   return compare_cycles({all.compare.study, all.compared_cycles});
                 }});
  out.push_back({add_sweep(app, all.sweep), [&] { return sweep_case(all.sweep); }});
  out.push_back({add_accuracy(app, all.accuracy), [&] { return accuracy_case(all.accuracy); }});
  out.push_back(
      {add_stability(app, all.stability), [&] { return check_stability(all.stability); }});
  out.push_back(certify_command(app, all.certify));
  out.push_back(verify_command(app, all.verify));
  out.push_back(cases_command(app));
  out.push_back({add_keys(app, all.keys),
                 [&] {
                   print_keys(all.keys);
                   return 0;
                 },
                 false});
  out.push_back(completion_command(app, all.shell));
  return out;
}

int parse_and_run(int argc, char** argv) {
  CLI::App app("Topology optimization of flexible mechanisms", "flexmorph");
  app.set_version_flag("--version", std::string("flexmorph ") + kVersion);
  app.require_subcommand(1);
  AllOptions options;
  std::vector<Command> commands = commands_of(app, options);
  CLI::App* help = app.add_subcommand("help", "this list");
  const std::string all_help = app.help();  // after parsing it would be the help of one command
  commands.push_back({help,
                      [&] {
                        std::fputs(all_help.c_str(), stdout);
                        return 0;
                      },
                      false});
  if (argc > 1)
    refuse_unknown_command(app, argv[1]);
  else
    std::fputs(all_help.c_str(), stdout);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : 2;
  }
  const int threads = std::max(options.run.threads, options.verify.threads);
  flexmorph::settle_processor(threads, argv);
  for (const Command& command : commands) {
    if (!*command.app) continue;
    if (command.computes) flexmorph::reserve_blas(threads);
    return command.run();
  }
  return 0;
}

}  // namespace

/// Runs the program. Exit codes: 0 done, 1 defect of the program, 2 invalid input, 3 numerical
/// failure, 4 interrupted, 5 done, but an expectation of the case is violated or the result is not
/// usable.
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
    std::fputs("flexmorph: memory ran out\n", stderr);
    return 3;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "flexmorph: unexpected: %s\n", error.what());
    return 1;
  }
}
