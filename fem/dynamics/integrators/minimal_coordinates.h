#pragma once

#include "fem/dynamics/integrators/integrator.h"

namespace flexmorph::fem {

/// Explicit integrator in the independent coordinates of the joints. Its state is y = (q_i, q̇_i),
/// and every evaluation of ẏ = (q̇_i, q̈_i) solves for the other variables,
///
///   Φ(q, t) = 0                      Newton's method for q_d, from its last values
///   Φ_q q̇ = -Φ_t                     for q̇_d, with the factorization of Φ_qd at the same q
///   M q̈ + Φ_qᵀ λ = -F, Φ_q q̈ = γ    for q̈ and λ.
///
/// Therefore the constraints of positions, velocities and accelerations hold to round-off at every
/// time. The method is the Runge-Kutta method of Dormand & Prince of order 5 with an error estimate
/// of order 4. Steps are as long as the tolerance allows: the local error of q_i is limited to
/// tolerance times the size of the model, that of q̇_i to tolerance times the largest speed, both as
/// displacements (Model::scales()).
///
/// The choice of independent coordinates (CoordinatePartition) is kept until their amplification
/// exceeds two times its best value, or Newton's method fails; then they are chosen again.
///
/// The method is explicit; therefore it resolves every vibration of the model. For undamped
/// vibrations of frequency ω it is stable up to h ω = 1. It is meant for rigid and soft models, and
/// as an independent check.
///
/// Source: T, section 7 (end) and 9; Dormand & Prince (1980), J. Comput. Appl. Math. 6, 19-26.
class MinimalCoordinates final : public Integrator {
 public:
  /// Creates the integrator for a model, which must outlive it.
  /// @throws Error (input) for a tolerance outside [1e-13, 1) and for free material lines, naming
  /// their bodies.
  MinimalCoordinates(Workspace& model, const MinimalCoordinatesSettings& settings);
  ~MinimalCoordinates() override;

  /// Computes consistent q̈ and λ, and checks for unknowns without mass.
  /// @throws Error (input) naming the bodies of unknowns without mass.
  void make_consistent(State& x) override;
  void project_velocity(State& x) override;
  VectorXd balance(State& x, double frequency) override;
  /// Advances x in as many steps as the tolerance requires; each accepted state has q̈ and λ of its
  /// own time.
  /// @throws Error (numerical) also if a stiff model needs more than max_steps; the message gives
  /// its fastest vibration.
  void advance(State& x, double t_end, const std::function<void(const State&)>& accepted) override;
  const StepCounts& counts() const override;
  std::optional<double> condition() const override;
  void archive(Archive& memory) override;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace flexmorph::fem
