#include "fem/dynamics/motion.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <optional>

#include "fem/dynamics/force_balance.h"
#include "fem/dynamics/integrators/dense_output.h"
#include "fem/dynamics/mesh_changes/event_times.h"
#include "fem/dynamics/motion_archive.h"
#include "fem/dynamics/motion_watch.h"
#include "fem/solve/redundancy.h"

namespace flexmorph::fem {
namespace {

/// One call of integrate(), with all variables of the motion.
class Run {
 public:
  Run(Workspace& model, std::span<const MovingRoot> moving_roots, const MotionSettings& settings,
      const MotionObserver& observe)
      : model_(model),
        moving_roots_(moving_roots),
        settings_(settings),
        observe_(observe),
        integrator_(
            make_integrator(model, {settings.integrator, settings.alpha, settings.energy_momentum,
                                    settings.minimal_coordinates})),
        watch_(model, settings, result_) {}

  MotionResult go() {
    if (settings_.adaptive) prepare_to_adapt();
    if (settings_.memory.empty())
      begin();
    else
      keep_running();
    const double tiny = kTiny * settings_.step;
    const std::vector<EventTime> all = event_times(settings_, kTiny * settings_.step);
    for (; next_event_time_ < all.size() && !is_enough(); ++next_event_time_) {
      EventTime event_time = all[next_event_time_];
      if (!segment_.open && (event_time.t <= x_.t + tiny || event_time.t > settings_.end + tiny))
        continue;
      event_time.t = std::min(event_time.t, settings_.end);
      while (!is_enough() && (segment_.open || x_.t < event_time.t - tiny))
        to_next_event(event_time);
    }
    if (!is_enough()) between_steps();
    result_.final = x_;
    result_.counts = integrator_->counts();
    result_.energy_error = balance_.relative();
    result_.energy_gain = watch_.energy_gain();
    if (settings_.condition) result_.condition = integrator_->condition();
    return std::move(result_);
  }

 private:
  void begin() {
    leave_out_redundant(model_,
                        start_state(model_, moving_roots_, 0, Start::rigid, settings_.body_poses));
    result_.redundant_joints = redundant_joints(model_);
    // Drives need not be defined after the end of the motion.
    x_ = start_state(model_, moving_roots_, 0, settings_.start, settings_.body_poses,
                     std::min(1e-4, 0.5 * settings_.end));
    const VectorXd given = x_.v;
    integrator_->project_velocity(x_);
    result_.start_change = model_.scales().cwiseProduct(x_.v - given).lpNorm<Eigen::Infinity>();
    integrator_->make_consistent(x_);
    const Energies e = model_.energies(x_);
    powers_ = measure(x_);
    balance_.begin(0, e, powers_);
    watch_.begin(e);
    see(x_, e, false);
    if (!control_) {
      integrator_->begin_motion(x_, settings_.step);
      return;
    }
    const double first = first_step();
    control_->begin(settings_.adaptive->first > 0 ? settings_.adaptive->first : first);
  }

  void keep_running() {
    Archive memory(settings_.memory);
    archive(memory);
    if (settings_.keep == Keep::steps) keep(x_, false);
  }

  bool is_enough() const { return x_.t >= settings_.until - kTiny * settings_.step; }

  /// Saves or restores all variables on which the next steps or the result of the motion depend.
  void archive(Archive& memory) {
    memory(x_, result_);
    if (!memory.is_restoring()) model_.prepare(x_);
    archive_meshes(memory, model_, moving_roots_);
    model_.prepare(x_);
    integrator_->archive(memory);
    watch_.archive(memory);
    if (control_) memory(*control_);
    memory(powers_, balance_, segment_, next_event_time_, next_between_);
    if (dense_) dense_->archive(memory);
  }

  void between_steps() {
    if (settings_.between_steps && settings_.keep == Keep::nothing)
      settings_.between_steps([this] {
        Archive memory;
        archive(memory);
        return memory.bytes();
      });
  }

  Powers measure(const State& x) { return settings_.balance ? powers(model_, x) : Powers{}; }

  /// Adds the work of a step to x to the balance, with the powers at the time of its multipliers.
  void balance(const State& x, const Energies& e) {
    const State* mean = integrator_->step_mean();
    if (!settings_.balance || !mean) {
      powers_ = measure(x);
      balance_.add(x.t, e, powers_);
      return;
    }
    powers_ = measure(*mean);
    balance_.add_mean(x_.t, e, powers_);
  }

  void see(const State& x, const Energies& e, bool stop) {
    keep(x, stop);
    model_.prepare(x);
    const bool unique = model_.redundant_rows().empty();
    if (!unique) (shown_ = x).lambda = least_multipliers(model_, x);
    observe_({model_, unique ? x : shown_, e, powers_, balance_.work(), balance_.dissipated(),
              balance_.energy_error(), stop, result_});
  }

  void keep(const State& x, bool stop) {
    const bool start = result_.trajectory.points.empty();
    if (settings_.keep == Keep::steps || (settings_.keep == Keep::stops && (stop || start)))
      result_.trajectory.points.push_back({x, stop});
  }

  /// Prepares adaptive steps.
  void prepare_to_adapt() {
    if (integrator_->step_mean())
      throw Error::input("adaptive steps need integrator \"generalized_alpha\": \"" +
                         settings_.integrator + "\" does not estimate its local error");
    control_.emplace(*settings_.adaptive, settings_.end);
    dense_.emplace(model_);
    between_ = settings_.stops;
    std::sort(between_.begin(), between_.end());
  }

  /// Integration segment up to an event time, or up to the first change of a mesh before it.
  struct IntegrationSegment {
    bool open = false;
    double begin = 0, end = 0;
    int steps = 0, done = 0;  // numbers of all equal steps and of those done
    bool is_stop = false, is_discontinuity = false;
    int changing = -1;  // index of the growth that changes its mesh at the end; -1: none
    MeshChange change = MeshChange::insertion;
  };

  void plan(const EventTime& event_time) {
    const double stop = event_time.t;
    NextChange next{stop, MeshChange::insertion};
    int changing = -1;
    for (size_t i = 0; i < moving_roots_.size(); ++i) {
      const MovingRoot& g = moving_roots_[i];
      const NextChange n = next_change(model_.body(g.body), g, x_.t, stop, settings_.step);
      if (n.t < next.t || (n.t == next.t && changing < 0)) {
        next = n;
        changing = static_cast<int>(i);
      }
    }
    // A change this close to a stop is moved onto it: so short a step would give only round-off.
    if (std::abs(next.t - stop) < kTiny * settings_.step) next.t = stop;
    const bool there = next.t == stop;
    segment_ = {true,
                x_.t,
                next.t,
                0,
                0,
                event_time.stop && there,
                event_time.discontinuity && there,
                changing,
                next.change};
    // No step is made if a limit is exceeded already (a boundary element too long at the start).
    if (const double way = next.t - x_.t; way > kTiny * settings_.step)
      segment_.steps = std::max(1, static_cast<int>(std::ceil(way / settings_.step - 1e-6)));
  }

  /// Returns the time at which the steps of the segment end.
  double end_of_steps() const {
    return segment_.is_discontinuity ? just_before(segment_.end) : segment_.end;
  }

  void to_next_event(const EventTime& event_time) {
    if (!segment_.open) plan(event_time);
    if (segment_.steps > 0 && control_)
      adaptive_steps();
    else
      equal_steps();
    if (is_enough()) return;
    segment_.open = false;
    const bool at_end = segment_.end >= settings_.end - kTiny * settings_.step;
    if (segment_.changing >= 0 && !at_end)
      execute(moving_roots_[static_cast<size_t>(segment_.changing)], segment_.change);
  }

  /// Makes the remaining equal steps of the segment, none longer than the step of the settings.
  void equal_steps() {
    const double begin = segment_.begin, end = end_of_steps();
    const int n = segment_.steps;
    while (segment_.done < n && !is_enough()) {
      const int k = ++segment_.done;
      const double t = k == n ? end : begin + (end - begin) * k / n;
      double last = x_.t;
      watching_joints([&] {
        integrator_->advance(x_, t, [&](const State& x) {
          const double h = x.t - last;
          watch_.see_equal(x_, h, (end - begin) / n);
          const bool there = x.t >= end;
          last = x.t;
          accepted(h, segment_.is_stop && there, segment_.is_discontinuity && there);
        });
      });
      if (is_enough()) return;
      if (t < settings_.end - kTiny * settings_.step) changes_due();
      between_steps();
    }
  }

  /// Makes the steps of the segment with sizes that adapt to the local error.
  void adaptive_steps() {
    const double tiny = kTiny * settings_.step, end = end_of_steps();
    while (x_.t < end - tiny) {
      const double left = end - x_.t, h = control_->next(left);
      before_ = x_;
      TriedStep tried;
      watching_joints([&] { tried = integrator_->try_step(x_, h, control_->allowed()); });
      if (!tried.converged) {
        control_->failed(h, before_.t);
        continue;
      }
      if (!(tried.error <= control_->allowed())) {
        control_->rejected(h, tried.error, before_.t);
        continue;
      }
      control_->accepted(h, tried.error, tried.iterations);
      if (h == left) x_.t = end;
      const bool there = x_.t == end;
      const bool at_stop = see_between(tiny) || (segment_.is_stop && there);
      accepted(h, at_stop, segment_.is_discontinuity && there);
      if (x_.t < settings_.end - tiny) changes_due();
      between_steps();
    }
  }

  /// Interpolates the stops within the step from before_ to x_ for the observer. @returns true if
  /// the end of the step is a stop.
  bool see_between(double tiny) {
    while (next_between_ < between_.size() && between_[next_between_] < x_.t - tiny) {
      const double t = between_[next_between_++];
      if (t <= before_.t + tiny) continue;
      dense_->set_step(before_, x_);
      dense_->at(t, within_);
      const Energies e = model_.energies(within_);
      balance(within_, e);
      see(within_, e, true);
      watch_.see_material(within_, steps());
    }
    return next_between_ < between_.size() && std::abs(between_[next_between_] - x_.t) <= tiny;
  }

  /// Returns the end of the step with multipliers computed from the position, as for stops within a
  /// step. The multipliers of adaptive steps contain errors from changes of the step size, which
  /// can be as large as the force itself if the tolerance is loose.
  const State& settled() {
    dense_->set_step(before_, x_);
    dense_->at(x_.t, within_);
    return within_;
  }

  /// Records an accepted step of length h and calls the observer.
  void accepted(double h, bool at_stop, bool at_discontinuity) {
    const State& x = at_stop && control_ && !at_discontinuity ? settled() : x_;
    Energies e = model_.energies(x);
    balance(x, e);
    watch_.see_drift(x_);
    if (at_discontinuity)
      e = cross_discontinuity();
    else if (at_stop && integrator_->step_mean())
      integrator_->make_consistent(x_);
    see(x, e, at_stop);
    watch_.see(x_, e, powers_, balance_.energy_error(), h, at_stop, steps());
    renew_left_out(model_, x_);
  }

  /// Continues from just before a discontinuity to the values after it. @returns the energies
  /// there.
  Energies cross_discontinuity() {
    x_.t = segment_.end;
    integrator_->cross_discontinuity(x_);
    const Energies e = model_.energies(x_);
    powers_ = measure(x_);
    balance_.add(x_.t, e, powers_);
    if (control_) control_->begin(first_step());
    return e;
  }

  /// Returns the estimated first step. It is also called if the first step is given, because the
  /// integrator then prepares the algorithmic acceleration.
  double first_step() {
    return integrator_->first_step(x_, control_->allowed(), control_->largest());
  }

  /// Executes the changes of meshes that are due at free root lines.
  void changes_due() {
    model_.prepare(x_);
    for (const MovingRoot& g : moving_roots_)
      if (const auto change = change_due(model_.body(g.body), g)) execute(g, *change);
  }

  /// Makes a step. If it fails near a singular position of rigid bodies, the error names the
  /// joints, because this position is the cause.
  template <class Step>
  void watching_joints(const Step& step) {
    try {
      step();
    } catch (const Error& error) {
      if (const auto named = watch_.with_joints(error, x_)) throw *named;
      throw;
    }
  }

  int steps() const { return integrator_->counts().steps; }

  void execute(const MovingRoot& growth, MeshChange change) {
    Body* body = nullptr;
    for (Body& b : model_.bodies())
      if (b.name == growth.body) body = &b;
    assert(body != nullptr);
    MeshEvent event;
    event.time = x_.t;
    event.body = growth.body;
    event.change = change;
    const Vec2 tip(grid_of(*body).line_m(grid_of(*body).n_m()).value, 0);
    event.before = model_.energies(x_);
    event.momentum_before = model_.momentum(x_);
    const Vec3 tip_before = point_position(*body, x_, tip);
    const State before = x_;
    const LineGrid& lines = grid_of(*body);
    const double line =
        change == MeshChange::insertion ? inserted_line(lines, growth.cell) : lines.line_m(1).value;
    MeshMap map = change_mesh(model_, *body, change, x_, growth.cell);
    integrator_->change_mesh(map, before, integrator_->balance(x_, separating_frequency(*body)));
    event.after = model_.energies(x_);
    event.momentum_after = model_.momentum(x_);
    event.tip_jump = (point_position(*body, x_, tip) - tip_before).norm();
    result_.events.push_back(event);
    integrator_->project_velocity(x_);
    powers_ = measure(x_);
    balance_.keep_running(powers_);
    if (settings_.keep == Keep::nothing) return;
    Trajectory& kept = result_.trajectory;
    kept.changes.push_back(
        {event.time, event.body, change, kept.points.size() - 1, line, std::move(map)});
    if (settings_.keep == Keep::steps) kept.points.push_back({x_, false});
  }

  static constexpr double kTiny = 1e-6;  // tolerance of times, as a fraction of a step

  Workspace& model_;
  std::span<const MovingRoot> moving_roots_;
  const MotionSettings& settings_;
  const MotionObserver& observe_;
  std::unique_ptr<Integrator> integrator_;
  State x_;
  Powers powers_;
  EnergyBalance balance_;
  // Only for adaptive steps.
  std::optional<StepControl> control_;
  std::optional<DenseOutput> dense_;
  State shown_;            // state for the observer
  State before_, within_;  // start of the step, and a state within it
  std::vector<double> between_;
  size_t next_between_ = 0;
  IntegrationSegment segment_;
  size_t next_event_time_ = 0;
  MotionResult result_;
  MotionWatch watch_;
};

}  // namespace

MotionResult integrate(Workspace& model, std::span<const MovingRoot> moving_roots,
                       const MotionSettings& settings, const MotionObserver& observe) {
  return Run(model, moving_roots, settings, observe).go();
}

}  // namespace flexmorph::fem
