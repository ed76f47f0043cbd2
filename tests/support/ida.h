#pragma once

#include <span>
#include <vector>

#include "fem/model/workspace.h"

/// A second integrator, of another family than ours and by other hands: IDA of SUNDIALS, backward
/// differentiation formulas of order 1 to 5 with steps and orders chosen by the local error.
namespace flexmorph::testing {

struct IdaSettings {
  /// Of the local error: of positions against the size of the model, of velocities against the
  /// largest speed, as displacements (Model::scales()).
  double tolerance = 1e-8;
  double speed = 1;  ///< what velocities are measured against [m/s]
  double size = 1;   ///< what positions are measured against [m]
  int max_order = 5;
  long max_steps = 200'000;
};

struct IdaCounts {
  long steps = 0, residuals = 0, jacobians = 0;
  int order = 0;  ///< of the last step
};

/// Motion of a model from a consistent start (q, v, a, λ all there), at times in ascending order
/// after it. Meshes must not change in between.
///
/// Solves the index-2 form with stabilized positions,
///
///   q̇ - v + Φ_qᵀ μ = 0,   M v̇ + F(q, v, t) + Φ_qᵀ λ = 0,   Φ_q v + Φ_t = 0,   Φ(q, t) = 0
///
/// so that Φ holds at both levels as well as Newton's method is solved; μ vanishes but for errors.
/// Multipliers are no part of the local error (IDASetSuppressAlg). λ of the states is IDA's own,
/// a its v̇.
///
/// Source: Gear, Leimkuhler & Gupta (1985), J. Comput. Appl. Math. 12-13, 77-90; Hindmarsh et al.
/// (2005), ACM Trans. Math. Softw. 31, 363-396.
/// @throws Error (numerical) with IDA's own code when it gives up.
std::vector<fem::State> solve_by_ida(fem::Workspace& model, const fem::State& start,
                                     std::span<const double> times, const IdaSettings& settings,
                                     IdaCounts* counts = nullptr);

}  // namespace flexmorph::testing
