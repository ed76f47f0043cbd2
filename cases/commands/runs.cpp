#include <CLI/CLI.hpp>
#include <memory>

#include "cases/check/check.h"
#include "cases/check/plausibility.h"
#include "cases/commands/command.h"
#include "cases/run/corrections.h"
#include "cases/run/modes.h"
#include "cases/run/run.h"
#include "cases/run/verify_part.h"
#include "io/screen.h"

namespace flexmorph::cases {

namespace {

Command run_command(CLI::App& app) {
  const auto options = std::make_shared<RunOptions>();
  CLI::App* run = add_command(app, "run", "runs a case and writes its run folder",
                              "short_beam --set design.max_volume=0.4 -o runs/light");
  add_case(*run, options->case_name, options->overrides);
  add_value(*run, "-o,--output", options->directory, "FOLDER", "run folder (default runs/NAME)");
  add_threads(*run, options->threads);
  run->add_flag("--condition", options->condition, "estimates condition numbers for run.json");
  run->add_flag("--explain", options->explain, "writes the case with all default values");
  run->add_flag("--open", options->open,
                "opens the page of the run, which is renewed, in a browser");
  run->add_flag("--quiet", options->quiet, "prints no progress");
  add_number(*run, "--seconds", options->seconds, 0.0, 1e9,
             "CPU time after which the run ends as failed [s]");
  run->add_flag("--resume", options->resume, "continues a run of this case that is not finished");
  return {run, [options] { return run_case(*options); }, true, &options->threads};
}

Command check_command(CLI::App& app) {
  const auto options = std::make_shared<RunOptions>();
  CLI::App* check = add_command(app, "check", "validates a case; prints its content and cost",
                                "four_bar --set time.step=1e-3");
  add_case(*check, options->case_name, options->overrides);
  check->add_flag("--explain", options->explain, "prints only the case with all default values");
  return printing(
      check,
      [options] {
        const std::string text =
            check_case(options->case_name, options->overrides, options->explain);
        return options->explain ? text : io::fitted_text(text, io::screen_width(), kSummaryIndent);
      },
      true);
}

Command modes_command(CLI::App& app) {
  const auto options = std::make_shared<ModesOptions>();
  CLI::App* modes = add_command(app, "modes", "computes natural frequencies of the mechanism",
                                "plate_pendulum --time 0.5 --count 6");
  add_case(*modes, options->case_name, options->overrides);
  modes
      ->add_option("--time", options->time,
                   "time of the arrangement [s]; load factor of a static analysis (default 0)")
      ->type_name("NUMBER");
  add_number(*modes, "--count", options->count, 1, 1000,
             "largest number of modes, rigid modes included");
  modes->add_flag("--stopped", options->stopped,
                  "drives and material flow stand still at their positions of this time");
  add_value(*modes, "-o,--output", options->directory, "FOLDER",
            "folder of the results (default runs/NAME_modes)");
  return printing(
      modes, [options] { return io::fitted_text(modes_of_case(*options), io::screen_width()); },
      true);
}

Command certify_command(CLI::App& app) {
  const auto options = std::make_shared<CertifyOptions>();
  CLI::App* certify = add_command(app, "certify", "computes how far designs are from an optimum",
                                  "runs/slider_crank_designed");
  add_value(*certify, "run", options->directory, "FOLDER", "folder of the run")->required();
  add_overrides(*certify, options->overrides);
  certify->add_flag("--quiet", options->quiet, "prints only the certificate");
  return {certify, [options] { return certify_run(*options); }};
}

Command verify_command(CLI::App& app) {
  const auto options = std::make_shared<VerifyOptions>();
  CLI::App* verify = add_command(app, "verify", "compares redrawn parts with the designs",
                                 "runs/rotating_plate_v01 --part plate=part.dxf");
  add_value(*verify, "run_or_case", options->case_name, "FOLDER|CASE",
            "folder of a finished run, or a case")
      ->required();
  add_repeated(*verify, "--part", options->parts, "BODY=FILE",
               "outline (.dxf, .step) in the coordinates of the exported design")
      ->required();
  add_overrides(*verify, options->overrides);
  add_value(*verify, "-o,--output", options->directory, "FOLDER",
            "run folder (default: folder of the run, or runs/NAME, with the ending _verify)");
  add_threads(*verify, options->threads);
  verify->add_flag("--quiet", options->quiet, "prints no progress");
  return {verify, [options] { return verify_parts(*options); }, true, &options->threads};
}

}  // namespace

std::vector<Command> commands_of_runs(CLI::App& app) {
  return {run_command(app), check_command(app), modes_command(app), certify_command(app),
          verify_command(app)};
}

}  // namespace flexmorph::cases
