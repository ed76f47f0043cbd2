#pragma once

#include "fem/dynamics/integrators/integrator.h"
#include "fem/dynamics/starts/body_turns.h"
#include "fem/solve/linear_solver.h"

namespace flexmorph::fem {

/// What implicit one-step integrators of index-3 equations share: the scaling of unknowns and
/// equations, the tangent that is kept while it contracts, Newton's method, and the halving of
/// steps that fail. The scheme itself is the five functions below.
///
/// Slopes are scaled by the element size, constraints and multipliers by scale() of the step: the
/// condition of the iteration matrix then does not depend on h (Bottasso, Dopico & Trainelli 2008).
class StepSolver : public Integrator {
 public:
  void make_consistent(State& x) final;
  void project_velocity(State& x) final;
  void advance(State& x, double t_end, const std::function<void(const State&)>& accepted) final;
  TriedStep try_step(State& x, double h, double allowed) final;
  const StepCounts& counts() const final { return counts_; }
  std::optional<double> condition() const final;
  void remember(Memory& memory) override;

 protected:
  /// @throws Error (input) for settings that make no sense.
  StepSolver(Workspace& model, const StepSettings& settings, std::string name, std::string advice);

  /// First guess of the step from x to x.t + h. Keeps what residual(), tangent() and correct()
  /// need.
  virtual void begin(const State& x, double h) = 0;
  /// Factor of the equations of motion of this step, β h² of the scheme.
  virtual double scale() const = 0;
  /// Equations of motion (n_dofs) and constraints (n_constraints) at the iterate.
  virtual void residual(VectorXd& force, VectorXd& constraint) = 0;
  /// Derivative of the residual by (q, λ / scale): [scale · A, Φ_qᵀ; Φ_q, 0]; only called after a
  /// residual() at the same iterate.
  virtual void tangent(SparseMatrix& out) = 0;
  /// @param dq  correction of the unknowns at the end of the step
  virtual void correct(const VectorXd& dq, const VectorXd& dlambda) = 0;
  /// Entries of the tangent whose row and column are chosen (n_dofs + n_constraints), the others
  /// left as they are. @returns false, and nothing is done, of a scheme that cannot.
  virtual bool renew_tangent(const std::vector<char>& /*chosen*/, SparseMatrix& /*out*/) {
    return false;
  }
  /// Positions at the iterate.
  virtual const VectorXd& iterate() const = 0;
  /// What a correction is small against [m].
  virtual double resolved() const { return size_; }
  /// Local error of the converged step that began at x, relative to size(); before finish().
  /// @throws Error (input) where there is no estimate.
  virtual double local_error(const State& x, double allowed);
  /// x becomes the end of the converged step.
  virtual void finish(State& x) = 0;
  /// The step stands: what the next one starts from besides the state is that of its end.
  virtual void keep() {}
  /// x was made consistent: what the next step starts from besides the state begins there.
  virtual void restart(const State& /*x*/) {}

  /// Solves with the factors of the last factorization: force (n_dofs, times scale()) and
  /// constraint (n_constraints) as right side, dq and μ (λ times scale()) as result.
  void solve_kept(const VectorXd& force, const VectorXd& constraint, VectorXd& dq, VectorXd& mu);

  /// Factors of the tangent at the iterate, after a residual() there; kept for steps h.
  void factorize_here(double h);

  /// Consistent q̈ and λ at x; the scheme does not start anew.
  void solve_accelerations(State& x);

  /// What joints hold of a vector w: [M Φ_qᵀ; Φ_q 0] (P w, μ) = (0, Φ_q w) at x.
  VectorXd held_part(const State& x, const VectorXd& w);

  /// Of the model as it is now: displacement() and size() stand on them. Steps do so themselves.
  void set_scales();
  Workspace& model() { return model_; }
  /// Largest displacement that a change of the unknowns means [m].
  double displacement(const VectorXd& dq) const {
    return dq.cwiseProduct(scales_).lpNorm<Eigen::Infinity>();
  }
  /// Largest coordinate of the undeformed model [m]; of rigid bodies alone their largest length.
  double size() const { return size_; }

 private:
  /// One step; x moves where it converged with a local error that is allowed (infinite: any, and
  /// it is not looked at).
  TriedStep solve_step(State& x, double h, double allowed);
  bool newton(double h);
  /// Are there factors for a step h, of the mesh as it is?
  bool is_kept(double h) const;
  /// Where the kept factors have a border, it becomes that of the iterate, and the rest turns with
  /// the bodies.
  void renew_border();
  /// Entries of kkt_ among the chosen (none: all) become those of displacements and work on them.
  void scale_kkt(const std::vector<char>& chosen);
  /// finish() of a converged step; false, and x is what it was, where Newton's method has gone
  /// astray: to a solution with material turned inside out, which only steps find that need large
  /// corrections. Others are not looked at.
  bool finish_sound(State& x);
  [[noreturn]] void give_up(const State& x, double h, int failures) const;
  void solve_mass(const State& x, const VectorXd& force, const VectorXd& constraint);
  void factorize(double miss);  ///< of kkt_; see UnsymmetricSolver

  Workspace& model_;
  StepSettings settings_;
  std::string name_, advice_;
  StepCounts counts_;
  UnsymmetricSolver solver_;
  SparseMatrix kkt_;
  int analysed_version_ = -1;
  double largest_correction_ = 0;  // of the last newton(), relative to size_
  State before_;                   // a step that is looked at
  BodyTurns turns_;                // since the last factorize_here()
  double factored_h_ = 0;          // step the kept factorization belongs to; 0: none
  VectorXd scales_;                // displacement per unit of each unknown
  double size_ = 1;
  int scaled_version_ = -1;
  int failures_ = 0;          // of try_step() in a row
  int fresh_iterations_ = 0;  // of the last step, since its first factorization
  Constraints constraints_;
  VectorXd force_, constraint_, right_, solution_, dq_, mu_;
  std::string history_;  // of the residuals of the last failed step
};

}  // namespace flexmorph::fem
