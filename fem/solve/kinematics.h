#pragma once

#include <Eigen/SparseLU>

#include "fem/solve/diagnosis.h"

namespace flexmorph::fem {

struct KinematicsSettings {
  double largest_step = 0.1;    ///< of a substep [s]
  double smallest_step = 1e-7;  ///< below it the path ends; its time is known as well as this [s]
  /// The correction of a predicted position may have this part of the predicted motion or, where
  /// that is larger, a fifth of this part of the model's size.
  double correction = 0.1;
  int most_steps = 1'000'000'000;  ///< until at() gives up, also those that are refused
};

/// Motion of a mechanism that its joints and drives determine: with as many independent rows as
/// unknowns,
///
///   Φ(q, t) = 0,   Φ_q v = -Φ_t,   Φ_q a = right side of the accelerations,
///
/// positions by Newton's method from q + h v + ½ h² a, to round-off (1e-12 of the model's size),
/// rates from the factor at the same q. A substep is halved where Newton does not converge, where
/// it corrects the prediction by much, and where the sign of det Φ_q changes: so the path keeps to
/// its branch, and ends at a singular position (dead centre, change point). What is not seen: a
/// determinant that touches zero between two substeps without a change of sign.
///
/// Redundant rows are left out of the equations and checked at every time.
class Kinematics {
 public:
  /// Assembles the start (fem/solve/assembly.h); the model must outlive this.
  /// @throws Error (input) when freedoms are left or rows contradict each other, with the joints;
  /// Error (numerical) when the start cannot be assembled.
  Kinematics(Workspace& model, State start, const KinematicsSettings& settings = {});

  /// q, v, a at time t, later or earlier than the last one asked for; λ is zero.
  /// @throws Error (numerical) "path cannot be reached at t = ..." with the joints that hold it up;
  /// the time is right to smallest_step, and the last state before it is kept.
  const State& at(double t);
  /// As at(), but goes no further once so many steps were tried in all. @return is it there?
  bool follow(double t, int most_steps);

  /// The last state found.
  const State& state() const { return x_; }
  /// Steps that were tried so far, also those that were refused.
  int n_steps() const { return n_steps_; }

 private:
  /// A step to time t; false, and x_ as before, when it is refused.
  bool step_to(double t);
  bool newton(State& x, double& sign);
  bool factorize(const State& x);
  void solve(const VectorXd& right, VectorXd& out) const;
  void find_rates(State& x);
  /// The path ends between the last state and this time.
  [[noreturn]] void give_up(double refused);

  Workspace& model_;
  KinematicsSettings settings_;
  State x_, trial_;
  int n_steps_ = 0;
  double sign_ = 0;                // of det Φ_q on this branch
  double size_ = 1;                // of the model
  std::vector<int> place_of_row_;  // in the square matrix, -1: left out
  ScaledConstraints rows_;
  SparseMatrix square_;
  Eigen::SparseLU<SparseMatrix> lu_;
  std::vector<Eigen::Triplet<double>> entries_;
  mutable VectorXd right_;
  VectorXd correction_;
};

}  // namespace flexmorph::fem
