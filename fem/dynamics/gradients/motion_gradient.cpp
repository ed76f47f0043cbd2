#include "fem/dynamics/gradients/motion_gradient.h"

#include <algorithm>

#include "fem/dynamics/gradients/motion_sweep.h"
#include "fem/dynamics/gradients/watched_measures.h"
#include "fem/dynamics/starts/start_gradient.h"
#include "geometry/cpu_time.h"

namespace flexmorph::fem {
namespace {

/// One motion with the data of its gradient.
class Gradient {
 public:
  Gradient(const Model& model, std::span<const MovingRoot> moving_roots,
           const MotionSettings& settings, std::span<const MotionObjective> objectives,
           const GradientSettings& gradient)
      : model_(model),
        moving_roots_(moving_roots),
        settings_(settings),
        objectives_(objectives),
        gradient_(gradient),
        watched_(objectives) {
    settings_.balance = false;
    settings_.energy_round_off.reset();
    settings_.condition = false;
    settings_.memory.clear();
    settings_.between_steps = nullptr;
    check();
  }

  std::vector<double> values() {
    Workspace model(model_);
    settings_.keep = Keep::nothing;
    integrate(model, moving_roots_, settings_, [&](const MotionStep& step) { see(step); });
    std::vector<double> out;
    for (size_t k = 0; k < objectives_.size(); ++k)
      out.push_back(watched_.mean(k, settings_.stops).value);
    return out;
  }

  MotionGradients go() {
    MotionGradients out;
    const double begin = cpu_seconds();
    auto model = std::make_unique<Workspace>(model_);
    move(*model, out.motion);
    const double moved = cpu_seconds();
    AdjointSweep sweep(objectives_, gradient_, settings_);
    begin_at_end(*model, sweep);
    if (memories_.empty()) {
      sweep.back(*model, out.motion.trajectory, watched_.times().size() - 1, true);
      start_ = out.motion.trajectory.points.front().x;
      back_through_start(*model, sweep);
    } else {
      model.reset();  // every part has its own work space
      back_by_parts(sweep);
    }
    for (Swept& s : sweep.all()) out.of.push_back(std::move(s.out));
    out.motion.trajectory = {};
    out.seconds_motion = moved - begin;
    out.seconds_adjoint = cpu_seconds() - moved;
    out.factorizations = sweep.factorizations();
    out.iterations = sweep.iterations();
    return out;
  }

 private:
  void check() const {
    if (const std::string why = no_gradient_because(model_, settings_); !why.empty())
      throw Error::input("the gradient of a motion: " + why);
    if (objectives_.empty()) throw Error::input("the gradient of a motion: no objective is given");
    for (const MotionObjective& o : objectives_)
      if (!o.measure || !(o.exponent >= 1))
        throw Error::input(
            "the gradient of a motion: an objective must have a measure, and an exponent of 1 or "
            "more");
  }

  void see(const MotionStep& step) {
    watched_.see(step);
    if (gradient_.every_step) gradient_.every_step();
  }

  /// Start of a part of the motion, as an archive.
  struct SavedCheckpoint {
    std::string memory;
    double time = 0;
    size_t seen = 0;  // index of its first point among all observed times
  };

  /// Integrates the motion, and stores its trajectory or the archives of its parts.
  void move(Workspace& model, MotionResult& result) {
    MotionSettings settings = settings_;
    settings.keep = gradient_.checkpoints > 0 ? Keep::nothing : Keep::steps;
    const double apart = settings.end / std::max(1, gradient_.checkpoints);
    if (gradient_.checkpoints > 0)
      settings.between_steps = [&](const SaveCheckpoint& save_checkpoint) {
        const double t = watched_.times().back();
        const auto next = static_cast<double>(memories_.size() + 1) * apart;
        if (t < next - 1e-9 * settings.end || t > settings.end - 0.5 * settings.step) return;
        memories_.push_back({save_checkpoint(), t, watched_.times().size() - 1});
      };
    result = integrate(model, moving_roots_, settings, [&](const MotionStep& step) { see(step); });
  }

  /// Sets the data of the sweep at the end of the motion.
  void begin_at_end(const Workspace& model, AdjointSweep& sweep) const {
    for (size_t k = 0; k < objectives_.size(); ++k) {
      Swept& s = sweep.all().emplace_back();
      s.by.set_zero(model.n_dofs(), model.n_constraints());
      s.alpha.setZero(model.n_dofs());
      WatchedMeasures::Mean mean = watched_.mean(k, settings_.stops);
      s.out.value = mean.value;
      s.slopes = std::move(mean.slopes);
      s.out.d_factors = model.zero_scale_factor_gradients();
      s.out.by_parameters.setZero(static_cast<Eigen::Index>(gradient_.parameters.size()));
    }
  }

  /// Integrates the parts a second time, from the last to the first, and sweeps back through each.
  void back_by_parts(AdjointSweep& sweep) {
    size_t last = watched_.times().size() - 1;
    for (size_t k = memories_.size() + 1; k-- > 0;) {
      MotionSettings settings = settings_;
      settings.keep = Keep::steps;
      if (k > 0) settings.memory = memories_[k - 1].memory;
      if (k < memories_.size()) settings.until = memories_[k].time;
      Workspace model(model_);
      const MotionResult part = integrate(model, moving_roots_, settings, [&](const MotionStep&) {
        if (gradient_.every_step) gradient_.every_step();
      });
      sweep.back(model, part.trajectory, last, k == 0);
      if (k > 0) {
        last = memories_[k - 1].seen;
        memories_.resize(k);  // later archives are no longer needed
        continue;
      }
      start_ = part.trajectory.points.front().x;
      back_through_start(model, sweep);
    }
  }

  void back_through_start(Workspace& model, AdjointSweep& sweep) {
    // Same value as in Run::begin() of motion.cpp.
    const double delta = std::min(1e-4, 0.5 * settings_.end);
    const VectorXd given =
        start_state(model, moving_roots_, 0, settings_.start, settings_.body_poses, delta).v;
    sweep.back_through_start(model, start_, given);
    for (Swept& s : sweep.all())
      derive_start(model, moving_roots_, 0, settings_.start, settings_.body_poses, delta, s.by.q,
                   s.by.v,
                   [&](const State& x, const VectorXd& psi) { sweep.add_work(x, psi, s.out); });
  }

  const Model& model_;
  std::span<const MovingRoot> moving_roots_;
  MotionSettings settings_;
  std::span<const MotionObjective> objectives_;
  const GradientSettings& gradient_;
  WatchedMeasures watched_;
  std::vector<SavedCheckpoint> memories_;
  State start_;
};

}  // namespace

std::string no_gradient_because(const Model& model, const MotionSettings& settings) {
  if (settings.adaptive) return "adaptive time steps (time.tolerance) depend on the design";
  if (settings.integrator != "generalized_alpha")
    return "integrator \"" + settings.integrator +
           "\" does not support it; use \"generalized_alpha\"";
  if (!settings.discontinuities.empty())
    return "a drive has discontinuities, where accelerations may jump";
  for (const Body& body : model.bodies()) {
    if (body.element->n_scalars() > 0)
      return "the material lines of body '" + body.name +
             "' are free, and the times at which its mesh changes depend on the design";
    if (body.heat) return "body '" + body.name + "' is heated";
    if (body.element->dim() == 3) return "body '" + body.name + "' is three-dimensional";
  }
  return {};
}

MotionGradients motion_gradients(const Model& model, std::span<const MovingRoot> moving_roots,
                                 const MotionSettings& settings,
                                 std::span<const MotionObjective> objectives,
                                 const GradientSettings& gradient) {
  return Gradient(model, moving_roots, settings, objectives, gradient).go();
}

std::vector<double> motion_values(const Model& model, std::span<const MovingRoot> moving_roots,
                                  const MotionSettings& settings,
                                  std::span<const MotionObjective> objectives,
                                  const std::function<void()>& every_step) {
  GradientSettings gradient;
  gradient.every_step = every_step;
  return Gradient(model, moving_roots, settings, objectives, gradient).values();
}

}  // namespace flexmorph::fem
