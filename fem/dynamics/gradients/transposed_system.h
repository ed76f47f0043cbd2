#pragma once

#include <vector>

#include "fem/dynamics/starts/body_turns.h"
#include "fem/model/workspace.h"
#include "fem/solve/linear_solver.h"
#include "fem/solve/statics.h"

namespace flexmorph::fem {

/// Solver for the transposed iteration matrices of a motion, at one state after the other:
///
///   J = [ scale (w.q (F + Φ_qᵀ λ)_q + w.v F_v + w.a M)   Φ_qᵀ ]
///       [ Φ_q                                            0    ]
///
/// A factorization is reused for later matrices and is rotated with the bodies: in axes that rotate
/// with a body its matrix does not change, J' = R J Rᵀ except for strains, constraints and moving
/// lines. GMRES (Saad, Schultz 1986) with the rotated factorization removes the remaining error, so
/// that the solution belongs to the matrix that was set last.
class TransposedSystem {
 public:
  /// Creates a solver for the matrices of a model, which must outlive it.
  explicit TransposedSystem(Workspace& model) : model_(model) {}

  /// Assembles J at state x. The accelerations of x are not used because the forces are linear in
  /// them.
  /// @param spin  ω² of every unknown, whose M ω² is subtracted (n_dofs), or empty.
  void set(const State& x, const Weights& w, double scale, const VectorXd& spin = {});
  /// Assembles the matrix of solve_steady_equilibrium() at its solution x.
  void set_carried(const State& x, std::span<const Turning> turning);

  /// Solves Jᵀ (ψ, χ) = (seed, rows).
  /// @param seed  Right side of the unknowns (n_dofs).
  /// @param rows  Right side of the constraints (n_constraints).
  /// @throws Error (numerical) if J is singular.
  void solve(const VectorXd& seed, const VectorXd& rows, VectorXd& psi, VectorXd& chi);

  /// Returns F_vᵀ ψ at state x (n_dofs).
  VectorXd by_velocity(const State& x, const VectorXd& psi);
  /// Returns Mᵀ ψ at state x (n_dofs).
  VectorXd by_acceleration(const State& x, const VectorXd& psi);
  /// Returns (F + Φ_qᵀ λ)_qᵀ ψ at state x (n_dofs).
  VectorXd by_position(const State& x, const VectorXd& psi);
  /// Returns the constraints at the state of the last set().
  const Constraints& constraints() const { return constraints_; }
  /// Returns Φ_qᵀ χ at the state of the last set() (n_dofs).
  VectorXd by_rows(const VectorXd& chi) const;

  /// Returns the number of factorizations so far.
  int factorizations() const { return factorizations_; }
  /// Returns the number of GMRES iterations so far.
  int iterations() const { return iterations_; }

 private:
  static constexpr int kMaxDirections = 12;

  void take(const State& x, const Weights& w);
  VectorXd part(const State& x, const Weights& w, const VectorXd& psi);
  void reserve_memory();
  void factorize();
  bool improve(double left, double aim, bool fresh);
  void solve_kept(const VectorXd& right, VectorXd& out);
  void renew();
  void turn(VectorXd& x, bool back) const;

  Workspace& model_;
  DirectSolver solver_;
  Constraints constraints_;
  SparseMatrix matrix_, factored_, mass_;
  VectorXd scales_, right_, rest_, found_, last_;
  VectorXd q_;                          // positions at the last set()
  Weights weights_, factored_weights_;  // of the matrix and of the factorization
  BodyTurns turns_;                     // rotations since the last factorization
  std::vector<TurnedVectors> turned_;   // rotations that the solver does not apply itself
  // GMRES: an orthonormal basis of residuals, and the directions whose images span it.
  MatrixXd basis_, directions_;
  VectorXd image_, turning_, solution_;
  int version_ = -1;
  bool is_factored_ = false;
  int factorizations_ = 0, iterations_ = 0;
};

}  // namespace flexmorph::fem
