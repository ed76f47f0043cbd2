#pragma once

#include "fem/model/workspace.h"
#include "fem/solve/linear_solver.h"

namespace flexmorph::fem {

/// The motion within a step of an integrator, at times that no step landed on.
///
///   q(t)   the quintic that takes q, q̇, q̈ of both ends: misses by O(h⁶) more than they do
///   then   q moved onto Φ(q, t) = 0 and q̇ onto Φ_q q̇ + Φ_t = 0, by the nearest way in the mass
///          norm; q̈ and λ from the equations of motion with Φ̈ = 0
///
/// so that the state is consistent and its loads are in balance. Unknowns of nodes on moving
/// material lines are interpolated as any others: the mesh must not change within the step. What
/// the step does not resolve (frequencies above 1/h) is not resolved here either, and shows in q̈.
///
/// Has its own matrix and factors: those that an integrator keeps stay what they are.
class DenseOutput {
 public:
  explicit DenseOutput(Workspace& model) : model_(model) {}

  /// The ends of the step; both must outlive the calls of at().
  void set_step(const State& start, const State& end) { start_ = &start, end_ = &end; }

  /// The state at a time within the step.
  /// @throws Error (numerical) when the projection does not converge.
  void at(double t, State& out);
  void remember(Memory& memory);

 private:
  void interpolate(double t, State& out) const;
  void project_position(State& x);
  void factorize(const State& x);
  /// solution_ from force_ and constraint.
  void solve(const VectorXd& constraint);

  Workspace& model_;
  const State* start_ = nullptr;
  const State* end_ = nullptr;
  UnsymmetricSolver solver_;
  SparseMatrix kkt_;
  int version_ = -1;  // of the model's pattern
  VectorXd scales_;
  Constraints constraints_;
  VectorXd force_, miss_, right_, solution_;
};

}  // namespace flexmorph::fem
