#pragma once

#include "fem/dynamics/integrators/integrator.h"

namespace flexmorph::fem {

/// Explicit integration in the independent coordinates of the joints: the state is y = (q_i, q̇_i),
/// and every evaluation of ẏ = (q̇_i, q̈_i) finds the others,
///
///   Φ(q, t) = 0                      Newton's method for q_d, from the last ones
///   Φ_q q̇ = -Φ_t                     for q̇_d, with the factor of Φ_qd at the same q
///   M q̈ + Φ_qᵀ λ = -F, Φ_q q̈ = γ    for q̈ and λ
///
/// so that constraints hold to round-off at all three levels at every time. Runge-Kutta method of
/// Dormand & Prince of order 5 with error estimate of order 4, steps as long as the tolerance
/// allows: the local error of q_i is held to tolerance times the size of the model, that of q̇_i to
/// tolerance times the largest speed, both as displacements (Model::scales()).
///
/// Which coordinates are independent (CoordinatePartition) stays until their amplification is two
/// times what it was at its best, or Newton's method fails; then they are chosen anew.
///
/// Being explicit it resolves every vibration of the model: for undamped ones of frequency ω the
/// method is stable to h ω = 1. Use it for rigid and soft models, and as an independent check.
///
/// Source: T, section 7 (end) and 9; Dormand & Prince (1980), J. Comput. Appl. Math. 6, 19-26.
class MinimalCoordinates final : public Integrator {
 public:
  /// @throws Error (input) for a tolerance outside [1e-13, 1) and for free material lines, naming
  /// their bodies.
  MinimalCoordinates(Workspace& model, const MinimalCoordinatesSettings& settings);
  ~MinimalCoordinates() override;

  /// Also looks for unknowns without mass. @throws Error (input) naming their bodies.
  void make_consistent(State& x) override;
  void project_velocity(State& x) override;
  /// In as many steps as the tolerance needs; every one is accepted with q̈ and λ of its own time.
  /// @throws Error (numerical) also when a stiff model needs more than max_steps, with its fastest
  /// vibration.
  void advance(State& x, double t_end, const std::function<void(const State&)>& accepted) override;
  const StepCounts& counts() const override;
  std::optional<double> condition() const override;
  void remember(Memory& memory) override;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace flexmorph::fem
