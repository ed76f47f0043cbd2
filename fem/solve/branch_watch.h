#pragma once

#include "fem/solve/block_determinants.h"
#include "fem/solve/scaled_constraints.h"

namespace flexmorph::fem {

/// A group of joints that comes to another branch, or near one, in a step.
struct OtherBranch {
  /// Names of the joints of the group; empty if the branch is the same.
  std::vector<std::string> joints;
  /// True if the drives and the joints of the group determine its motion, and no joint of the group
  /// is redundant. Then a position where branches meet cannot be passed.
  bool is_determined = false;

  /// Returns true if there is such a group.
  explicit operator bool() const { return !joints.empty(); }
};

/// Monitors on which branch the closed loops of rigid bodies are.
///
/// A loop of rigid bodies can be assembled in several ways (branches). Two branches that meet or
/// come near each other are separated by positions where Φ_qd, the Jacobian by the dependent
/// unknowns of the loop, is singular. Therefore the determinant of a block of Φ_qd
/// (BlockDeterminants) changes its sign or almost vanishes in a step that comes to another branch
/// or near one (block_near_other_branch()). The dependent unknowns are those of a QR factorization
/// with column pivoting at the start of a step. They are kept as long as the determinants do not
/// fall below a third of their first values, so that the sign cannot change because of the choice
/// unless bodies turn by more than about 70 degrees in one step.
///
/// Loops that include plates or beams are not monitored, because these resist a change of the
/// branch; models with more than 400 rows in loops of rigid bodies are not monitored either.
class BranchWatch {
 public:
  /// Creates the monitor of a model, which must outlive it.
  explicit BranchWatch(Workspace& model) : model_(model) {}
  /// Stores the branch of the accepted state from which the next step starts.
  void begin(const State& x);
  /// Compares the positions q at time t, the end of a step, with the stored branch.
  OtherBranch compare(const VectorXd& q, double t);
  /// Returns the reason why a step to positions q at time t must not be accepted: a loop comes to
  /// another branch or near one, or joints that the model leaves out are violated
  /// (left_out_miss()). The text is empty if the step can be accepted.
  ///
  /// Where branches meet, the sign of a determinant changes in any step, however short. A motion
  /// that drives do not determine passes such a position by its inertia, and redundant joints can
  /// determine the branch after it.
  /// @param is_short  True for a step that is so short that it distinguishes branches that only
  /// come
  ///                  near each other. It may then pass such a position.
  std::string refusal(const VectorXd& q, double t, bool is_short);

 private:
  void choose(const State& x);
  std::vector<Determinant> determinants();
  std::vector<Determinant> determinants_at(const VectorXd& q, double t);

  Workspace& model_;
  ScaledConstraints rows_;
  int version_ = -1;  // pattern version of the model at the last choice
  std::vector<int> loop_rows_;
  std::vector<int> index_of_row_, index_of_column_;  // in matrix_; -1: not in it
  bool is_square_ = false;                           // true if no unknown of the loops is free
  SparseMatrix matrix_;
  std::vector<Eigen::Triplet<double>> entries_;
  BlockDeterminants blocks_;
  std::vector<Determinant> chosen_, start_, end_;  // at the choice, and at both ends of the step
  double start_t_ = 0, end_t_ = 0;
  VectorXd start_q_, end_q_;
  State at_;
};

}  // namespace flexmorph::fem
