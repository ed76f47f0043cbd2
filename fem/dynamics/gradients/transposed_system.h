#pragma once

#include <vector>

#include "fem/dynamics/starts/body_turns.h"
#include "fem/model/workspace.h"
#include "fem/solve/linear_solver.h"
#include "fem/solve/statics.h"

namespace flexmorph::fem {

/// The iteration matrices of a motion, transposed, at one state after the other:
///
///   J = [ scale (w.q (F + Φ_qᵀ λ)_q + w.v F_v + w.a M)   Φ_qᵀ ]
///       [ Φ_q                                            0    ]
///
/// A factor is kept for later matrices, and turned with the bodies: rotated bodies have the same
/// matrix in axes that rotate with them, J' = R J Rᵀ but for strains, constraints and moving lines.
/// What it leaves is found by the residual's smallest combination over all solutions with it
/// (GMRES; Saad, Schultz 1986), which meets the matrix that was set last.
class TransposedSystem {
 public:
  /// @param model  lives longer
  explicit TransposedSystem(Workspace& model) : model_(model) {}

  /// Puts J at x together. Accelerations are not looked at: forces are linear in them.
  /// @param spin  ω² of every unknown, whose M ω² is taken off (n_dofs), or empty
  void set(const State& x, const Weights& w, double scale, const VectorXd& spin = {});
  /// Puts the matrix of solve_steady_equilibrium() at its x together.
  void set_carried(const State& x, std::span<const Turning> turning);

  /// Jᵀ (ψ, χ) = (seed, rows).
  /// @param seed  (n_dofs)   @param rows  (n_constraints)
  /// @throws Error (numerical) where J is singular.
  void solve(const VectorXd& seed, const VectorXd& rows, VectorXd& psi, VectorXd& chi);

  /// F_vᵀ ψ and Mᵀ ψ at the last set().
  VectorXd by_velocity(const State& x, const VectorXd& psi);
  VectorXd by_acceleration(const State& x, const VectorXd& psi);
  /// (F + Φ_qᵀ λ)_qᵀ ψ there.
  VectorXd by_position(const State& x, const VectorXd& psi);
  const Constraints& constraints() const { return constraints_; }
  /// Φ_qᵀ χ there.
  VectorXd by_rows(const VectorXd& chi) const;

  int factorizations() const { return factorizations_; }
  int iterations() const { return iterations_; }

 private:
  static constexpr int kMostDirections = 12;

  void take(const State& x, const Weights& w);
  VectorXd part(const State& x, const Weights& w, const VectorXd& psi);
  void make_room();
  void factorize();
  bool improve(double left, double aim, bool fresh);
  void solve_kept(const VectorXd& right, VectorXd& out);
  void renew();
  void turn(VectorXd& x, bool back) const;

  Workspace& model_;
  UnsymmetricSolver solver_;
  Constraints constraints_;
  SparseMatrix matrix_, factored_, mass_;
  VectorXd scales_, right_, rest_, found_, last_;
  VectorXd q_;                          // where it was set
  Weights weights_, factored_weights_;  // as of what
  BodyTurns turns_;                     // since the last factorization,
  std::vector<TurnedVectors> turned_;   // as vectors turn that the solver does not turn itself
  // GMRES: an orthonormal basis of residuals, directions whose images they are.
  MatrixXd basis_, directions_;
  VectorXd image_, turning_, solution_;
  int version_ = -1;
  bool is_factored_ = false;
  int factorizations_ = 0, iterations_ = 0;
};

}  // namespace flexmorph::fem
