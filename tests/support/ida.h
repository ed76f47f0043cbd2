#pragma once

#include <span>
#include <vector>

#include "fem/model/workspace.h"

/// An independent integrator for comparisons: IDA of SUNDIALS with backward differentiation
/// formulas of order 1 to 5, whose steps and orders are chosen by the local error.
namespace flexmorph::testing {

struct IdaSettings {
  /// Tolerance of the local error: of positions relative to the size of the model, of velocities
  /// relative to the largest speed, both as displacements (Model::scales()).
  double tolerance = 1e-8;
  double speed = 1;  ///< Reference speed of velocity errors [m/s].
  double size = 1;   ///< Reference length of position errors [m].
  int max_order = 5;
  long max_steps = 200'000;
};

struct IdaCounts {
  long steps = 0, residuals = 0, jacobians = 0;
  int order = 0;  ///< Order of the last step.
};

/// Returns the motion of a model from a consistent start (with q, v, a and λ) at later times in
/// ascending order. The mesh must not change in between.
///
/// It solves the index-2 form with stabilized positions,
///
///   q̇ - v + Φ_qᵀ μ = 0,   M v̇ + F(q, v, t) + Φ_qᵀ λ = 0,   Φ_q v + Φ_t = 0,   Φ(q, t) = 0
///
/// so that Φ and its rate vanish to the accuracy of Newton's method; μ is zero except for errors.
/// The multipliers are no part of the local error (IDASetSuppressAlg). The λ of the states is the
/// solution of IDA, and their a is its v̇.
///
/// Source: Gear, Leimkuhler & Gupta (1985), J. Comput. Appl. Math. 12-13, 77-90; Hindmarsh et al.
/// (2005), ACM Trans. Math. Softw. 31, 363-396.
/// @throws Error (numerical) with the code of IDA when the integration fails.
std::vector<fem::State> solve_by_ida(fem::Workspace& model, const fem::State& start,
                                     std::span<const double> times, const IdaSettings& settings,
                                     IdaCounts* counts = nullptr);

}  // namespace flexmorph::testing
