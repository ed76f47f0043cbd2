#pragma once

#include <Eigen/SparseCholesky>

#include "fem/solve/scaled_constraints.h"

namespace flexmorph::fem {

/// Joints whose rows hold the same freedom: a smallest dependent set, without any one of them the
/// others are independent.
struct DependentGroup {
  /// Those that take part, in the order of the model; without those that belong to a body.
  std::vector<std::string> joints;
  std::vector<int> rows;  ///< all their rows that do
  int surplus = 0;        ///< rows of the group that say nothing new

  /// What the rows miss each other by, as Σ z Φ with the null vector z (largest entry 1) of the
  /// scaled rows: positions [m], rates [m/s], accelerations [m/s²]; the largest of the group. 0
  /// where it is round-off: of what is added up, or 1e-10 of the model's size (per s, per s²).
  double miss = 0, rate_miss = 0, acceleration_miss = 0;
  /// redundant (false): all three combine to zero, one joint may go; or contradictory.
  bool contradictory = false;
};

struct Diagnosis {
  int unknowns = 0, constraints = 0;
  int rank = 0;                  ///< of Φ_q
  std::vector<int> independent;  ///< rows that span all others (rank), ascending
  std::vector<DependentGroup> groups;

  /// Freedoms left: unknowns minus rank. Slopes of plates count like positions.
  int degrees_of_freedom() const { return unknowns - rank; }
  bool is_independent() const { return rank == constraints; }
  bool is_contradictory() const;
  /// Says whether rows of a group miss each other in position.
  bool misses_positions() const;
};

/// Rank of Φ_q at a state, and which joints depend on each other. Columns are scaled to
/// displacements, rows to unit size (ScaledConstraints); a row is dependent when less than 1e-9 of
/// it is new. Sparse QR factor of Φ_qᵀ; the null vectors follow from its triangle: one for every
/// dependent row, with no more rows than needed to span it, then shortened against each other.
///
/// A dependence that exists at this one position only (a dead centre) cannot be told from one that
/// stays; neither can rows be called contradictory by their values where the mechanism is not
/// assembled and Φ not linear: assemble() first.
///
/// @throws Error (numerical) when Φ or Φ_q hold numbers that are not finite.
Diagnosis diagnose(Workspace& model, const State& x);

/// Unknowns minus the rank of Φ_q.
int degrees_of_freedom(Workspace& model, const State& x);

/// One line per group: "joints 'pin', 'drive' hold the same freedom"; or "joints ... contradict
/// each other: they miss by 0.012 m"; contradictions first, ten lines at most. Empty where all rows
/// are independent.
std::string describe(const Diagnosis& diagnosis);

/// @throws Error (input) with that text when rows are dependent.
void require_independent(const Diagnosis& diagnosis);

/// How near the rows of Φ_q are to dependence.
struct Conditioning {
  double t = 0;
  double condition = 1;             ///< σ_max / σ_min of the scaled Φ_q; without joints 1
  std::vector<std::string> joints;  ///< of the nearly dependent rows, those that weigh most first
};

/// Watches the constraints of a model in motion. Cheap: one factor of Φ_q Φ_qᵀ (constraints only,
/// sparse) and a few solves; pattern and work space are kept.
///
/// σ_min by inverse iteration, σ_max by power iteration on Φ_q Φ_qᵀ: both are approached from
/// inside, so the condition is never overestimated. It saturates at about 1e7, because the squared
/// matrix is shifted by 1e-14 to keep its factor.
class ConstraintWatch {
 public:
  explicit ConstraintWatch(Workspace& model) : model_(model) {}
  /// @throws Error (numerical) when Φ_q holds numbers that are not finite.
  Conditioning look(const State& x);

 private:
  Workspace& model_;
  ScaledConstraints rows_;
  int version_ = -1;  // of the model's pattern
  SparseMatrix gram_;
  Eigen::SimplicialLDLT<SparseMatrix> factor_;
  VectorXd z_, previous_;
};

/// The condition alone.
double constraint_condition(Workspace& model, const State& x);

/// "constraints are nearly dependent at t = 0.35 s: condition 2.1e+07, joints 'a', 'b'".
std::string describe(const Conditioning& conditioning);

}  // namespace flexmorph::fem
