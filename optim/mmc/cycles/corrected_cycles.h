#pragma once

#include <functional>
#include <memory>
#include <vector>

#include "optim/mmc/cycles/body_design.h"
#include "optim/mmc/cycles/optimality_certificate.h"

namespace flexmorph::mmc {

/// Method that continues designs of equivalent static loads with the gradient of the motion.
enum class Correction {
  none,         ///< The designs stay as they are.
  first_order,  ///< Cycles with static problems that are corrected by the gradient of the motion.
  direct        ///< The optimizer minimizes the number of the motion itself.
};

/// Settings of the correction of designs.
struct CorrectionSettings {
  Correction kind = Correction::none;  ///< Method.
  int max_cycles = 20;                 ///< Largest number of cycles, or of iterations if direct.
  int inner_iterations = 40;           ///< Largest number of iterations in the problem of a cycle.
  double radius = 0.05;                ///< First radius of the trust region, scaled variables [-].
  double smallest_radius = 1e-4;       ///< Radius below which the cycles end [-].
  int secants = 10;             ///< Number of pairs of designs that give the curvature; 0: none.
  double kkt_reduction = 1e-2;  ///< Fraction of the first KKT residual at which it has converged.
  optim::Settings optimizer;    ///< Optimizer of the static problems, or of the motion if direct.
};

/// A row of the history of corrected cycles: a cycle, or an iteration of a direct run.
struct CorrectedCycle {
  int cycle = 0;         ///< Number of the cycle; 0: the initial design.
  double value = 0;      ///< Objective J of the motion.
  double kkt = 0;        ///< KKT residual of log J.
  double angle = 0;      ///< Angle between the gradients of J and of the uncorrected C [rad].
  double radius = 0;     ///< Radius of the trust region in which the step was computed [-].
  double predicted = 0;  ///< Predicted relative decrease of J [-].
  double actual = 0;     ///< Actual relative decrease of J [-].
  bool accepted = true;  ///< True if the design was accepted.
  int motions = 0;       ///< Number of motions so far, each with its adjoint.
  double seconds = 0;    ///< CPU time so far [s].
};

/// A function that returns the loads of all bodies at their present designs.
using LoadsAt = std::function<std::vector<std::unique_ptr<ComplianceEvaluator>>()>;
/// A function that is called with every cycle; it returns false to end the cycles.
using SeeCycle = std::function<bool(const CorrectedCycle&)>;

/// Improves designs towards an optimum of a number J of their motion. Cycle k of the method
/// first_order solves the problem
///
///   min  C(x)/C_k + (∇log J_k - ∇log C_k)ᵀ (x - x_k),   |x - x_k|_∞ <= Δ_k
///
/// under the limits of the design, where C is the objective of the static problem. This is s C(x)
/// plus the error of its gradient, with s = J_k / C_k, divided by s C_k. The new design is accepted
/// if J decreases by at least a tenth of the predicted decrease; Δ is enlarged or halved depending
/// on this ratio. A fixed point at which Δ is not active is a KKT point of J. The number of
/// components does not change, and the bands are those of the last stage.
///
/// The static loads lack a part of the curvature of J (vibrations whose phase the design shifts).
/// It is estimated from earlier designs: the term ½ |Rᵀ(x - x_k)|² is added, where R Rᵀ is the
/// positive semidefinite part of the symmetric rank-one (SR1) matrix Y (SᵀY)⁻¹ Yᵀ. S holds the
/// differences of tried designs, Y the differences of the gradient errors between them.
///
/// On return the problems hold the last accepted design (first_order), or the feasible design with
/// the smallest J (direct).
/// @throws Error (numerical) if the first motion fails; a later design whose motion fails is
///         rejected.
///
/// Source: Alexandrov et al. (1998); Stolpe et al. (2018); optim/README.md, Corrected cycles.
void correct_designs(std::vector<BodyProblem>& problems, const LoadsAt& loads,
                     MotionResponse& motion, const CorrectionSettings& settings,
                     const SeeCycle& see);

/// Returns the outcomes of corrected designs under the loads of their own motion.
std::vector<BodyOutcome> outcomes_of_corrected(std::span<const LoadedBody> bodies);

}  // namespace flexmorph::mmc
