#include "fem/dynamics/motion.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <optional>

namespace flexmorph::fem {

Vec3 momentum_in_space(const Model& model, const State& x) { return model.momentum(x); }

Vec2 momentum(const Model& model, const State& x) { return momentum_in_space(model, x).head<2>(); }

namespace {

/// The run of one motion: what integrate() carries along.
class Run {
 public:
  Run(Model& model, std::span<const Growth> growths, const MotionSettings& settings,
      const MotionObserver& observe)
      : model_(model),
        growths_(growths),
        settings_(settings),
        observe_(observe),
        integrator_(make_integrator(
            model, {settings.integrator, settings.alpha, settings.energy_momentum})) {
    const auto is_rigid = [](const Body& b) {
      return !dynamic_cast<const LineGrid*>(b.element.get());
    };
    if (std::any_of(model.bodies().begin(), model.bodies().end(), is_rigid))
      joint_watch_.emplace(model);
  }

  MotionResult go() {
    std::vector<double> stops = settings_.stops;
    stops.push_back(settings_.end);
    std::sort(stops.begin(), stops.end());
    x_ = start_state(model_, growths_, 0, settings_.start, settings_.placement);
    integrator_->project_velocity(x_);
    integrator_->make_consistent(x_);
    const Energies e = model_.energies(x_);
    powers_ = measure(x_);
    balance_.begin(0, e, powers_);
    see(e, false);
    const double tiny = kTiny * settings_.step;
    for (const double stop : stops) {
      if (stop <= x_.t + tiny || stop > settings_.end + tiny) continue;
      while (x_.t < stop - tiny) to_next_event(std::min(stop, settings_.end));
    }
    result_.final = x_;
    result_.counts = integrator_->counts();
    result_.energy_defect = balance_.relative();
    return std::move(result_);
  }

 private:
  Powers measure(const State& x) const { return settings_.balance ? powers(model_, x) : Powers{}; }

  /// Work of a step, at the time its multipliers belong to.
  void balance(const Energies& e) {
    const State* mean = integrator_->step_mean();
    if (!settings_.balance || !mean) {
      powers_ = measure(x_);
      balance_.add(x_.t, e, powers_);
      return;
    }
    model_.prepare(*mean);
    powers_ = measure(*mean);
    model_.prepare(x_);
    balance_.add_mean(x_.t, e, powers_);
  }

  void see(const Energies& e, bool stop) {
    observe_({model_, x_, e, powers_, balance_.work(), balance_.defect(), stop});
  }

  /// To the stop, or to the first change of a mesh before it.
  void to_next_event(double stop) {
    NextChange next{stop, MeshChange::insertion};
    const Growth* changing = nullptr;
    for (const Growth& g : growths_) {
      const NextChange n = next_change(model_.body(g.body), g, x_.t, stop, settings_.step);
      if (n.t < next.t || (n.t == next.t && !changing)) {
        next = n;
        changing = &g;
      }
    }
    // A change this near to a stop is meant to fall on it; a step this short would be noise.
    if (std::abs(next.t - stop) < kTiny * settings_.step) next.t = stop;
    // A limit that is passed already (a boundary element too long from the start) takes no step.
    if (next.t - x_.t > kTiny * settings_.step) steps_to(next.t, next.t == stop);
    const bool at_end = next.t >= settings_.end - kTiny * settings_.step;
    if (changing && !at_end) execute(*changing, next.change);
  }

  /// Equal steps, none longer than the settings' step.
  void steps_to(double end, bool stop) {
    const double begin = x_.t;
    const int n = std::max(1, static_cast<int>(std::ceil((end - begin) / settings_.step - 1e-6)));
    for (int k = 1; k <= n; ++k) {
      const double t = k == n ? end : begin + (end - begin) * k / n;
      advance(t, [&](const State& x) {
        const Energies e = model_.energies(x);
        balance(e);
        drift();
        const bool at_stop = stop && x.t >= end;
        if (at_stop && integrator_->step_mean()) integrator_->make_consistent(x_);
        see(e, at_stop);
        if (at_stop || ++since_watched_ == kWatchEvery) watch(x);
        if (joint_watch_ && ++since_joints_ == kJointsEvery) watch_joints(x);
      });
      if (t < settings_.end - kTiny * settings_.step) changes_due();
    }
  }

  /// Changes at free root lines.
  void changes_due() {
    for (const Growth& g : growths_)
      if (const auto change = change_due(model_.body(g.body), g)) execute(g, *change);
  }

  /// A step that fails near a singular position of rigid bodies fails because of it.
  void advance(double t, const std::function<void(const State&)>& accepted) {
    try {
      integrator_->advance(x_, t, accepted);
    } catch (const Error& error) {
      if (!joint_watch_ || error.kind() != Error::Kind::numerical) throw;
      const Conditioning now = joint_watch_->look(x_);
      if (now.condition < kSingular) throw;
      throw Error::numerical(std::string(error.what()) + " Dead centre? " + describe(now));
    }
  }

  void watch_joints(const State& x) {
    since_joints_ = 0;
    const Conditioning now = joint_watch_->look(x);
    std::vector<Conditioning>& all = result_.near_singular;
    const bool near = now.condition > kNearlyDependent;
    if (near && !was_near_)
      all.push_back(now);
    else if (near && now.condition > all.back().condition)
      all.back() = now;
    was_near_ = near;
  }

  /// A St. Venant-Kirchhoff material that has collapsed or turned inside out has equilibria, but
  /// no meaning: better stop than go on with them.
  void watch(const State& x) {
    since_watched_ = 0;
    const double ratio = model_.smallest_area_ratio(x);
    result_.smallest_area_ratio = std::min(result_.smallest_area_ratio, ratio);
    if (ratio > 0) return;
    char text[200];
    std::snprintf(text, sizeof text,
                  "motion: the material has collapsed at t = %.6g s, step %d: smallest area ratio "
                  "|r_m x r_n| = %.2e. It is too soft for its loads.",
                  x.t, integrator_->counts().steps, ratio);
    throw Error::numerical(text);
  }

  void drift() {
    Constraints c;
    model_.constraints(x_, c);
    if (c.value.size() == 0) return;
    result_.constraint_drift =
        std::max(result_.constraint_drift, c.value.lpNorm<Eigen::Infinity>());
    VectorXd rate = c.rate;
    for (const auto& entry : c.jacobian) rate[entry.row()] += entry.value() * x_.v[entry.col()];
    result_.velocity_drift = std::max(result_.velocity_drift, rate.lpNorm<Eigen::Infinity>());
  }

  void execute(const Growth& growth, MeshChange change) {
    Body* body = nullptr;
    for (Body& b : model_.bodies())
      if (b.name == growth.body) body = &b;
    MeshEvent event;
    event.time = x_.t;
    event.body = growth.body;
    event.change = change;
    const Vec2 tip(grid_of(*body).line_m(grid_of(*body).n_m()).value, 0);
    event.before = model_.energies(x_);
    event.momentum_before = momentum_in_space(model_, x_);
    const Vec3 tip_before = point_position(*body, x_, tip);
    change_mesh(model_, *body, change, x_);
    event.after = model_.energies(x_);
    event.momentum_after = momentum_in_space(model_, x_);
    event.tip_jump = (point_position(*body, x_, tip) - tip_before).norm();
    result_.events.push_back(event);
    integrator_->project_velocity(x_);
    balance_.restart();
  }

  static constexpr double kTiny = 1e-6;    // of a step
  static constexpr int kWatchEvery = 10;   // steps between looks at the area ratio
  static constexpr int kJointsEvery = 25;  // steps between looks at the joints of rigid bodies
  static constexpr double kNearlyDependent = 1e6, kSingular = 1e3;  // conditions
  int since_watched_ = 0, since_joints_ = 0;
  bool was_near_ = false;

  Model& model_;
  std::span<const Growth> growths_;
  const MotionSettings& settings_;
  const MotionObserver& observe_;
  std::unique_ptr<Integrator> integrator_;
  State x_;
  Powers powers_;
  EnergyBalance balance_;
  std::optional<ConstraintWatch> joint_watch_;  // only with rigid bodies
  MotionResult result_;
};

}  // namespace

MotionResult integrate(Model& model, std::span<const Growth> growths,
                       const MotionSettings& settings, const MotionObserver& observe) {
  return Run(model, growths, settings, observe).go();
}

}  // namespace flexmorph::fem
