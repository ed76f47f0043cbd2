#pragma once

#include <string>
#include <vector>

#include "optim/mmc/cycles/combined_problem.h"

namespace flexmorph::mmc {

/// Optimality of the designs in one representation, regularized or crisp. J is the number of the
/// motion that is minimized (goal_of_motion()), C the compliance under the loads.
struct CertifiedDesign {
  double value = 0;  ///< Number J of the motion.
  double kkt = 0;    ///< KKT residual of log J under the limits of the design.
  double angle = 0;  ///< Angle between the gradients of J and C by the scaled variables [rad].

  /// Predicted decrease: the largest relative decrease of J within the move limit, to first order.
  /// It is an upper bound from the dual of the linear problem at the multipliers of `kkt`, see
  /// left_within().
  double left = 0;
  double violation = 0;  ///< Largest violation of a limit of the design, from Response::g [-].
};

/// Optimality certificate: it measures by the motion itself how far a design of equivalent static
/// loads is from an optimum. It evaluates the regularized design of the last stage, which the
/// optimizer uses, and the crisp design, which the outlines enclose exactly. Gradients of the crisp
/// design are shape derivatives, see CrispPicture.
struct OptimalityCertificate {
  std::string objective;               ///< Name of J, for example "strain energy in motion".
  CertifiedDesign regularized, crisp;  ///< Results for both representations of the designs.
  double move_limit = 0;               ///< Move limit of the predicted decrease [-].
  double seconds = 0;                  ///< CPU time [s].

  /// Gradient of the motion at the regularized design of one body: how components should move.
  struct Body {
    std::string body;                   ///< Name of the body.
    std::vector<Component> components;  ///< Components of the design, N in number.
    VectorXd slopes;                    ///< Gradient ∂ log J / ∂ parameters (7 N) [1/m, 1/rad].
  };
  std::vector<Body> bodies;  ///< Gradients of all bodies.
};

/// Computes the optimality certificate of the designs of these bodies, which takes two motions with
/// their adjoints.
/// @param bodies  bodies at their designs, under their loads
/// @param motion  motion of the mechanism that contains the bodies
/// @throws Error (numerical) from the motion or statics.
OptimalityCertificate certify(std::span<const LoadedBody> bodies, MotionResponse& motion,
                              double move_limit);

/// Returns the state of the motion that the goals of these parts require.
MotionState motion_state_of(std::span<const Subproblem> parts, MotionResponse& motion);

/// Returns J of the crisp designs, which the outlines enclose.
/// @throws Error (numerical) from the motion.
double crisp_objective(std::span<const BodyProblem> problems, MotionResponse& motion);

/// Returns the predicted decrease of a response within a move limit: an upper bound to first order,
/// see CertifiedDesign::left.
/// @param lambda  multipliers of the constraints (m), >= 0
double left_within(const optim::ProblemValues& r, const VectorXd& x, const VectorXd& lower,
                   const VectorXd& upper, const VectorXd& lambda, double move_limit);

/// Returns the angle between two gradients [rad]; 0 if one of them is zero.
double angle_between(const VectorXd& a, const VectorXd& b);

/// Distance below which limits count as active. The crisp volume meets its limit to 2e-4 only; with
/// this tolerance the limit counts as active.
inline constexpr double kActiveLimits = 1e-3;

}  // namespace flexmorph::mmc
