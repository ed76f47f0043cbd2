#include "cases/run/motion_run.h"

#include <cmath>

#include "cases/output/animation_writer.h"
#include "cases/output/motion_checkpoint.h"
#include "cases/output/motion_frames.h"
#include "cases/results/failure.h"
#include "cases/results/motion_columns.h"
#include "cases/results/warnings.h"
#include "cases/run/load_collector.h"
#include "cases/run/start_remarks.h"
#include "io/files.h"

namespace flexmorph::cases {
namespace {

/// Reports unusual events of a motion: remarks on its start, alternating multipliers, and time
/// steps that were shortened.
class MotionMessages {
 public:
  MotionMessages(const Scene& scene, const MotionRequest& request, const Mechanism& mechanism,
                 MotionRecord& record)
      : scene_(scene), request_(request), mechanism_(mechanism), record_(record) {}

  void add(const fem::MotionStep& step) {
    if (record_.table.n_rows() == 0) start(step);
    const fem::MotionResult& found = step.so_far;
    if (found.alternation && !said_alternation_) say(alternation_text(*found.alternation));
    said_alternation_ = found.alternation.has_value();
    if (found.cut.number > 0 && !said_cut_)
      say("t = " + io::to_text(step.x.t, 4) + " s: " + cut_text());
    said_cut_ = found.cut.number > 0;
  }
  void archive(Archive& memory) { memory(record_.remarks, said_alternation_, said_cut_); }

 private:
  /// Returns the reason for time steps that are shorter than the step of the case.
  std::string cut_text() const {
    const std::string length = io::to_text(scene_.time.step, 3) + " s";
    if (scene_.time.integrator == "minimal_coordinates")
      return "The error tolerance requires time steps shorter than " + length + ".";
    return "A time step of " + length +
           " was too long for Newton's method or for a closed loop of rigid bodies, which must "
           "stay "
           "on its branch. Shorter time steps are used.";
  }
  void say(const std::string& words) const {
    if (request_.say) request_.say(words);
  }
  void start(const fem::MotionStep& step) {
    record_.remarks = start_remarks(scene_, step.model, step.x, step.so_far.start_change);
    const std::string& start = mechanism_.start_text;
    if (!start.empty())
      record_.remarks.insert(record_.remarks.begin(),
                             "The start of the motion was chosen automatically: " + start);
    if (!mechanism_.assembly_text.empty())
      record_.remarks.insert(record_.remarks.begin(), mechanism_.assembly_text);
    for (const std::string& each : record_.remarks) say(each);
    if (damps_no_multipliers(scene_)) say(undamped_text(scene_));
  }

  const Scene& scene_;
  const MotionRequest& request_;
  const Mechanism& mechanism_;
  MotionRecord& record_;
  bool said_alternation_ = false, said_cut_ = false;
};

std::vector<VectorXd> densities_of(const MotionRequest& request) {
  std::vector<VectorXd> out;
  for (const fem::ScaleFactors& factors : request.factors) out.push_back(factors.mass);
  return out;
}

/// Passes the steps of a motion to the writers that the request requires.
class StepSequence {
 public:
  StepSequence(const Scene& scene, const MotionRequest& request, Mechanism& mechanism,
               RunFolder* folder, MotionOutcome& out)
      : request_(request),
        model_(mechanism.model),
        columns_(scene, mechanism.moving_roots, request.balance),
        messages_(scene, request, mechanism, out.record),
        shapes_(scene, densities_of(request)) {
    if (!scene.measures.empty())
      columns_.set_undeformed(fem::start_state(mechanism.model, mechanism.moving_roots, 0,
                                               fem::Start::rigid, mechanism.motion.body_poses));
    MotionRecord& record = out.record;
    record.table = Series(columns_.columns());
    write<SeriesWriter>(record.table);
    if (request.snapshots > 0) write<SnapshotWriter>(shapes_, request.snapshots, record.snapshots);
    if (request.animated > 0) write<AnimationWriter>(shapes_, request.animated, record.animation);
    if (folder) write<TableWriter>(folder->file(request.table), record.table);
    if (request.loads)
      write<LoadCollector>(scene, std::span<const fem::MovingRoot>(mechanism.moving_roots),
                           out.loads);
    if (folder && request.frames_every > 0)
      write<FrameWriter>(shapes_, request.frames_every, *folder);
  }

  void add(const fem::MotionStep& step) {
    messages_.add(step);
    StepRecord record{step.model, step.x, columns_.row(step), step.x.t};
    record.stop = step.stop || step.x.t == 0;
    for (const auto& writer : writers_) writer->add(record);
    if (request_.reached) request_.reached(step.x.t);
  }

  /// Saves or restores the state of the messages, columns and writers between two steps.
  void archive(Archive& memory) {
    messages_.archive(memory);
    columns_.archive(memory, model_);
    for (const auto& writer : writers_) writer->archive(memory);
  }

 private:
  template <class Writer, class... Arguments>
  void write(Arguments&&... arguments) {
    writers_.push_back(std::make_unique<Writer>(std::forward<Arguments>(arguments)...));
  }

  const MotionRequest& request_;
  fem::Workspace& model_;
  MotionColumns columns_;
  MotionMessages messages_;
  BodyShapes shapes_;
  std::vector<std::unique_ptr<StepWriter>> writers_;
};

/// Returns the state of a motion that failed after the steps of a record.
Failure failure_in(const MotionRequest& request, const MotionRecord& record) {
  Failure out;
  const auto n = static_cast<int>(record.table.n_rows());
  out.phase = request.phase;
  out.time = n == 0 ? 0 : record.time().back();
  out.step = std::max(0, n - 1);  // the first row is the start
  return out;
}

/// Returns the settings of a request on which the motion depends besides the case, as bytes.
std::string bytes_of(const MotionRequest& request) {
  Archive m;
  MeshChoice mesh = request.mesh;
  bool loads = request.loads, balance = request.balance, condition = request.condition;
  double every = request.frames_every;
  int snapshots = request.snapshots, animated = request.animated;
  std::optional<double> step = request.step;
  m(mesh.elements, mesh.refine, step, loads, balance, condition, every, snapshots, animated);
  for (fem::ScaleFactors factors : request.factors) m(factors.stiffness, factors.mass);
  return m.bytes();
}

/// Resumes a motion from its checkpoint, and writes the checkpoint between steps.
class Resuming {
 public:
  Resuming(const MotionRequest& request, MotionOutcome& out, StepSequence& steps, RunFolder* folder)
      : request_(request), out_(out), steps_(steps), folder_(folder) {
    if (folder && !request.checkpoint.empty())
      checkpoint_.emplace(*folder, request.checkpoint, bytes_of(request), request.checkpoint_every);
  }

  void connect(fem::MotionSettings& motion) {
    if (checkpoint_ && request_.resume) resume(motion);
    motion.between_steps = [this](const fem::SaveCheckpoint& save_checkpoint) {
      between_steps(save_checkpoint);
    };
  }

 private:
  void resume(fem::MotionSettings& motion) {
    std::string why;
    std::optional<std::string> kept = checkpoint_->read(why);
    const auto say = [&](const std::string& words) {
      if (request_.resumed) request_.resumed(request_.phase + words);
    };
    if (!kept) {
      say(": The computation starts from the beginning" +
          (why.empty() ? std::string(".")
                       : ", because " + request_.checkpoint + " cannot be used: " + why + "."));
      return;
    }
    Archive memory(std::move(*kept));
    steps_.archive(memory);
    memory(motion.memory);
    say(": The computation resumes at t = " + io::to_text(out_.record.time().back(), 6) + " s.");
  }

  void between_steps(const fem::SaveCheckpoint& save_checkpoint) {
    const bool ends = request_.keep_running && !request_.keep_running();
    if (checkpoint_ && (ends || checkpoint_->is_due())) {
      Archive memory;
      steps_.archive(memory);
      const std::string motion = save_checkpoint();
      std::uint64_t size = motion.size();  // the archive of a string: size and bytes
      memory(size);
      checkpoint_->write(
          memory.bytes(), motion,
          request_.frames_every > 0 ? folder_->frames() : std::vector<std::string>());
    }
    if (ends) throw Interrupted();
  }

  const MotionRequest& request_;
  MotionOutcome& out_;
  StepSequence& steps_;
  RunFolder* folder_;
  std::optional<MotionCheckpoint> checkpoint_;
};

/// Returns a copy of the mechanism of a case, with the designs and the settings of a request.
Mechanism mechanism_of(const PreparedCase& prepared, const MotionRequest& request) {
  const Scene& scene = prepared.scene();
  Mechanism out = prepared.mechanism(request.mesh);
  if (request.step) set_step(scene, *request.step, out.motion);
  for (size_t i = 0; i < request.factors.size(); ++i)
    for (fem::Body& body : out.model.bodies())
      if (body.name == scene.designs[i].body) out.model.set_factors(body, request.factors[i]);
  out.motion.balance = request.balance;
  out.motion.condition = request.condition;
  if (request.loads)
    for (const double t : load_times(scene)) out.motion.stops.push_back(t);
  if (request.frames_every > 0)
    for (int k = 1; k * request.frames_every < scene.time.end + 1e-9; ++k)
      out.motion.stops.push_back(k * request.frames_every);
  return out;
}

}  // namespace

MotionOutcome run_motion(const PreparedCase& prepared, const MotionRequest& request,
                         RunFolder* folder) {
  Mechanism mechanism = mechanism_of(prepared, request);
  MotionOutcome out;
  StepSequence steps(prepared.scene(), request, mechanism, folder, out);
  Resuming resuming(request, out, steps, folder);
  try {
    resuming.connect(mechanism.motion);
    out.record.result = fem::integrate(mechanism.model, mechanism.moving_roots, mechanism.motion,
                                       [&](const fem::MotionStep& step) { steps.add(step); });
  } catch (const Error& error) {
    const Failure failure = failure_in(request, out.record);
    if (request.unfinished) *request.unfinished = std::move(out.record);
    throw FailedRun(error, failure);
  } catch (...) {
    if (request.unfinished) *request.unfinished = std::move(out.record);
    throw;
  }
  return out;
}

}  // namespace flexmorph::cases
