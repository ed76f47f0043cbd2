#pragma once

#include <optional>

#include "fem/model/workspace.h"
#include "fem/solve/factorization/klu_solver.h"
#include "fem/solve/linear_solver.h"

namespace flexmorph::fem {

/// Accelerations and multipliers from the equations of motion and the constraints,
///
///   [ M    Φ_qᵀ ] [ q̈ ]   [ f ]
///   [ Φ_q  0    ] [ λ ] = [ γ ]
///
/// with unknowns scaled by the roots of the diagonal of M and rows of Φ_q to unit size. M may be
/// singular where the constraints hold what has no mass. It is assembled once where no material
/// flows, and the factor is kept while M and Φ_q are what they were.
class AccelerationSolver {
 public:
  explicit AccelerationSolver(Workspace& model) : model_(model) {}

  /// Takes the mass anew at the next factorize(): after a change of factors of the design.
  void forget() { version_ = -1; }
  /// Factors at x, with its constraints.
  /// @throws Error (input) naming bodies whose unknowns have no mass where nothing holds them;
  /// Error (numerical) when the matrix is singular for another reason, or not finite.
  void factorize(const State& x, const Constraints& c);
  /// @param force, constraint  f (n) and γ (m)
  void solve(const VectorXd& force, const VectorXd& constraint, VectorXd& a, VectorXd& lambda);
  int factorizations() const { return factorizations_; }
  void remember(Memory& memory);
  /// condition_estimate() of the matrix of the last factorize(); none before.
  std::optional<double> condition() const;

 private:
  void number(const State& x, const Constraints& c);
  void require_mass() const;

  Workspace& model_;
  int version_ = -1;  // of the model's pattern
  bool mass_moves_ = false, is_factored_ = false, is_small_ = true;
  SparseMatrix kkt_;         // scaled
  VectorXd scale_;           // of rows and columns (n + m)
  VectorXd weights_;         // product of both for every entry of the matrix
  std::vector<int> places_;  // of the triplets of Φ_q, below and above the diagonal
  VectorXd factored_;        // values of the triplets that the factor belongs to
  KluSolver small_;
  UnsymmetricSolver large_;
  VectorXd right_, solution_;
  int factorizations_ = 0;
};

}  // namespace flexmorph::fem
