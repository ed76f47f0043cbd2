#include <unistd.h>

#include <CLI/CLI.hpp>
#include <cstdio>
#include <cstdlib>

#include "cases/run.h"
#include "cases/version.h"

namespace {

using flexmorph::Error;
using namespace flexmorph::cases;

/// OpenMP and OpenBLAS read their number of threads when they are loaded, and CHOLMOD ignores any
/// later wish: the process starts itself once more with the wish in its environment.
void restart_with_threads(int threads, char** argv) {
  const char* mark = "FLEXMORPH_THREADS";
  const std::string n = std::to_string(threads);
  const char* seen = std::getenv(mark);
  if (seen && n == seen) return;
  setenv(mark, n.c_str(), 1);
  setenv("OMP_THREAD_LIMIT", n.c_str(), 1);
  setenv("OMP_NUM_THREADS", n.c_str(), 1);
  setenv("OPENBLAS_NUM_THREADS", n.c_str(), 1);
  // OpenBLAS 0.3.21 does not know newer processors and falls back to kernels for older ones.
  if (__builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512vl") &&
      __builtin_cpu_supports("avx512dq") && __builtin_cpu_supports("avx512bw"))
    setenv("OPENBLAS_CORETYPE", "SkylakeX", 0);
  execv("/proc/self/exe", argv);  // returns only on failure: then the library defaults stand
}

int parse_and_run(int argc, char** argv) {
  CLI::App app("Topology optimization of flexible mechanisms", "flexmorph");
  app.set_version_flag("--version", std::string("flexmorph ") + kVersion);
  app.require_subcommand(1);
  RunOptions options;
  const auto common = [&](CLI::App* command) {
    command->add_option("case", options.case_name, "case file, or name of a shipped case")
        ->required();
    command->add_option("--set", options.overrides, "KEY=VALUE, changes the case")
        ->take_all()
        ->allow_extra_args(false);
  };
  CLI::App* run = app.add_subcommand("run", "runs a case and writes its run folder");
  common(run);
  run->add_option("-o,--output", options.directory, "run folder (default runs/<name>)");
  run->add_option("--threads", options.threads, "threads of the linear algebra")
      ->check(CLI::Range(1, 256));
  run->add_flag("--quiet", options.quiet, "no progress");
  CLI::App* check =
      app.add_subcommand("check", "validates a case; says what it contains and costs");
  common(check);
  CLI::App* cases = app.add_subcommand("cases", "lists the shipped cases");
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : 2;
  }
  if (*run) {
    restart_with_threads(options.threads, argv);
    return run_case(options);
  }
  if (*check) std::fputs(check_case(options).c_str(), stdout);
  if (*cases)
    for (const std::string& name : shipped_cases()) std::printf("%s\n", name.c_str());
  return 0;
}

}  // namespace

/// Exit codes: 0 done, 1 a defect of the program, 2 bad input, 3 numerical failure, 4 interrupted.
int main(int argc, char** argv) {
  try {
    return parse_and_run(argc, argv);
  } catch (const Error& error) {
    std::fprintf(stderr, "flexmorph: %s\n", error.what());
    return error.kind() == Error::Kind::input ? 2 : 3;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "flexmorph: unexpected: %s\n", error.what());
    return 1;
  }
}
