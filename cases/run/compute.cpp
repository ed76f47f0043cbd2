#include "cases/run/compute.h"

#include "cases/check/ready.h"
#include "cases/results/failure.h"
#include "cases/run/run.h"

namespace flexmorph::cases {
namespace {

/// Completes the result of a run that failed or was interrupted.
void complete_early(const Scene& scene, const Progress& progress, EndedRun& ended) {
  try {
    std::rethrow_exception(ended.error);
  } catch (const Interrupted&) {
    complete_result(scene, "interrupted", "", ended.result);
  } catch (const std::exception& error) {
    ended.result.failure = failure_of(error, progress.where());
    complete_result(scene, "failed", error.what(), ended.result);
  }
}

}  // namespace

PreparedCase load_case(const std::string& name, std::span<const std::string> changes) {
  return ready_case(name, changes).prepared;
}

EndedRun compute_as_far_as_possible(const PreparedCase& prepared, const ComputeSettings& settings) {
  const RunClock clock;
  Progress progress(settings.say);
  const RunContext run{
      .prepared = prepared,
      .folder = nullptr,
      .progress = progress,
      .keep_running = settings.keep_running ? settings.keep_running : [] { return true; },
      .threads = settings.threads,
      .iteration = settings.iteration};
  EndedRun out = run_prepared(run);
  if (out.error)
    complete_early(prepared.scene(), progress, out);
  else
    complete_result(prepared.scene(), "done", "", out.result);
  out.result.info.threads = settings.threads;
  clock.read(out.result.info);
  return out;
}

RunResult compute(const PreparedCase& prepared, const ComputeSettings& settings) {
  EndedRun ended = compute_as_far_as_possible(prepared, settings);
  if (ended.error) std::rethrow_exception(ended.error);
  return std::move(ended.result);
}

}  // namespace flexmorph::cases
