#pragma once

#include "fem/dynamics/integrators/integrator.h"
#include "fem/dynamics/starts/body_turns.h"
#include "fem/solve/branch_watch.h"
#include "fem/solve/linear_solver.h"

namespace flexmorph::fem {

/// Base class of implicit one-step integrators of index-3 equations. It provides the scaling of
/// unknowns and equations, a tangent that is kept as long as it contracts, Newton's method, and the
/// halving of steps that fail. The virtual functions below define the scheme.
///
/// A step fails, too, if it ends on another branch of the joints: if loops of rigid bodies are on
/// another branch (BranchWatch), if Newton's method moves rigid bodies by more than a tenth of the
/// predicted motion (or of a fifth of the model's size, if this is larger), or if redundant joints
/// that are left out (Model::leave_out()) are violated.
///
/// Slopes (position gradients) are scaled by the element size, and constraints and multipliers by
/// scale() of the step. Then the condition of the iteration matrix does not depend on h (Bottasso,
/// Dopico & Trainelli 2008).
class StepSolver : public Integrator {
 public:
  void make_consistent(State& x) final;
  void project_velocity(State& x) final;
  VectorXd balance(State& x, double frequency) final;
  void advance(State& x, double t_end, const std::function<void(const State&)>& accepted) final;
  TriedStep try_step(State& x, double h, double allowed) final;
  const StepCounts& counts() const final { return counts_; }
  std::optional<double> condition() const final;
  void archive(Archive& memory) override;

 protected:
  /// Creates the solver for a model, which must outlive it.
  /// @param name    Name of the integrator, with which its messages begin.
  /// @param advice  Sentence with advice for the message of a failed step.
  /// @throws Error (input) if the settings are invalid.
  StepSolver(Workspace& model, const StepSettings& settings, std::string name, std::string advice);

  /// Computes the first guess of the step from x to x.t + h, and stores the data that residual(),
  /// tangent() and correct() need.
  virtual void begin(const State& x, double h) = 0;
  /// Returns the factor of the equations of motion in this step, β h² of the scheme.
  virtual double scale() const = 0;
  /// Computes the residuals of the equations of motion (n_dofs) and of the constraints
  /// (n_constraints) at the iterate.
  virtual void residual(VectorXd& force, VectorXd& constraint) = 0;
  /// Computes the derivative of the residual by (q, λ / scale): [scale · A, Φ_qᵀ; Φ_q, 0]. It is
  /// only called after residual() at the same iterate.
  virtual void tangent(SparseMatrix& out) = 0;
  /// Adds a correction to the iterate.
  /// @param dq       Correction of the unknowns at the end of the step (n_dofs).
  /// @param dlambda  Correction of the multipliers (n_constraints).
  virtual void correct(const VectorXd& dq, const VectorXd& dlambda) = 0;
  /// Computes the entries of the tangent whose row and column are chosen (n_dofs + n_constraints),
  /// and leaves the other entries unchanged.
  /// @returns false, without any change, if the scheme does not provide this.
  virtual bool renew_tangent(const std::vector<char>& /*chosen*/, SparseMatrix& /*out*/) {
    return false;
  }
  /// Returns the positions at the iterate.
  virtual const VectorXd& iterate() const = 0;
  /// Returns the length to which corrections are related in the test of convergence [m].
  virtual double resolved() const { return size_; }
  /// Returns the local error of the converged step that began at x, relative to size(); it is
  /// called before finish().
  /// @throws Error (input) if the scheme has no estimate.
  virtual double local_error(const State& x, double allowed);
  /// Sets x to the end of the converged step.
  virtual void finish(State& x) = 0;
  /// Accepts the step: the variables of the scheme besides the state become those of its end.
  virtual void keep() {}
  /// Sets the variables of the scheme besides the state to those of the state x, which was made
  /// consistent.
  virtual void restart(const State& /*x*/) {}

  /// Solves with the last factorization. The right side is force (n_dofs, times scale()) and
  /// constraint (n_constraints); the solution is dq and μ (λ times scale()).
  void solve_kept(const VectorXd& force, const VectorXd& constraint, VectorXd& dq, VectorXd& mu);

  /// Factors the tangent at the iterate, after residual() at this iterate. The factorization is
  /// kept for steps of size h.
  void factorize_here(double h);

  /// Computes consistent q̈ and λ at x, without a change of the variables of the scheme.
  void solve_accelerations(State& x);

  /// Returns the component P w of a vector w (n_dofs) that joints hold at x:
  /// [M Φ_qᵀ; Φ_q 0] (P w, μ) = (0, Φ_q w).
  VectorXd held_part(const State& x, const VectorXd& w);

  /// Computes the scales of the present mesh, which displacement() and size() use. Time steps call
  /// this function themselves.
  void set_scales();
  /// Returns the work space of the model.
  Workspace& model() { return model_; }
  /// Returns the largest displacement that belongs to a change of the unknowns [m].
  double displacement(const VectorXd& dq) const {
    return dq.cwiseProduct(scales_).lpNorm<Eigen::Infinity>();
  }
  /// Returns the largest coordinate of the undeformed model [m]; for rigid bodies alone their
  /// largest length.
  double size() const { return size_; }

 private:
  /// Solves one step. x becomes its end if the step converged with an allowed local error
  /// (infinite: any error is allowed, and it is not estimated).
  TriedStep solve_step(State& x, double h, double allowed);
  /// Solves the equations of the step by Newton's method. @returns true if it converged.
  bool newton(double h);
  /// Returns true if there is a factorization for steps of size h and the present mesh.
  bool is_kept(double h) const;
  /// Updates a kept factorization that has a border: the border is computed again at the iterate,
  /// and the remaining factor is rotated with the bodies.
  void renew_border();
  /// Scales the entries of kkt_ among the chosen unknowns (empty: all), such that unknowns become
  /// displacements and equations become virtual work on them.
  void scale_kkt(const std::vector<char>& chosen);
  /// Returns true if the converged step from x to x.t + h stays on the branch of x; otherwise
  /// history_ and failure_ have the reason.
  bool stays_on_branch(const State& x, double h);
  /// Calls finish() for a converged step. Returns false and leaves x unchanged if Newton's method
  /// has converged to a solution with material turned inside out. Only steps with large corrections
  /// can find such a solution; therefore other steps are not checked.
  bool finish_sound(State& x);
  /// Throws the error of a step h from x that failed repeatedly.
  [[noreturn]] void give_up(const State& x, double h, int failures) const;
  /// Solves [M Φ_qᵀ; Φ_q 0] solution_ = (force, constraint) at x; solution_ stays scaled.
  void solve_mass(const State& x, const VectorXd& force, const VectorXd& constraint);
  /// Factors kkt_ after scaling it, see DirectSolver::factorize() for `miss`.
  void factorize(double miss);

  Workspace& model_;
  StepSettings settings_;
  std::string name_, advice_;
  StepCounts counts_;
  DirectSolver solver_;
  SparseMatrix kkt_;
  int analysed_version_ = -1;
  double largest_correction_ = 0;  // in the last newton(), relative to size_
  State before_;                   // start of a step that finish_sound() checks
  BodyTurns turns_;                // rotations since the last factorize_here()
  double factored_h_ = 0;          // step size of the kept factorization; 0: none
  VectorXd scales_;                // displacement per unit of each unknown
  double size_ = 1;
  int scaled_version_ = -1;
  int failures_ = 0;          // consecutive failures of try_step()
  int fresh_iterations_ = 0;  // of the last step, from its first factorization on
  Constraints constraints_;
  VectorXd force_, constraint_, right_, solution_, dq_, mu_;
  std::string history_;  // history of the residuals of the last step
  std::string failure_;  // reason why the last step failed although Newton's method converged
  BranchWatch branch_;
  VectorXd predicted_;           // positions at the end of the step, before Newton's method
  std::vector<int> rigid_dofs_;  // unknowns of rigid bodies
  double crossing_h_ = 0;        // step size below which branches that meet may be passed
};

}  // namespace flexmorph::fem
