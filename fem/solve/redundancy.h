#pragma once

#include "fem/solve/diagnosis.h"

/// Redundant joints that are consistent with the other joints, such as a second coupling rod of
/// wheels.
///
/// A model leaves out as many of their rows as are redundant (Model::leave_out()), so that the
/// remaining rows are independent. The rows that are left out must be met by the solution; this is
/// checked after every step (left_out_miss()). The forces of redundant joints are not unique.
namespace flexmorph::fem {

/// Finds the redundant rows of a model at an assembled state and leaves them out of the model.
/// Nothing changes if all rows are independent.
///
/// Rows that are dependent at this position only (dead centre, position where branches meet) are
/// not redundant. They are recognised by the rank of Φ_q at neighbouring positions, a little later
/// and after small changes of the positions.
/// @throws Error (input) naming the joints if rows contradict each other, or if rows depend on each
///     other only at this position.
void leave_out_redundant(Workspace& model, const State& x);

/// Chooses again which of the redundant rows are left out, at an assembled state, if the kept rows
/// have become ill conditioned. The kept rows are the first pivots of a QR factorization of the
/// redundant rows of J (ScaledConstraints) with pivoting. Multipliers of rows that are newly left
/// out become 0.
void renew_left_out(Workspace& model, State& x);

/// Returns, of all multipliers (n_constraints) that have the same force Φ_qᵀ λ on every unknown as
/// those of x, the multipliers with the least sum of squares of the scaled rows of joints,
/// Σ (λ_i / R_i)². Rows that belong to a body do not count.
VectorXd least_multipliers(Workspace& model, const State& x);

/// Returns the names of the joints with redundant rows, whose forces are not unique, in the order
/// of the model; joints that belong to a body are left out.
std::vector<std::string> redundant_joints(const Model& model);

/// Violation of the rows that a model leaves out.
struct LeftOutMiss {
  double miss = 0;        ///< Largest violation [m].
  std::string joint;      ///< Name of the joint with the largest violation; empty if there is none.
  bool is_large = false;  ///< True if the violation is above 1e-8 of the size of the model.
};

/// Returns the violation of the rows that a model leaves out, at positions q and time t.
LeftOutMiss left_out_miss(Workspace& model, const VectorXd& q, double t);

}  // namespace flexmorph::fem
