#pragma once

#include "fem/model/workspace.h"
#include "fem/solve/linear_solver.h"

namespace flexmorph::fem {

/// Interpolation of the motion within a step of an integrator, at times at which no step ends.
///
///   - q(t) is the quintic polynomial through q, q̇, q̈ at both ends. It adds an error of O(h⁶) to
///     the errors of the ends.
///   - Then q is projected onto Φ(q, t) = 0 and q̇ onto Φ_q q̇ + Φ_t = 0, with the smallest change
///     in the mass norm. q̈ and λ follow from the equations of motion with Φ̈ = 0.
///
/// Therefore the state is consistent and its loads are in balance. Unknowns of nodes on moving
/// material lines are interpolated like all others; therefore the mesh must not change within the
/// step. Frequencies that the step does not resolve (above 1/h) are not resolved by the
/// interpolation either, and appear in q̈.
///
/// The class has its own matrix and factorization and does not affect those of an integrator.
class DenseOutput {
 public:
  /// Creates an interpolation for a model, which must outlive it.
  explicit DenseOutput(Workspace& model) : model_(model) {}

  /// Sets the states at the two ends of the step; both must outlive the calls of at().
  void set_step(const State& start, const State& end) { start_ = &start, end_ = &end; }

  /// Computes the state at a time within the step.
  /// @throws Error (numerical) if the projection does not converge.
  void at(double t, State& out);
  /// Saves or restores the matrix and its factorization (geometry/archive.h).
  void archive(Archive& memory);

 private:
  void interpolate(double t, State& out) const;
  void project_position(State& x);
  void factorize(const State& x);
  /// Solves for solution_ with the right side (force_, constraint).
  void solve(const VectorXd& constraint);

  Workspace& model_;
  const State* start_ = nullptr;
  const State* end_ = nullptr;
  DirectSolver solver_;
  SparseMatrix kkt_;
  int version_ = -1;  // pattern version of the model
  VectorXd scales_;
  Constraints constraints_;
  VectorXd force_, miss_, right_, solution_;
};

}  // namespace flexmorph::fem
