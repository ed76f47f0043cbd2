#include "fem/dynamics/integrators/generalized_alpha.h"

#include <cmath>

namespace flexmorph::fem {
namespace {

constexpr int kFilters = 3;      // number of filterings of an error that is too large
constexpr int kMoreFilters = 8;  // if it is below kFaint of the tolerance after one filtering
constexpr double kFaint = 0.3;
// Limit of the change of q⃛ from step to step, relative to the larger of both; above it q⃛ is
// ringing.
constexpr double kSmooth = 1.2;

}  // namespace

AlphaScheme::AlphaScheme(double rho) {
  if (!(rho >= 0 && rho <= 1)) throw Error::input("generalized_alpha: rho_inf must lie in [0, 1]");
  alpha_m = (2 * rho - 1) / (rho + 1);
  alpha_f = rho / (rho + 1);
  gamma = 0.5 + alpha_f - alpha_m;
  beta = 0.25 * (gamma + 0.5) * (gamma + 0.5);
}

GeneralizedAlpha::GeneralizedAlpha(Workspace& model, const AlphaSettings& settings)
    : StepSolver(model, settings, "generalized_alpha", "Reduce time.step or rho_inf."),
      scheme_(settings.rho_inf) {}

void GeneralizedAlpha::begin(const State& x, double h) {
  h_ = h;
  set_start(x);
  next_ = x;
  next_.t = x.t + h;
  // The iteration starts with the true acceleration of the previous step.
  next_alpha_ =
      ((1 - scheme_.alpha_f) * x.a + scheme_.alpha_f * x.a - scheme_.alpha_m * start_alpha_) /
      (1 - scheme_.alpha_m);
  next_.q +=
      h * start_v_ + h * h * ((0.5 - scheme_.beta) * start_alpha_ + scheme_.beta * next_alpha_);
  next_.v = start_v_ + h * ((1 - scheme_.gamma) * start_alpha_ + scheme_.gamma * next_alpha_);
}

void GeneralizedAlpha::begin_motion(const State& x, double h) {
  // Fractions of a step: short relative to the motion, long enough for round-off of stiff bodies.
  constexpr double kParts[] = {1e-3, 1e-2, 1e-1};
  constexpr double kChange = 0.25;  // limit of the relative change of a smooth q⃛
  set_scales();
  start_ = {};
  const auto ahead = [&](double s, const VectorXd* jerk = nullptr) {
    State later = x;
    later.t += s;
    later.q += s * x.v + 0.5 * s * s * x.a;
    later.v += s * x.a;
    if (jerk) {
      later.q += s * s * s / 6 * *jerk;
      later.v += 0.5 * s * s * *jerk;
    }
    solve_accelerations(later);
    return later;
  };
  const auto is_near = [&](const VectorXd& other, const VectorXd& jerk) {
    return displacement(other - jerk) <= kChange * displacement(jerk);
  };
  for (const double part : kParts) {
    StartJerk found;
    found.after = part * h;
    const State twice = ahead(2 * found.after);
    found.later = ahead(found.after);
    found.jerk = (found.later.a - x.a) / found.after;
    const VectorXd next = (twice.a - found.later.a) / found.after;
    if (!is_near(next, found.jerk)) continue;
    // A motion that decays within a fraction of the step is smooth only over a shorter time.
    const double longest = kParts[std::size(kParts) - 1] * h;
    if (found.after < longest &&
        !is_near((ahead(longest, &found.jerk).a - x.a) / longest, found.jerk))
      return;
    found.held = held_part(x, found.jerk);
    start_ = std::move(found);
    return;
  }
}

void GeneralizedAlpha::cross_discontinuity(State& x) {
  change_ = alpha_ - x.a;
  make_consistent(x);
  alpha_ += change_;
}

void GeneralizedAlpha::change_mesh(const MeshMap& map, const State& before,
                                   const VectorXd& change) {
  start_ = {};
  if (alpha_.size() == map.n_before())
    alpha_ = map.acceleration(before.q, before.v, alpha_) + change;
}

void GeneralizedAlpha::archive(Archive& memory) {
  StepSolver::archive(memory);
  memory(alpha_, last_h_, jerk_, step_jerk_, smooth_);
  memory.up_to_date(jerk_version_, model().pattern_version());
}

void GeneralizedAlpha::set_start(const State& x) {
  if (alpha_.size() != x.a.size()) alpha_ = x.a;
  start_alpha_ = alpha_;
  start_v_ = x.v;
  if (start_.jerk.size() > 0) {
    start_alpha_ += shift() * h_ * start_.jerk;
    start_v_ += error_constant() * h_ * h_ * start_.held;
  }
  if (last_h_ < 0) return;
  const bool same_mesh = jerk_version_ == model().pattern_version();
  if (same_mesh && h_ == last_h_) return;
  if (!same_mesh) {
    if (last_h_ == 0 || shift() == 0) return;
    jerk_ = (alpha_ - x.a) / (shift() * last_h_);
  }
  if (!smooth_) return;
  start_alpha_ += shift() * (h_ - last_h_) * jerk_;

  // Correction of the velocity in the directions that constraints hold.
  const bool projected = !same_mesh || last_h_ == 0;
  const double last = projected ? 0 : last_h_;
  change_ = error_constant() * (h_ * h_ - last * last) * jerk_;
  next_ = x;
  residual(balance_, miss_);
  if (projected) factorize_here(h_);
  error_ = change_;
  filter(error_, balance_);
  start_v_ += change_ - error_;
}

void GeneralizedAlpha::residual(VectorXd& force, VectorXd& constraint) {
  model().constraints(next_, constraints_);
  model().force(next_, force);
  model().add_constraint_force(constraints_, next_.lambda, force);
  constraint = constraints_.value;
}

void GeneralizedAlpha::tangent(SparseMatrix& out) {
  model().kkt(next_, constraints_, weights(), scale(), out);
}

bool GeneralizedAlpha::renew_tangent(const std::vector<char>& chosen, SparseMatrix& out) {
  model().renew_kkt(next_, constraints_, weights(), scale(), chosen, out);
  return true;
}

void GeneralizedAlpha::correct(const VectorXd& dq, const VectorXd& dlambda) {
  const Weights w = weights();
  next_.q += dq;
  next_.v += w.v * dq;
  next_.a += w.a * dq;
  next_.lambda += dlambda;
}

void GeneralizedAlpha::set_end_alpha(const State& x) {
  next_alpha_ =
      ((1 - scheme_.alpha_f) * next_.a + scheme_.alpha_f * x.a - scheme_.alpha_m * start_alpha_) /
      (1 - scheme_.alpha_m);
}

double GeneralizedAlpha::first_step(const State& x, double allowed, double longest) {
  set_scales();
  // Time difference with displacements of 1e-4 of the model: short relative to the motion, and long
  // enough for round-off.
  const double speed = displacement(x.v), pull = displacement(x.a);
  double s = 1e-3 * longest;
  if (speed > 0) s = std::min(s, 1e-4 * size() / speed);
  if (pull > 0) s = std::min(s, std::sqrt(1e-4 * size() / pull));
  State later = x;
  later.t += s;
  later.q += s * x.v + 0.5 * s * s * x.a;
  later.v += s * x.a;
  solve_accelerations(later);
  jerk_ = (later.a - x.a) / s;
  jerk_version_ = model().pattern_version();
  last_h_ = 0;
  step_jerk_.resize(0);
  const double jerk = std::abs(error_constant()) * displacement(jerk_) / size();
  return jerk > 0 ? std::min(longest, 0.5 * std::cbrt(allowed / jerk)) : longest;
}

double GeneralizedAlpha::local_error(const State& x, double allowed) {
  set_end_alpha(x);
  error_ = error_constant() * h_ * h_ * (next_alpha_ - start_alpha_);
  double out = 0;
  const double tolerance = std::pow(allowed, 2.0 / 3);
  // The filter does not change frequencies that the step resolves, however often it is applied.
  for (int pass = 0, passes = kFilters; pass < passes; ++pass) {
    // The forces at q̈ and the multipliers are in balance up to the next correction of Newton's
    // method, which is far below any error of interest.
    filter(error_, {});
    out = displacement(error_) / size();
    if (out <= allowed) break;
    // After one filtering, an unresolved vibration contributes about half of its amplitude. If this
    // is far enough below the tolerance, the vibration need not be resolved.
    if (pass == 0 && out <= kFaint * tolerance) passes = kMoreFilters;
  }
  return out;
}

void GeneralizedAlpha::filter(VectorXd& e, const VectorXd& balance) {
  // A_M e is computed as a difference of forces, which are linear in the acceleration.
  kept_a_ = next_.a;
  next_.a += weights().a * e;
  // Free lines are excluded because they have no inertia of their own.
  for (const Body& b : model().bodies())
    if (const int n = b.element->n_scalars(); n > 0)
      next_.a.segment(b.first_scalar(), n) = kept_a_.segment(b.first_scalar(), n);
  model().force(next_, force_);
  next_.a.swap(kept_a_);
  model().add_constraint_force(constraints_, next_.lambda, force_);
  if (balance.size() > 0) force_ -= balance;
  force_ *= scale();
  none_.setZero(model().n_constraints());
  solve_kept(force_, none_, e, mu_);
}

void GeneralizedAlpha::finish(State& x) {
  set_end_alpha(x);
  if (last_h_ >= 0) keep_jerk();
  x = next_;
}

void GeneralizedAlpha::keep_jerk() {
  change_ = (next_alpha_ - start_alpha_) / h_;
  const int version = model().pattern_version();
  if (last_h_ > 0 && jerk_version_ == version && step_jerk_.size() == change_.size()) {
    jerk_ = (h_ * change_ + last_h_ * step_jerk_) / (h_ + last_h_);
    smooth_ = displacement(change_ - step_jerk_) <=
              kSmooth * std::max(displacement(change_), displacement(step_jerk_));
  } else {
    jerk_ = change_;
  }
  step_jerk_.swap(change_);
  jerk_version_ = version;
  last_h_ = h_;
}

}  // namespace flexmorph::fem
