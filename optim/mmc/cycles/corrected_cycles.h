#pragma once

#include <functional>
#include <memory>
#include <vector>

#include "optim/mmc/cycles/body_design.h"
#include "optim/mmc/cycles/motion_certificate.h"

namespace flexmorph::mmc {

/// How designs of equivalent static loads go on.
enum class Correction {
  none,
  first_order,  ///< cycles whose static problem has the gradient of the motion
  direct        ///< the optimizer on the motion itself
};

struct CorrectionSettings {
  Correction kind = Correction::none;
  int max_cycles = 20;        ///< of first_order; iterations of direct
  int inner_iterations = 40;  ///< of a cycle's static problem
  double radius = 0.05;       ///< of the first cycle's trust region, of scaled variables
  double smallest_radius = 1e-4;
  int secants = 10;           ///< pairs of designs that curvature is learned from; 0: none
  double kkt_part = 1e-2;     ///< it has converged at this part of the first KKT residual
  optim::Settings optimizer;  ///< of the static problems, or of the motion
};

/// A cycle of either kind.
struct CorrectedCycle {
  int cycle = 0;         ///< 0: the design they begin with
  double value = 0;      ///< J
  double kkt = 0;        ///< of log J
  double angle = 0;      ///< between the gradients of J and C, uncorrected [rad]
  double radius = 0;     ///< of the trust region it was looked for in
  double predicted = 0;  ///< part that J was to fall by
  double actual = 0;     ///< and fell by
  bool accepted = true;
  int motions = 0;     ///< so far, each with its adjoint
  double seconds = 0;  ///< CPU, so far
};

/// The loads of all bodies at their designs as they are.
using LoadsAt = std::function<std::vector<std::unique_ptr<ComplianceEvaluator>>()>;
/// Sees every cycle; false ends them after it.
using SeeCycle = std::function<bool(const CorrectedCycle&)>;

/// Brings designs nearer to an optimum of their motion. In cycle k of first_order
///
///   min  C(x)/C_k + (∇log J_k - ∇log C_k)ᵀ (x - x_k),   |x - x_k|_∞ <= Δ_k
///
/// under the limits of the design, C the objective of the static problem: s C(x) plus what is wrong
/// with its gradient, s = J_k / C_k, by s C_k. x is taken when J falls by a tenth of what was
/// predicted; Δ grows or is halved by the ratio. A fixed point at which Δ is not active is a KKT
/// point of J. Components neither come nor go, bands are those of the last stage.
///
/// What the loads do not see of the curvature of J (vibrations whose phase the design shifts) is
/// learned: ½ |Rᵀ(x - x_k)|² is added, R Rᵀ the positive part of the symmetric rank-one matrix
/// Y (SᵀY)⁻¹ Yᵀ of the differences S of designs tried and Y of the gradients' error there.
///
/// The designs of the problems are left at the best J.
/// @throws Error (numerical) where the first motion fails; later ones are refused as designs.
///
/// Source: Alexandrov et al. (1998); Stolpe et al. (2018); optim/README.md, Corrected cycles.
void correct_designs(std::vector<BodyProblem>& problems, const LoadsAt& loads,
                     MotionResponse& motion, const CorrectionSettings& settings,
                     const SeeCycle& see);

/// The outcomes of designs that were corrected, under loads of their own motion.
std::vector<BodyOutcome> outcomes_of_corrected(std::span<const LoadedBody> bodies);

}  // namespace flexmorph::mmc
