#include "fem/dynamics/motion_gradient.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "fem/dynamics/generalized_alpha.h"
#include "fem/dynamics/start_gradient.h"
#include "fem/dynamics/transposed_system.h"
#include "fem/dynamics/watched_measures.h"
#include "geometry/cpu_time.h"

namespace flexmorph::fem {
namespace {

/// Derivatives of one objective by the state that the sweep has come to, and what it has gathered.
struct Swept {
  StateSlopes by;
  VectorXd alpha;
  MotionGradient out;
  std::vector<double> slopes;  // ∂J/∂m of every time
};

/// Goes back through a motion, a part of it at a time.
class Sweep {
 public:
  Sweep(std::span<const MotionObjective> objectives, const GradientSettings& settings,
        const AlphaScheme& scheme)
      : objectives_(objectives), settings_(settings), scheme_(scheme) {}

  std::vector<Swept>& all() { return all_; }
  int factorizations() const { return factorizations_; }
  int iterations() const { return iterations_; }

  /// @param model  with the mesh of the end of the part, which becomes that of its start
  /// @param last   number of its last point among all times that were seen
  /// @param is_first  does it begin with the start of the motion?
  void back(Workspace& model, const Trajectory& part, size_t last, bool is_first) {
    model_ = &model;
    TransposedSystem system(model);
    size_t change = part.changes.size(), seen = last;
    for (size_t i = part.points.size() - 1; i > 0; --i) {
      if (change > 0 && part.changes[change - 1].after + 1 == i) {
        --change;
        back_through(part.changes[change], part.points[i - 1].x, part.points[i].x, system);
        continue;
      }
      add_measures(part.points[i].x, seen--);
      back_through_step(part.points[i].x, part.points[i].x.t - part.points[i - 1].x.t, system);
    }
    if (is_first) add_measures(part.points[0].x, 0);
    factorizations_ += system.factorizations();
    iterations_ += system.iterations();
  }

  /// Accelerations, multipliers and velocities that the start was given (Integrator).
  /// @param given  velocities before they were projected
  void back_through_start(Workspace& model, const State& x, const VectorXd& given) {
    model_ = &model;
    TransposedSystem system(model);
    system.set(x, {0, 0, 1}, 1);
    for (Swept& s : all_) {
      system.solve(s.by.a + s.alpha, s.by.lambda, psi_, chi_);
      const Along along = along_motion(x, x.v, x.a, chi_);
      s.by.q -= system.by_position(x, psi_) + along.second;
      s.by.v -= system.by_velocity(x, psi_) + 2 * along.first;
      add_work(x, -psi_, s.out);
      s.by.a.setZero();
      s.alpha.setZero();
      s.by.lambda.setZero();
    }
    back_through_projection(x, given, system);
  }

  /// Adds ψ · ∂F/∂p.
  void add_work(const State& x, const VectorXd& psi, MotionGradient& out) {
    model_->add_factor_slopes(x, psi, out.by_factors);
    for (size_t k = 0; k < settings_.parameters.size(); ++k)
      out.by_parameters[static_cast<Eigen::Index>(k)] += settings_.parameters[k](x, psi);
  }

 private:
  void add_measures(const State& x, size_t at) {
    for (size_t k = 0; k < all_.size(); ++k)
      if (const double w = all_[k].slopes[at]; w != 0)
        objectives_[k].measure->add_slopes(*model_, x, w, all_[k].by, all_[k].out.by_factors);
  }

  /// With q_n = q* + δ, q̇_n = q̇* + w.v δ, q̈_n = w.a δ, α_n = α* + κ q̈_n, where the starred ones
  /// follow from the step before and κ = (1 - α_f) / (1 - α_m).
  void back_through_step(const State& x, double h, TransposedSystem& system) {
    const auto& [alpha_m, alpha_f, beta, gamma] = scheme_;
    const Weights w = scheme_.weights(h);
    const double scale = beta * h * h, part = (1 - alpha_f) / (1 - alpha_m);
    system.set(x, w, scale);
    for (Swept& s : all_) {
      const VectorXd seed = s.by.q + w.v * s.by.v + w.a * (s.by.a + part * s.alpha);
      system.solve(seed, s.by.lambda / scale, psi_, chi_);
      psi_ *= scale;
      add_work(x, -psi_, s.out);
      const VectorXd of_v = system.by_velocity(x, psi_);
      // What the equations say of the rest of them.
      const VectorXd q = s.by.q - seed + w.v * of_v + w.a * system.by_acceleration(x, psi_);
      const VectorXd v = s.by.v - of_v;
      const VectorXd alpha = s.alpha + scale * q + h * gamma * v;
      s.by.q = q;
      s.by.v = v + h * q;
      s.alpha = h * h * (0.5 - beta) * q + h * (1 - gamma) * v - alpha_m / (1 - alpha_m) * alpha;
      s.by.a = alpha_f / (1 - alpha_m) * alpha;
      s.by.lambda.setZero();
    }
  }

  void back_through(const Trajectory::Change& change, const State& before, const State& after,
                    TransposedSystem& system) {
    const VectorXd given = change.map.apply({before.q, before.v, before.a}).v;
    system.set(after, {0, 0, 1}, 1);
    back_through_projection(after, given, system);
    for (Swept& s : all_) {
      const MeshMap::Vectors x = change.map.apply_transposed({s.by.q, s.by.v, s.by.a});
      const VectorXd none = VectorXd::Zero(s.alpha.size());
      const MeshMap::Vectors alpha = change.map.apply_transposed({none, none, s.alpha});
      s.by.q = x.q + alpha.q;
      s.by.v = x.v + alpha.v;
      s.by.a = x.a;
      s.alpha = alpha.a;
    }
    undo(change);
  }

  /// Of velocities moved onto the constraints, [M Φ_qᵀ; Φ_q 0] (q̇ - given, μ) = (0, ...).
  void back_through_projection(const State& x, const VectorXd& given, TransposedSystem& system) {
    const VectorXd none = VectorXd::Zero(model_->n_dofs());
    const VectorXd moved = x.v - given;
    VectorXd rows = VectorXd::Zero(model_->n_constraints());
    for (const auto& entry : system.constraints().jacobian)
      rows[entry.row()] += entry.value() * moved[entry.col()];
    VectorXd again, mu;
    system.solve(none, rows, again, mu);  // the matrix is symmetric
    State at = x;
    for (Swept& s : all_) {
      system.solve(s.by.v, VectorXd::Zero(rows.size()), psi_, chi_);
      s.by.q -= along_motion(x, x.v, none, chi_).first + model_->constraint_curvature(x, mu, psi_);
      s.by.v -= system.by_rows(chi_);
      // The mass alone: what acceleration adds to the forces.
      at.a = moved;
      add_work(at, -psi_, s.out);
      at.a.setZero();
      add_work(at, psi_, s.out);
    }
  }

  /// First and second derivative of Φ_q(q + s q̇ + ½ s² q̈, t + s)ᵀ χ by s at 0, forward: what drives
  /// a motion need not be defined before it.
  struct Along {
    VectorXd first, second;
  };
  Along along_motion(const State& x, const VectorXd& v, const VectorXd& a, const VectorXd& chi) {
    constexpr double kStep = 2e-5;  // [s]
    static constexpr std::array<double, 6> kFirst = {-137.0 / 60, 5, -5, 10.0 / 3, -5.0 / 4, 0.2},
                                           kSecond = {15.0 / 4, -77.0 / 6, 107.0 / 6,
                                                      -13,      61.0 / 12, -5.0 / 6};
    Along out{VectorXd::Zero(x.q.size()), VectorXd::Zero(x.q.size())};
    if (chi.isZero(0)) return out;
    State at = x;
    Constraints c;
    for (size_t k = 0; k < kFirst.size(); ++k) {
      const double s = kStep * static_cast<double>(k);
      at.t = x.t + s;
      at.q = x.q + s * v + 0.5 * s * s * a;
      model_->constraints(at, c);
      VectorXd of_rows = VectorXd::Zero(x.q.size());
      Workspace::add_constraint_force(c, chi, of_rows);
      out.first += kFirst[k] / kStep * of_rows;
      out.second += kSecond[k] / (kStep * kStep) * of_rows;
    }
    model_->prepare(x);
    return out;
  }

  /// Gives the body the mesh that it had before.
  void undo(const Trajectory::Change& change) {
    for (Body& body : model_->bodies()) {
      if (body.name != change.body) continue;
      const LineGrid& now = grid_of(body);
      model_->set_element(body, change.change == MeshChange::insertion
                                    ? now.without_line(1)
                                    : now.with_line(0, change.line));
    }
  }

  std::span<const MotionObjective> objectives_;
  const GradientSettings& settings_;
  AlphaScheme scheme_;
  Workspace* model_ = nullptr;
  std::vector<Swept> all_;
  VectorXd psi_, chi_;
  int factorizations_ = 0, iterations_ = 0;
};

/// A motion with all that its gradient takes.
class Gradient {
 public:
  Gradient(const Model& model, std::span<const Growth> growths, const MotionSettings& settings,
           std::span<const MotionObjective> objectives, const GradientSettings& gradient)
      : model_(model),
        growths_(growths),
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
    integrate(model, growths_, settings_, [&](const MotionStep& step) { watched_.see(step); });
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
    Sweep sweep(objectives_, gradient_, AlphaScheme(settings_.alpha.rho_inf));
    begin_at_end(*model, sweep);
    if (memories_.empty()) {
      sweep.back(*model, out.motion.trajectory, watched_.times().size() - 1, true);
      start_ = out.motion.trajectory.points.front().x;
      back_through_start(*model, sweep);
    } else {
      model.reset();  // every part has one of its own
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
    if (objectives_.empty()) throw Error::input("the gradient of a motion: of nothing");
    for (const MotionObjective& o : objectives_)
      if (!o.measure || !(o.exponent >= 1))
        throw Error::input("the gradient of a motion: of a measure, with an exponent of 1 or more");
  }

  /// What a part of the motion begins with.
  struct TakenDown {
    std::string memory;
    double time = 0;
    size_t seen = 0;  // number of its first point among the times that were seen
  };

  void move(Workspace& model, MotionResult& result) {
    MotionSettings settings = settings_;
    settings.keep = gradient_.checkpoints > 0 ? Keep::nothing : Keep::steps;
    const double apart = settings.end / std::max(1, gradient_.checkpoints);
    if (gradient_.checkpoints > 0)
      settings.between_steps = [&](const TakeDown& take_down) {
        const double t = watched_.times().back();
        const auto next = static_cast<double>(memories_.size() + 1) * apart;
        if (t < next - 1e-9 * settings.end || t > settings.end - 0.5 * settings.step) return;
        memories_.push_back({take_down(), t, watched_.times().size() - 1});
      };
    result =
        integrate(model, growths_, settings, [&](const MotionStep& step) { watched_.see(step); });
  }

  void begin_at_end(const Workspace& model, Sweep& sweep) const {
    for (size_t k = 0; k < objectives_.size(); ++k) {
      Swept& s = sweep.all().emplace_back();
      s.by.set_zero(model.n_dofs(), model.n_constraints());
      s.alpha.setZero(model.n_dofs());
      WatchedMeasures::Mean mean = watched_.mean(k, settings_.stops);
      s.out.value = mean.value;
      s.slopes = std::move(mean.slopes);
      s.out.by_factors = model.no_slopes();
      s.out.by_parameters.setZero(static_cast<Eigen::Index>(gradient_.parameters.size()));
    }
  }

  void back_by_parts(Sweep& sweep) {
    size_t last = watched_.times().size() - 1;
    for (size_t k = memories_.size() + 1; k-- > 0;) {
      MotionSettings settings = settings_;
      settings.keep = Keep::steps;
      if (k > 0) settings.memory = memories_[k - 1].memory;
      if (k < memories_.size()) settings.until = memories_[k].time;
      Workspace model(model_);
      const MotionResult part = integrate(model, growths_, settings, [](const MotionStep&) {});
      sweep.back(model, part.trajectory, last, k == 0);
      if (k > 0) {
        last = memories_[k - 1].seen;
        memories_.resize(k);  // those behind are done with
        continue;
      }
      start_ = part.trajectory.points.front().x;
      back_through_start(model, sweep);
    }
  }

  void back_through_start(Workspace& model, Sweep& sweep) {
    // As Run::begin() of motion.cpp.
    const double delta = std::min(1e-4, 0.5 * settings_.end);
    const VectorXd given =
        start_state(model, growths_, 0, settings_.start, settings_.placement, delta).v;
    sweep.back_through_start(model, start_, given);
    for (Swept& s : sweep.all())
      derive_start(model, growths_, 0, settings_.start, settings_.placement, delta, s.by.q, s.by.v,
                   [&](const State& x, const VectorXd& psi) { sweep.add_work(x, psi, s.out); });
  }

  const Model& model_;
  std::span<const Growth> growths_;
  MotionSettings settings_;
  std::span<const MotionObjective> objectives_;
  const GradientSettings& gradient_;
  WatchedMeasures watched_;
  std::vector<TakenDown> memories_;
  State start_;
};

}  // namespace

std::string no_gradient_because(const Model& model, const MotionSettings& settings) {
  if (settings.adaptive) return "steps that adapt depend on the design: time.tolerance";
  if (settings.integrator != "generalized_alpha")
    return "integrator \"" + settings.integrator + "\" has none, \"generalized_alpha\" does";
  if (!settings.kinks.empty()) return "drives have kinks, where accelerations may jump";
  for (const Body& body : model.bodies()) {
    if (body.element->n_scalars() > 0)
      return "the material lines of body '" + body.name +
             "' are free, and when its mesh changes depends on the design";
    if (body.heat) return "body '" + body.name + "' is hot";
    if (body.element->dim() == 3) return "body '" + body.name + "' lives in space";
  }
  return {};
}

MotionGradients motion_gradients(const Model& model, std::span<const Growth> growths,
                                 const MotionSettings& settings,
                                 std::span<const MotionObjective> objectives,
                                 const GradientSettings& gradient) {
  return Gradient(model, growths, settings, objectives, gradient).go();
}

std::vector<double> motion_values(const Model& model, std::span<const Growth> growths,
                                  const MotionSettings& settings,
                                  std::span<const MotionObjective> objectives) {
  return Gradient(model, growths, settings, objectives, {}).values();
}

}  // namespace flexmorph::fem
