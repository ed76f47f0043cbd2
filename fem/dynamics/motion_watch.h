#pragma once

#include <optional>

#include "fem/dynamics/motion.h"

/// Checks of a motion while it is integrated.
namespace flexmorph::fem {

/// Checks of one motion: inspects its steps, records the findings in its result, and stops a motion
/// that has become physically meaningless.
class MotionWatch {
 public:
  /// Creates the checks of one motion. The arguments must outlive this object.
  /// @param result  Result in which the findings are recorded.
  MotionWatch(Workspace& model, const MotionSettings& settings, MotionResult& result);

  /// Starts the check of the energy with the energies of the initial state.
  void begin(const Energies& e);
  /// Saves or restores the state of the checks (geometry/archive.h).
  void archive(Archive& memory);

  /// Checks an accepted step that ended at x.
  /// @param e, p     Energies and powers of the step.
  /// @param defect   Residual of the energy balance [J].
  /// @param h        Length of the step [s].
  /// @param at_stop  True if x is at a stop.
  /// @param steps    Number of accepted steps.
  /// @throws Error (numerical) if the material has turned inside out, or if a motion without drives
  ///         has gained more than EnergyGrowth::kLargest.
  void see(const State& x, const Energies& e, const Powers& p, double energy_error, double h,
           bool at_stop, int steps);
  /// Records an accepted step of an integration segment with equal steps.
  /// @param h      Length of the step [s].
  /// @param meant  Length of the step before any halving by failures of Newton's method [s].
  void see_equal(const State& x, double h, double meant);
  /// Records the residuals of the constraints and of their rates at x.
  void see_drift(const State& x);
  /// Records the smallest area ratio |r_m x r_n| at x.
  /// @throws Error (numerical) unless the ratio is positive.
  void see_material(const State& x, int steps);

  /// Returns the error of a step that failed at x, extended by the names of the joints if rigid
  /// bodies are near a singular position; returns nothing otherwise.
  std::optional<Error> with_joints(const Error& error, const State& x);

  /// Returns the largest energy that the motion has gained without a source so far.
  EnergyGain energy_gain() const { return growth_.gain(); }

 private:
  void see_joints(const State& x);

  Workspace& model_;
  const MotionSettings& settings_;
  MotionResult& result_;
  MultiplierWatch multipliers_;
  EnergyGrowth growth_;
  std::optional<ConstraintWatch> joints_;  // only for models with rigid bodies
  int since_material_ = 0, since_joints_ = 0;
  bool was_near_ = false;
};

}  // namespace flexmorph::fem
