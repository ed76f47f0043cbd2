#pragma once

#include <string>
#include <vector>

#include "optim/mmc/cycles/designed_parts.h"

namespace flexmorph::mmc {

/// What the motion says of one picture of the designs, with J a number of the motion
/// (goal_of_motion()) and C the compliance under the loads.
struct CertifiedDesign {
  double value = 0;  ///< J
  double kkt = 0;    ///< KKT residual of log J under the limits of the design
  double angle = 0;  ///< between the gradients of J and C by the scaled variables [rad]
  /// How far J can fall at most within the move limit, to first order, as a part of itself: of the
  /// linear problem's dual at the multipliers of `kkt`.
  double left = 0;
  double violation = 0;  ///< of the limits of the design, the largest: g of optim::Response [-]
};

/// What the motion itself says of a design that equivalent static loads have made: of the
/// regularized design of the last stage, which optimizers see, and of the crisp one, which is
/// exactly what the outlines enclose. Gradients of the crisp one are shape derivatives, see
/// CrispPicture.
struct MotionCertificate {
  std::string objective;  ///< "strain energy in motion"
  CertifiedDesign regularized, crisp;
  double move_limit = 0;
  double seconds = 0;  ///< CPU

  /// Where the motion would move material.
  struct Body {
    std::string body;
    std::vector<Component> components;
    VectorXd slopes;  ///< ∂ log J / ∂ parameters, 7 of every component [1/m, 1/rad]
  };
  std::vector<Body> bodies;
};

/// Computes the certificate of the designs of these bodies, which takes two motions with their
/// adjoints.
/// @param bodies  at their designs, under their loads
/// @param motion  of the mechanism they are parts of
/// @throws Error (numerical) from the motion or statics.
MotionCertificate certify(std::span<const LoadedBody> bodies, MotionResponse& motion,
                          double move_limit);

/// Returns the state of the motion that the goals of these parts ask for.
MotionState motion_state_of(std::span<const Part> parts, MotionResponse& motion);

/// J of what the outlines of these designs enclose.
/// @throws Error (numerical) from the motion.
double sharp_objective(std::span<const BodyProblem> problems, MotionResponse& motion);

/// The first-order bound of CertifiedDesign::left.
/// @param lambda  multipliers, >= 0
double left_within(const optim::Response& r, const VectorXd& x, const VectorXd& lower,
                   const VectorXd& upper, const VectorXd& lambda, double move_limit);

/// Between two gradients; 0 where one is none [rad].
double angle_between(const VectorXd& a, const VectorXd& b);

/// The sharp volume is what is allowed to 2e-4 only, and counts as a limit that is met: the
/// tolerance of active constraints.
inline constexpr double kActiveLimits = 1e-3;

}  // namespace flexmorph::mmc
