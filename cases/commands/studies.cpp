#include <CLI/CLI.hpp>
#include <memory>

#include "cases/accuracy/accuracy.h"
#include "cases/commands/command.h"
#include "cases/stability/stability.h"
#include "cases/study/compare.h"
#include "cases/study/compare_cycles.h"
#include "cases/study/run_comparison.h"
#include "cases/study/sweep.h"

namespace flexmorph::cases {

namespace {

void add_jobs(CLI::App& command, int& jobs) {
  add_number(command, "--jobs", jobs, 1, 1024, "number of processes at the same time");
}

/// Adds the options that say where the rows of a study are run.
void add_dispatch(CLI::App& command, Dispatch& dispatch) {
  CLI::Option* commands =
      command.add_flag("--commands", dispatch.commands,
                       "prints a command line per row, which may be repeated, and runs none");
  CLI::Option* collect = command.add_flag("--collect", dispatch.collect,
                                          "makes the tables of the rows that exist, runs none");
  CLI::Option* hosts = add_value(command, "--hosts", dispatch.hosts, "FILE",
                                 "runs the rows on machines by GNU parallel (its --sshloginfile)");
  CLI::Option* sbatch =
      command
          .add_option_function<std::string>(
              "--sbatch", [&dispatch](const std::string& text) { dispatch.sbatch = text; },
              "prints a script that runs the rows as a job array of Slurm")
          ->type_name("OPTIONS");
  CLI::Option* shared =
      command.add_flag("--shared-disk", dispatch.shared_disk,
                       "the machines of --hosts have this folder, so that no file is sent");
  shared->needs(hosts);
  add_value(command, "--program", dispatch.program, "COMMAND",
            "command that starts the program in the rows of --commands, --hosts and --sbatch "
            "(default flexmorph)");
  const std::vector<CLI::Option*> all = {commands, collect, hosts, sbatch};
  for (CLI::Option* each : all)
    for (CLI::Option* other : all)
      if (each != other) each->excludes(other);
}

void add_study(CLI::App& command, StudyOptions& study, const std::string& folder) {
  add_case(command, study.case_name, study.overrides);
  add_value(command, "-o,--output", study.directory, "FOLDER",
            "folder of the study (default " + folder + ")");
  add_threads(command, study.threads);
  command.add_flag("--quiet", study.quiet, "prints no progress");
  add_dispatch(command, study.dispatch);
}

/// Options of the command `compare`: optimizers are compared, or cycles if any is named.
struct Comparison {
  CompareOptions optimizers;
  std::vector<std::string> cycles;
};

Command compare_command(CLI::App& app) {
  const auto options = std::make_shared<Comparison>();
  CompareOptions& compare = options->optimizers;
  CLI::App* command = add_command(app, "compare", "compares optimizers from common starts",
                                  "short_beam --optimizers mma,ipopt --starts 3 --jobs 2");
  add_study(*command, compare.study, "runs/compare_NAME");
  add_jobs(*command, compare.study.jobs);
  add_list(*command, "--optimizers", compare.optimizers, "NAME,...", "names (default: all)");
  add_list(*command, "--cycles", options->cycles, "NAME,...",
           "compares cycles: esl, corrected, direct");
  add_number(*command, "--starts", compare.starts, 1, 10000,
             "number of starts: the start of the case, and starts with jitter");
  add_number(*command, "--jitter", compare.jitter, 0.0, 1.0,
             "jitter of the starts as a fraction of the sizes of the components");
  add_number(*command, "--budget", compare.budget, 1, 100'000'000,
             "number of state solves of each run (default: iterations of the case + 1)");
  return {command, [options] {
            return options->cycles.empty()
                       ? compare_case(options->optimizers)
                       : compare_cycles({options->optimizers.study, options->cycles});
          }};
}

Command sweep_command(CLI::App& app) {
  const auto options = std::make_shared<SweepOptions>();
  CLI::App* command = add_command(app, "sweep", "runs a case with all combinations of values",
                                  "short_beam --vary design.max_volume=0.3,0.4,0.5 --jobs 3");
  add_study(*command, options->study, "runs/sweep_NAME");
  add_jobs(*command, options->study.jobs);
  add_repeated(*command, "--vary", options->vary, "KEY=V1,V2,...",
               "values of a key, or cases with the key `case`; may be repeated");
  add_value(*command, "--reference", options->reference, "FILE.csv",
            "columns of motion.csv that are plotted as points (for cases without a design)");
  return {command, [options] { return sweep_case(*options); }};
}

Command report_command(CLI::App& app) {
  const auto options = std::make_shared<ReportOptions>();
  CLI::App* command = add_command(app, "report", "writes a page that compares runs",
                                  "runs/four_bar runs/four_bar_light -o comparison.html");
  command->add_option("runs", options->runs, "folders of runs")->type_name("FOLDER")->required();
  add_value(*command, "-o,--output", options->path, "FILE",
            "page that is written (default " + options->path + ")");
  return printing(command, [options] { return compare_runs(*options); });
}

Command accuracy_command(CLI::App& app) {
  const auto options = std::make_shared<AccuracyOptions>();
  CLI::App* command = add_command(app, "accuracy", "finds the cheapest settings for an error",
                                  "plate_pendulum --budget 2min");
  add_study(*command, options->study, "runs/accuracy_NAME");
  add_value(*command, "--budget", options->budget, "TIME",
            "CPU time of all runs, such as 120s, 2min or 1h (default " + options->budget + ")");
  add_list(*command, "--refinements", options->refinements, "NAME,...",
           "names of refinement series (default: the series that the case names, or all)");
  command->add_flag("--verify,!--no-verify", options->verify, "verifies the settings (default)");
  return {command, [options] { return accuracy_case(*options); }};
}

Command stability_command(CLI::App& app) {
  const auto options = std::make_shared<StabilityOptions>();
  CLI::App* command = add_command(app, "stability", "assesses runs with extreme parameters",
                                  "four_bar --suites stiffness,step --jobs 2");
  command
      ->add_option("case", options->cases,
                   "case files, or names of shipped cases (default: all shipped cases)")
      ->type_name("CASE");
  add_list(*command, "--suites", options->suites, "NAME,...", "names (default: all except long)")
      ->allow_extra_args(false);
  add_overrides(*command, options->overrides);
  add_jobs(*command, options->jobs);
  add_number(*command, "--timeout", options->timeout, 0.1, 1e6, "CPU time of each run [s]");
  add_value(*command, "-o,--output", options->directory, "FOLDER",
            "folder of the study (default " + options->directory + ")");
  command->add_flag("--quiet", options->quiet, "prints only the summary and WRONG runs");
  add_dispatch(*command, options->dispatch);
  return {command, [options] { return check_stability(*options); }};
}

}  // namespace

std::vector<Command> commands_of_studies(CLI::App& app) {
  return {compare_command(app), sweep_command(app), report_command(app), accuracy_command(app),
          stability_command(app)};
}

}  // namespace flexmorph::cases
