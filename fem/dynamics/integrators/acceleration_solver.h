#pragma once

#include <optional>

#include "fem/model/workspace.h"
#include "fem/solve/factorization/klu_solver.h"
#include "fem/solve/linear_solver.h"

namespace flexmorph::fem {

/// Solver for the accelerations and multipliers that satisfy the equations of motion and the
/// constraints,
///
///   [ M    Φ_qᵀ ] [ q̈ ]   [ f ]
///   [ Φ_q  0    ] [ λ ] = [ γ ].
///
/// The unknowns are scaled by the roots of the diagonal of M, and the rows of Φ_q to unit size. M
/// may be singular if the constraints hold all unknowns without mass. M is assembled only once if
/// no material flows, and the factorization is reused as long as M and Φ_q do not change.
class AccelerationSolver {
 public:
  /// Creates a solver for a model, which must outlive it.
  explicit AccelerationSolver(Workspace& model) : model_(model) {}

  /// Discards the stored mass matrix, so that the next factorize() assembles it: to be called after
  /// a change of the scale factors of the design.
  void forget() { version_ = -1; }
  /// Factors the matrix at state x with its constraints c.
  /// @throws Error (input) naming the bodies whose unknowns have no mass and are not constrained;
  /// Error (numerical) if the matrix is singular for another reason, or not finite.
  void factorize(const State& x, const Constraints& c);
  /// Solves for the accelerations a (n) and the multipliers lambda (m) with the last factorization.
  /// @param force       Right side f of the equations of motion (n).
  /// @param constraint  Right side γ of the constraints (m).
  /// @throws Error (numerical) if the solution is not finite.
  void solve(const VectorXd& force, const VectorXd& constraint, VectorXd& a, VectorXd& lambda);
  /// Returns the number of factorizations so far.
  int factorizations() const { return factorizations_; }
  /// Saves or restores the state of the solver (geometry/archive.h).
  void archive(Archive& memory);
  /// Returns condition_estimate() of the matrix of the last factorize(); nothing before the first
  /// one.
  std::optional<double> condition() const;

 private:
  void number(const State& x, const Constraints& c);
  void require_mass() const;

  Workspace& model_;
  int version_ = -1;  // pattern version of the model
  bool mass_moves_ = false, is_factored_ = false, is_small_ = true;
  SparseMatrix kkt_;                // scaled matrix
  VectorXd scale_;                  // scales of rows and columns (n + m)
  VectorXd weights_;                // scale of row times scale of column, for every entry
  std::vector<int> value_indices_;  // indices of the triplets of Φ_q, below and above the diagonal
  VectorXd factored_;               // values of the triplets at the last factorization
  KluSolver small_;
  DirectSolver large_;
  VectorXd right_, solution_;
  int factorizations_ = 0;
};

}  // namespace flexmorph::fem
