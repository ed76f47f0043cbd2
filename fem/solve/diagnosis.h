#pragma once

#include <Eigen/SparseCholesky>

#include "fem/solve/scaled_constraints.h"

namespace flexmorph::fem {

/// A smallest set of joints whose constraint rows depend on each other: without any one of the
/// joints, the rows of the remaining ones are independent.
struct DependentGroup {
  /// Names of the joints in the group, in the order of the model. Joints that belong to a body are
  /// left out.
  std::vector<std::string> joints;
  std::vector<int> rows;  ///< Numbers of all constraint rows of the group, ascending.
  int surplus = 0;        ///< Number of redundant rows in the group.

  /// Inconsistency of the rows, |Σ z Φ| with the null vector z (largest entry 1) of the scaled
  /// rows, for positions [m], rates [m/s] and accelerations [m/s²]; the largest of the group. It is
  /// 0 where it is round-off, relative to the sum of the absolute terms or to 1e-10 of the model's
  /// size (per s, per s²).
  double miss = 0, rate_miss = 0, acceleration_miss = 0;
  /// True if the rows contradict each other; false if they are redundant: the positions, rates and
  /// accelerations all combine to zero, so that one joint can be removed.
  bool contradictory = false;
};

/// Rank of the constraint Jacobian and the groups of joints that depend on each other.
struct Diagnosis {
  /// Numbers of unknowns and of constraint rows.
  int unknowns = 0, constraints = 0;
  int rank = 0;                  ///< Rank of Φ_q.
  std::vector<int> independent;  ///< Rows that span all rows (rank), ascending.
  /// Groups of dependent joints; empty if all rows are independent.
  std::vector<DependentGroup> groups;

  /// Returns the number of remaining degrees of freedom, unknowns minus rank. Position gradients
  /// (slopes) of plates count like positions.
  int degrees_of_freedom() const { return unknowns - rank; }
  /// Returns true if no row depends on other rows.
  bool is_independent() const { return rank == constraints; }
  /// Returns true if the rows of a group contradict each other.
  bool is_contradictory() const;
  /// Returns true if the rows of a group are inconsistent in position.
  bool misses_positions() const;
};

/// Determines the rank of Φ_q at a state, and which joints depend on each other.
///
/// Columns are scaled to displacements, rows to unit size (ScaledConstraints). A row is dependent
/// if less than 1e-9 of it is linearly independent of the other rows. The rank follows from a
/// sparse QR factorization of Φ_qᵀ, and the null vectors from its triangle: one for every dependent
/// row, with only the rows that span it. Then null vectors are combined so that they involve fewer
/// joints.
///
/// A dependence that exists at this position only (a dead centre) cannot be distinguished from a
/// permanent one. Where the mechanism is not assembled and Φ is not linear, the values of the rows
/// do not show whether they are contradictory; call assemble() first.
///
/// @throws Error (numerical) when Φ or Φ_q contain numbers that are not finite.
Diagnosis diagnose(Workspace& model, const State& x);

/// Returns the rows of J (ScaledConstraints) without those that no others can span: rows with an
/// entry in a column that no other row has, then rows for which this holds without the removed
/// ones, and so on. A null vector is zero in the removed rows. Welded edges and open chains consist
/// of such rows; the remaining rows (ascending) belong to closed loops.
std::vector<int> entangled_rows(const SparseMatrix& j);

/// Returns the number of unknowns minus the rank of Φ_q.
int degrees_of_freedom(Workspace& model, const State& x);

/// Returns a text with one line per group: "joints 'pin', 'drive' hold the same degree of freedom"
/// or "joints
/// ... contradict each other: their error is 0.012 m". Contradictions come first, and name the last
/// joint of the model first. The text has at
/// most ten groups. It is empty if all rows are independent.
std::string describe(const Diagnosis& diagnosis);

/// Measure of how close the rows of Φ_q are to linear dependence.
struct Conditioning {
  double t = 0;          ///< Time of the state [s].
  double condition = 1;  ///< Ratio σ_max / σ_min of the scaled Φ_q; 1 without joints.
  /// Names of the joints whose rows are nearly dependent, the largest weight first.
  std::vector<std::string> joints;
};

/// Monitors the conditioning of a model's constraints during a motion. An evaluation is cheap: one
/// factorization of Φ_q Φ_qᵀ (constraints only, sparse) and a few solutions; pattern and work space
/// are kept.
///
/// σ_min follows from inverse iteration, σ_max from power iteration on Φ_q Φ_qᵀ. Both are
/// approached from inside the spectrum, so that the condition is never overestimated. It saturates
/// at about 1e7, because the matrix Φ_q Φ_qᵀ is shifted by 1e-14 to keep it factorizable.
class ConstraintWatch {
 public:
  /// Creates the monitor of a model, which must outlive it.
  explicit ConstraintWatch(Workspace& model) : model_(model) {}
  /// Computes the conditioning of the constraints at a state.
  /// @throws Error (numerical) when Φ_q contains numbers that are not finite.
  Conditioning look(const State& x);

 private:
  Workspace& model_;
  ScaledConstraints rows_;
  int version_ = -1;  // pattern version of the model at the last analysis
  SparseMatrix gram_;
  Eigen::SimplicialLDLT<SparseMatrix> factor_;
  VectorXd z_, previous_;
};

/// Returns the condition number of the constraints, see ConstraintWatch.
double constraint_condition(Workspace& model, const State& x);

/// Returns the message "constraints are nearly dependent at t = 0.35 s: condition 2.1e+07, joints
/// 'a', 'b'".
std::string describe(const Conditioning& conditioning);

}  // namespace flexmorph::fem
