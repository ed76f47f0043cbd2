#pragma once

#include <Eigen/SparseLU>

#include "fem/solve/block_determinants.h"
#include "fem/solve/diagnosis.h"

namespace flexmorph::fem {

/// Step sizes and limits of Kinematics.
struct KinematicsSettings {
  double largest_step = 0.1;  ///< Largest substep [s].
  /// Smallest substep [s]; where it is not small enough the path ends, and this is the accuracy of
  /// the reported time.
  double smallest_step = 1e-7;
  /// Largest allowed ratio of the correction of a predicted position to the predicted motion or,
  /// where that is larger, to a fifth of the model's size.
  double correction = 0.1;
  /// Number of substeps, rejected ones included, after which at() throws.
  int most_steps = 1'000'000'000;
};

/// Motion of a mechanism that is determined by its joints and drives. With as many independent rows
/// as unknowns it solves
///
///   Φ(q, t) = 0,   Φ_q v = -Φ_t,   Φ_q a = right side of the accelerations,
///
/// the positions by Newton's method from q + h v + ½ h² a, up to round-off (1e-12 of the model's
/// size), the rates with the factors at the same q. A substep is halved where Newton's method does
/// not converge, where it corrects the prediction too much, and where the sign of the determinant
/// of a block of Φ_q changes (BlockDeterminants). Therefore the path stays on its branch, and it
/// ends at a singular position (dead centre, change point). A determinant that touches zero between
/// two substeps without a change of sign is not detected.
///
/// Redundant rows are left out of the equations and checked at every time. They are chosen as in
/// fem/solve/redundancy.h, and they determine the branch after a singular position of the other
/// rows, which the path passes with a short substep.
class Kinematics {
 public:
  /// Assembles the start (fem/solve/assembly.h); the model must outlive this object.
  /// @throws Error (input) naming the joints, when degrees of freedom remain or rows contradict
  ///     each other; Error (numerical) when the start cannot be assembled.
  Kinematics(Workspace& model, State start, const KinematicsSettings& settings = {});

  /// Returns q, v and a at time t, which may be later or earlier than the time of the last call; λ
  /// is zero.
  /// @throws Error (numerical) "path cannot be reached at t = ..." naming the joints that block the
  ///     motion; the time is accurate to smallest_step, and the last state before it is kept.
  const State& at(double t);
  /// Follows the path to time t like at(), but stops when the total number of substeps reaches
  /// most_steps.
  /// @returns true if time t was reached.
  bool follow(double t, int most_steps);

  /// Returns the last state that was found.
  const State& state() const { return x_; }
  /// Returns the number of substeps tried so far, rejected ones included.
  int n_steps() const { return n_steps_; }

 private:
  /// Makes a step to time t; returns false, with x_ unchanged, when the step is rejected.
  bool step_to(double t);
  void choose_rows();
  bool newton(State& x);
  /// Returns true if no block comes to another branch, or near one, on the way from the last state,
  /// except for blocks with redundant rows in a short step. The factors of `end` exist before and,
  /// if true is returned, after the call.
  bool stays_on_branch(const State& end);
  bool factorize(const State& x);
  void solve(const VectorXd& right, VectorXd& out) const;
  void find_rates(State& x);
  /// Throws the error of a path that ends between the last state and the given time.
  [[noreturn]] void give_up(double refused);

  Workspace& model_;
  KinematicsSettings settings_;
  State x_, trial_, middle_;
  int n_steps_ = 0;
  BlockDeterminants blocks_;
  std::vector<Determinant> determinants_;  // of the blocks, on this branch
  std::vector<char> has_redundant_;        // for every block
  double size_ = 1;                        // size of the model [m]
  // row in the square matrix of every constraint row; -1: left out
  std::vector<int> index_of_row_;
  ScaledConstraints rows_;
  SparseMatrix square_;
  Eigen::SparseLU<SparseMatrix> lu_;
  std::vector<Eigen::Triplet<double>> entries_;
  mutable VectorXd right_;
  VectorXd correction_;
};

}  // namespace flexmorph::fem
