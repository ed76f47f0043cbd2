#pragma once

#include <array>

#include "fem/dynamics/force_balance.h"
#include "fem/dynamics/gradients/motion_gradient.h"
#include "fem/dynamics/gradients/transposed_system.h"
#include "fem/dynamics/integrators/generalized_alpha.h"

/// Backward sweep through a motion. This header belongs to the implementation of
/// motion_gradients().
namespace flexmorph::fem {

/// Data of one objective during the backward sweep.
struct Swept {
  StateGradient by;            ///< Derivatives of J with respect to the present state of the sweep.
  VectorXd alpha;              ///< Derivatives of J by the algorithmic acceleration α (n_dofs).
  MotionGradient out;          ///< Value and gradient of J, as far as they are summed up.
  std::vector<double> slopes;  ///< Derivatives ∂J/∂m(t_i) for all observed times.
};

/// Backward sweep through a motion, one part of the motion at a time.
class AdjointSweep {
 public:
  /// Creates the sweep of one motion. The arguments must outlive it.
  AdjointSweep(std::span<const MotionObjective> objectives, const GradientSettings& settings,
               const MotionSettings& motion)
      : objectives_(objectives),
        settings_(settings),
        motion_(motion),
        scheme_(motion.alpha.rho_inf) {}

  /// Returns the data of all objectives.
  std::vector<Swept>& all() { return all_; }
  /// Returns the number of factorizations so far.
  int factorizations() const { return factorizations_; }
  /// Returns the number of iterations of the linear solver so far.
  int iterations() const { return iterations_; }

  /// Propagates the derivatives backwards through one part of the motion.
  /// @param model     in: with the mesh of the end of the part; out: with the mesh of its start.
  /// @param last      Index of the last point of the part among all observed times.
  /// @param is_first  True if the part begins with the start of the motion.
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
      if (settings_.every_step) settings_.every_step();
      add_measures(part.points[i].x, seen--);
      const State &x = part.points[i].x, &before = part.points[i - 1].x;
      back_through_step(x, x.t - before.t, system);
      if (i == 1 && is_first) back_through_start_jerk(before, x.t - before.t);
    }
    if (is_first) add_measures(part.points[0].x, 0);
    factorizations_ += system.factorizations();
    iterations_ += system.iterations();
  }

  /// Propagates the derivatives through the operations of Integrator on the initial state x: the
  /// consistent accelerations and multipliers, and the projection of the velocities.
  /// @param given  Velocities before their projection (n_dofs).
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

  /// Adds ψ · ∂F/∂p to `out` for the scale factors of all cells and for all parameters p.
  void add_work(const State& x, const VectorXd& psi, MotionGradient& out) {
    model_->add_scale_factor_gradient(x, psi, out.d_factors);
    for (size_t k = 0; k < settings_.parameters.size(); ++k)
      out.by_parameters[static_cast<Eigen::Index>(k)] += settings_.parameters[k](x, psi);
  }

 private:
  /// Adds the derivatives of all measures at the observed time with index `at`.
  void add_measures(const State& x, size_t at) {
    for (size_t k = 0; k < all_.size(); ++k)
      if (const double w = all_[k].slopes[at]; w != 0)
        objectives_[k].measure->add_gradient(*model_, x, w, all_[k].by, all_[k].out.d_factors);
  }

  /// Propagates the derivatives through a step of size h that ends at x. The step is written as
  /// q_n = q* + δ, q̇_n = q̇* + w.v δ, q̈_n = w.a δ, α_n = α* + κ q̈_n, where the starred vectors
  /// follow from the previous step and κ = (1 - α_f) / (1 - α_m).
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
      // The remaining derivatives follow from the equations R1 to R3 of the step.
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

  /// Propagates the derivatives through GeneralizedAlpha::begin_motion(): the first step, of size
  /// h, started from q̇_0 + C h² P q⃛ and q̈_0 + δ h q⃛.
  void back_through_start_jerk(const State& x, double h) {
    GeneralizedAlpha integrator(*model_, motion_.alpha);
    integrator.begin_motion(x, motion_.step);
    const StartJerk& start = integrator.start_jerk();
    if (start.jerk.size() == 0) return;
    TransposedSystem system(*model_);
    system.set(x, {0, 0, 1}, 1);
    const VectorXd no_force = VectorXd::Zero(model_->n_dofs()),
                   no_rows = VectorXd::Zero(model_->n_constraints());
    VectorXd rows = no_rows, again, mu;
    for (const auto& entry : system.constraints().jacobian)
      rows[entry.row()] += entry.value() * start.jerk[entry.col()];
    system.solve(no_force, rows, again, mu);  // the matrix is symmetric
    std::vector<VectorXd> by_jerk;
    for (Swept& s : all_) {
      system.solve(integrator.error_constant() * h * h * s.by.v, no_rows, psi_, chi_);
      by_jerk.push_back(integrator.shift() * h * s.alpha + system.by_rows(chi_));
      s.by.q += model_->constraint_curvature(x, chi_, start.jerk - start.held) -
                model_->constraint_curvature(x, mu, psi_);
      add_mass_work(x, start.held, -psi_, s.out);
    }
    system.set(start.later, {0, 0, 1}, 1);
    const double after = start.after;
    for (size_t k = 0; k < all_.size(); ++k) {
      Swept& s = all_[k];
      const VectorXd seed = by_jerk[k] / after;
      system.solve(seed, no_rows, psi_, chi_);
      const Along along = along_motion(start.later, start.later.v, start.later.a, chi_);
      const VectorXd q = -system.by_position(start.later, psi_) - along.second;
      const VectorXd v = -system.by_velocity(start.later, psi_) - 2 * along.first;
      add_work(start.later, -psi_, s.out);
      s.by.q += q;
      s.by.v += v + after * q;
      s.by.a += after * v + 0.5 * after * after * q - seed;
    }
    factorizations_ += system.factorizations();
    iterations_ += system.iterations();
  }

  /// Adds ψ · ∂(M a)/∂p to `out`, as the difference of the forces with and without acceleration a.
  void add_mass_work(State x, const VectorXd& a, const VectorXd& psi, MotionGradient& out) {
    x.a = a;
    add_work(x, psi, out);
    x.a.setZero();
    add_work(x, -psi, out);
  }

  /// Propagates the derivatives through a change of the mesh, from the state after it to that
  /// before.
  void back_through(const Trajectory::Change& change, const State& before, const State& after,
                    TransposedSystem& system) {
    const VectorXd given = change.map.apply({before.q, before.v, before.a}).v;
    system.set(after, {0, 0, 1}, 1);
    back_through_projection(after, given, system);
    State balanced = after;
    balanced.v = given;
    back_through_balance(balanced, separating_frequency(model_->body(change.body)), system);
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

  /// Propagates the derivatives through balance_forces(), which is a step with constant velocities:
  /// q = q* + δ, q̈ = q̈* + ω² δ, α = α* + ω² δ.
  /// @param x  State in balance.
  void back_through_balance(const State& x, double frequency, TransposedSystem& system) {
    const double stiffness = frequency * frequency, scale = 1 / stiffness;
    system.set(x, {1, 0, stiffness}, scale);
    for (Swept& s : all_) {
      const VectorXd seed = s.by.q + stiffness * (s.by.a + s.alpha);
      system.solve(seed, s.by.lambda / scale, psi_, chi_);
      psi_ *= scale;
      add_work(x, -psi_, s.out);
      const VectorXd of_a = system.by_acceleration(x, psi_);
      s.by.q += stiffness * of_a - seed;
      s.by.v -= system.by_velocity(x, psi_);
      s.by.a -= of_a;
      s.by.lambda.setZero();
    }
  }

  /// Propagates the derivatives through the projection of velocities onto the constraints,
  /// [M Φ_qᵀ; Φ_q 0] (q̇ - given, μ) = (0, ...).
  void back_through_projection(const State& x, const VectorXd& given, TransposedSystem& system) {
    const VectorXd none = VectorXd::Zero(model_->n_dofs());
    const VectorXd moved = x.v - given;
    VectorXd rows = VectorXd::Zero(model_->n_constraints());
    for (const auto& entry : system.constraints().jacobian)
      rows[entry.row()] += entry.value() * moved[entry.col()];
    VectorXd again, mu;
    system.solve(none, rows, again, mu);  // the matrix is symmetric
    for (Swept& s : all_) {
      system.solve(s.by.v, VectorXd::Zero(rows.size()), psi_, chi_);
      s.by.q -= along_motion(x, x.v, none, chi_).first + model_->constraint_curvature(x, mu, psi_);
      s.by.v -= system.by_rows(chi_);
      add_mass_work(x, moved, -psi_, s.out);
    }
  }

  /// First and second derivative of Φ_q(q + s q̇ + ½ s² q̈, t + s)ᵀ χ with respect to s at s = 0.
  /// They are forward differences because drives need not be defined before the start of the
  /// motion.
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

  /// Restores the mesh that the body had before the change.
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
  const MotionSettings& motion_;
  AlphaScheme scheme_;
  Workspace* model_ = nullptr;
  std::vector<Swept> all_;
  VectorXd psi_, chi_;
  int factorizations_ = 0, iterations_ = 0;
};

}  // namespace flexmorph::fem
