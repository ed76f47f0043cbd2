#include "fem/dynamics/integrators/minimal_coordinates.h"

#include <algorithm>
#include <boost/numeric/odeint/stepper/controlled_runge_kutta.hpp>
#include <boost/numeric/odeint/stepper/runge_kutta_dopri5.hpp>
#include <cmath>
#include <limits>

#include "fem/dynamics/force_balance.h"
#include "fem/dynamics/integrators/acceleration_solver.h"
#include "fem/dynamics/integrators/coordinate_partition.h"
#include "fem/solve/branch_watch.h"
#include "geometry/text.h"

namespace flexmorph::fem {
namespace {

namespace odeint = boost::numeric::odeint;
using Numbers = std::vector<double>;
using DormandPrince = odeint::runge_kutta_dopri5<Numbers>;

/// Relative correction of dependent positions after which only round-off remains, because Newton's
/// method converges quadratically.
constexpr double kConverged = 1e-10;
constexpr int kMaxIterations = 10;
/// Largest allowed correction of a prediction, relative to the predicted motion or to half the size
/// of the model if that is larger. A larger correction may lead to another branch of the
/// constraints.
constexpr double kCorrection = 0.1;
/// Limits of the amplification of the partition, relative to its best value since the choice. Above
/// kDeteriorated the partition is chosen again. Above kAmbiguous the step is rejected: where the
/// amplification is infinite, independent coordinates are at a limit of their motion and do not
/// distinguish between two branches.
constexpr double kDeteriorated = 2, kAmbiguous = 50;
/// Shortest step, as a fraction of an advance(). Shorter steps are not due to stiffness but to a
/// singularity or a discontinuity. Steps up to kCrossing pass positions where branches meet.
constexpr double kShortest = 1e-12, kCrossing = 1.0 / 64;
/// Lower limit of the speed to which velocity errors are related: a displacement of this fraction
/// of the model's size in one step. Without it a model at zero velocity would have no reference.
constexpr double kLongRun = 1e-3;

/// Measure of the local error for Boost.Odeint.
class ErrorInScaledUnits {
 public:
  using algebra_type = DormandPrince::algebra_type;

  /// @param scales  Displacement per unit of each independent coordinate.
  ErrorInScaledUnits(const Numbers& scales, double size, double tolerance)
      : scales_(&scales), size_(size), tolerance_(tolerance) {}

  /// Returns the largest error relative to the error that the tolerance allows.
  template <class Y, class Rate, class Miss, class Time>
  double error(algebra_type&, const Y& y, const Rate& rate, const Miss& miss, Time h) const {
    const size_t n = scales_->size();
    double speed = 0, position_miss = 0, rate_miss = 0;
    for (size_t k = 0; k < n; ++k) {
      const double s = (*scales_)[k];
      speed = std::max(speed, s * (std::abs(y[n + k]) + h * std::abs(rate[n + k])));
      position_miss = std::max(position_miss, s * std::abs(miss[k]));
      rate_miss = std::max(rate_miss, s * std::abs(miss[n + k]));
    }
    speed = std::max(speed, kLongRun * size_ / h);
    const double out = std::max(position_miss / size_, rate_miss / speed) / tolerance_;
    return std::isfinite(out) ? out : std::numeric_limits<double>::infinity();
  }

 private:
  const Numbers* scales_;
  double size_, tolerance_;
};

using Stepper = odeint::controlled_runge_kutta<DormandPrince, ErrorInScaledUnits>;

}  // namespace

struct MinimalCoordinates::Impl {
  Impl(Workspace& m, const MinimalCoordinatesSettings& s)
      : model(m), settings(s), accelerations(m), branch(m), stepper(make_stepper()) {}

  Workspace& model;
  MinimalCoordinatesSettings settings;
  StepCounts counts;
  AccelerationSolver accelerations;
  CoordinatePartition partition;
  BranchWatch branch;
  int version = -1;  // pattern version of the model at the last choice of the partition
  VectorXd scales;
  double size = 1;
  double amplification = 1, best_amplification = 1;  // at the last step; best since the choice
  Numbers y, independent_scales;
  Stepper stepper;
  double step = 0,
         whole = 0;       // size of the next step (0: unknown); length of the present advance()
  State last;             // last accepted state; steps from it reuse the stepper's derivative
  Numbers rate;           // derivative of y, from the last stage of the previous step
  bool is_begun = false;  // true if `rate` is valid
  State at;               // state of the last evaluation
  Constraints constraints;
  VectorXd right, correction, force, none;

  Stepper make_stepper() const {
    return Stepper(ErrorInScaledUnits(independent_scales, size, settings.tolerance));
  }

  void solve_motion(State& x) {
    model.constraints(x, constraints);
    accelerations.factorize(x, constraints);
    x.a.setZero(model.n_dofs());
    model.force(x, force);
    force *= -1;
    accelerations.solve(force, constraints.acceleration, x.a, x.lambda);
    counts.factorizations = accelerations.factorizations();
  }

  /// Chooses the partition of the coordinates at x and starts the integration there.
  /// @returns true if the partition has changed.
  bool choose(const State& x) {
    model.prepare(x);  // for the scales
    const bool differs = partition.choose(model, x);
    model.constraints(x, constraints);
    partition.factorize(constraints);
    best_amplification = partition.amplification();
    counts.partitions += differs;
    version = model.pattern_version();
    scales = model.scales();
    size = undeformed_size(model, scales);
    independent_scales.clear();
    for (const int i : partition.independent()) independent_scales.push_back(scales[i]);
    start(x);
    return differs;
  }

  /// Starts the integration at x.
  void start(const State& x) {
    const std::vector<int>& independent = partition.independent();
    const size_t n = independent.size();
    y.resize(2 * n);
    for (size_t k = 0; k < n; ++k) {
      y[k] = x.q[independent[k]];
      y[n + k] = x.v[independent[k]];
    }
    stepper = make_stepper();
    is_begun = false;
    at = last = x;
  }

  double displacement(const VectorXd& of_dependent) const {
    double out = 0;
    for (Eigen::Index k = 0; const int i : partition.dependent())
      out = std::max(out, scales[i] * std::abs(of_dependent[k++]));
    return out;
  }

  void find_positions(double motion);
  void find_velocities();
  void evaluate(const Numbers& from, Numbers& rate, double t);
  bool try_step(const State& x, double& h, std::string& reason);
  double fastest_vibration(const State& x);
  [[noreturn]] void give_up(const State& x, double h, const std::string& reason);
};

/// Solves Φ(q, t) = 0 for the dependent positions of `at`. Φ and the factorization of Φ_qd are left
/// at the solution.
/// @param motion  Largest predicted displacement of a dependent position [m].
void MinimalCoordinates::Impl::find_positions(double motion) {
  const std::vector<int>& dependent = partition.dependent();
  const double most = kCorrection * std::max(motion, 0.5 * size);
  double before = 0;
  for (int iteration = 0; iteration < kMaxIterations; ++iteration) {
    model.constraints(at, constraints);
    partition.factorize(constraints);
    if (iteration > 0 && before <= kConverged * size) return;
    right = -constraints.value;
    partition.solve(right, correction);
    ++counts.newton;
    const double now = displacement(correction);
    const bool shrinks = iteration == 0 || now <= 0.5 * before || now <= kConverged * size;
    if (!(now <= most) || !shrinks) break;  // also if it is not a number
    for (size_t k = 0; k < dependent.size(); ++k)
      at.q[dependent[k]] += correction[static_cast<Eigen::Index>(k)];
    before = now;
  }
  throw Error::numerical(
      formatted("the dependent coordinates could not be computed at t = %.9g s", at.t));
}

/// Solves Φ_q q̇ = -Φ_t for the dependent velocities of `at`.
void MinimalCoordinates::Impl::find_velocities() {
  const std::vector<int>& dependent = partition.dependent();
  for (const int i : dependent) at.v[i] = 0;
  right = -constraints.rate;
  for (const auto& entry : constraints.jacobian)
    right[entry.row()] -= entry.value() * at.v[entry.col()];
  partition.solve(right, correction);
  for (Eigen::Index k = 0; const int i : dependent) at.v[i] = correction[k++];
}

/// Computes ẏ at (y, t); `at` becomes the complete state there.
void MinimalCoordinates::Impl::evaluate(const Numbers& from, Numbers& rate, double t) {
  ++counts.evaluations;
  const std::vector<int>& independent = partition.independent();
  const size_t n = independent.size();
  const double h = t - at.t;
  double motion = 0;
  for (const int i : partition.dependent()) {
    const double step_of_i = h * at.v[i] + 0.5 * h * h * at.a[i];
    motion = std::max(motion, scales[i] * std::abs(step_of_i));
    at.q[i] += step_of_i;
  }
  for (size_t k = 0; k < n; ++k) {
    at.q[independent[k]] = from[k];
    at.v[independent[k]] = from[n + k];
  }
  at.t = t;
  if (!partition.dependent().empty()) {
    find_positions(motion);
    find_velocities();
  }
  solve_motion(at);
  for (size_t k = 0; k < n; ++k) {
    rate[k] = at.v[independent[k]];
    rate[n + k] = at.a[independent[k]];
  }
}

/// Tries one step of size h from x, of which `last` is a copy. `at` becomes its end, and h the size
/// of the next step.
/// @returns true if the step was accepted; otherwise `reason` is the message of a failure, or empty
/// if the local error was too large.
bool MinimalCoordinates::Impl::try_step(const State& x, double& h, std::string& reason) {
  at = last;
  const double tried = h;
  double t = x.t;
  reason.clear();
  try {
    const auto system = [this](const auto& from, auto& to, double s) { evaluate(from, to, s); };
    rate.resize(y.size());
    if (!is_begun) evaluate(y, rate, t);
    is_begun = true;
    branch.begin(last);
    if (stepper.try_step(system, y, rate, t, h) == odeint::fail) return false;
    reason = branch.refusal(at.q, at.t, tried <= kCrossing * whole);
    if (!reason.empty()) throw Error::numerical(reason);
    amplification = partition.amplification();
    if (amplification <= kAmbiguous * best_amplification) return true;
    throw Error::numerical("the independent coordinates no longer determine the others");
  } catch (const Error& error) {
    if (error.kind() != Error::Kind::numerical) throw;
    reason = error.what();
    h = 0.5 * tried;
    choose(last);
  }
  return false;
}

/// Returns the frequency [rad/s] of the fastest vibration: the root of the largest
/// |q̈(q + ε z) - q̈(q)| / ε, found by power iteration; 0 if it cannot be computed.
double MinimalCoordinates::Impl::fastest_vibration(const State& x) {
  const size_t n = independent_scales.size();
  if (n == 0) return 0;
  Numbers from(y.begin(), y.end()), rate(2 * n), there(2 * n), z(n);
  for (size_t k = 0; k < n; ++k)
    z[k] = std::fmod(0.6180339887498949 * static_cast<double>(k + 1), 1.0) - 0.37;
  double square = 0;
  try {
    at = last;
    evaluate(y, rate, x.t);
    for (int iteration = 0; iteration < 30; ++iteration) {
      double norm = 0;
      for (size_t k = 0; k < n; ++k) norm = std::max(norm, std::abs(z[k]));
      const double by = 1e-7 * size / norm;
      for (size_t k = 0; k < n; ++k) from[k] = y[k] + by * z[k] / independent_scales[k];
      evaluate(from, there, x.t);
      square = 0;
      for (size_t k = 0; k < n; ++k) {
        z[k] = independent_scales[k] * (there[n + k] - rate[n + k]) / (1e-7 * size);
        square = std::max(square, std::abs(z[k]));
      }
      if (!(square > 0)) return 0;
    }
  } catch (const Error&) {
    return 0;  // the value is only used in the message of another failure
  }
  return std::sqrt(square);
}

void MinimalCoordinates::Impl::give_up(const State& x, double h, const std::string& reason) {
  std::string message =
      formatted("minimal_coordinates: at t = %.9g s, step %d, the step size %.3g s ", x.t,
                counts.steps + 1, h);
  if (!reason.empty()) throw Error::numerical(message + "is too small to continue: " + reason);
  const double omega = fastest_vibration(x);
  if (h * omega > 0.1)
    throw Error::numerical(
        message + formatted("is limited by stability. The model is stiff: its largest angular "
                            "frequency of %.2g rad/s allows explicit steps of %.2g s. Set "
                            "integrator = \"generalized_alpha\", which does not have this limit.",
                            omega, 1 / omega));
  throw Error::numerical(message +
                         "is too small to continue. A drive or a load may jump there. A larger "
                         "time.tolerance may help.");
}

MinimalCoordinates::MinimalCoordinates(Workspace& model, const MinimalCoordinatesSettings& settings)
    : impl_(std::make_unique<Impl>(model, settings)) {
  if (!(settings.tolerance >= 1e-13 && settings.tolerance < 1) || settings.max_steps < 1)
    throw Error::input(
        "minimal_coordinates: the tolerance must lie in [1e-13, 1), and max_steps must be "
        "positive");
  for (const Body& b : model.bodies())
    if (b.element->n_scalars() > 0)
      throw Error::input("minimal_coordinates: body '" + b.name +
                         "' has free material lines, which have no inertia of their own; use "
                         "integrator \"generalized_alpha\"");
}

MinimalCoordinates::~MinimalCoordinates() = default;

const StepCounts& MinimalCoordinates::counts() const { return impl_->counts; }
std::optional<double> MinimalCoordinates::condition() const {
  return impl_->accelerations.condition();
}

void MinimalCoordinates::archive(Archive& memory) {
  Impl& s = *impl_;
  memory(s.counts, s.scales, s.size, s.amplification, s.best_amplification, s.y, s.rate, s.is_begun,
         s.independent_scales, s.step, s.last, s.partition);
  memory.up_to_date(s.version, s.model.pattern_version());
  s.accelerations.archive(memory);
  if (!memory.is_restoring()) return;
  s.at = s.last;
  s.stepper = s.make_stepper();
}

void MinimalCoordinates::make_consistent(State& x) {
  Impl& s = *impl_;
  s.accelerations.forget();
  if (s.version != s.model.pattern_version()) s.choose(x);
  s.solve_motion(x);
}

void MinimalCoordinates::project_velocity(State& x) {
  Impl& s = *impl_;
  s.accelerations.forget();
  if (s.version != s.model.pattern_version()) s.choose(x);
  s.model.constraints(x, s.constraints);
  s.accelerations.factorize(x, s.constraints);
  s.right = -s.constraints.rate;
  for (const auto& entry : s.constraints.jacobian)
    s.right[entry.row()] -= entry.value() * x.v[entry.col()];
  s.none.setZero(s.model.n_dofs());
  VectorXd change, impulse;
  s.accelerations.solve(s.none, s.right, change, impulse);
  x.v += change;
}

VectorXd MinimalCoordinates::balance(State& x, double frequency) {
  return balance_forces(impl_->model, x, frequency);
}

void MinimalCoordinates::advance(State& x, double t_end,
                                 const std::function<void(const State&)>& accepted) {
  Impl& s = *impl_;
  s.whole = t_end - x.t;
  if (s.version != s.model.pattern_version()) {
    s.choose(x);
    s.step = 0;
  } else if (x.t != s.last.t || x.q != s.last.q || x.v != s.last.v) {
    s.start(x);
  }
  if (!(s.step > 0)) s.step = 0.01 * s.whole;
  std::string reason;
  for (int tried = 0; x.t < t_end; ++tried) {
    // The last two steps are adjusted, so that no short step remains before the end.
    const double left = t_end - x.t;
    double h = s.step;
    if (h > 0.5 * left) h = h > (1 - 1e-9) * left ? left : 0.5 * left;
    const bool ends = h == left, is_cut = h < s.step;
    if (tried >= s.settings.max_steps) s.give_up(x, h, "");
    const double own = s.step;
    if (!s.try_step(x, h, reason)) {
      ++s.counts.rejected;
      s.step = h;
      if (h < kShortest * s.whole) s.give_up(x, h, reason);
      continue;
    }
    s.step = is_cut ? std::max(own, h) : h;
    if (ends) s.at.t = t_end;
    s.model.follow_turns(s.at);
    x = s.last = s.at;
    ++s.counts.steps;
    accepted(x);
    if (s.amplification > kDeteriorated * s.best_amplification) s.choose(x);
    s.best_amplification = std::min(s.best_amplification, s.amplification);
  }
}

}  // namespace flexmorph::fem
