#pragma once

#include <optional>

#include "fem/dynamics/motion.h"

/// The checks of a motion while it runs.
namespace flexmorph::fem {

/// Watches the steps of one motion, tells its result what it sees, and stops a motion that has no
/// meaning any more.
class MotionWatch {
 public:
  /// @param settings, result  live longer than the watch
  MotionWatch(Workspace& model, const MotionSettings& settings, MotionResult& result);

  /// Begins at the energies of the start.
  void begin(const Energies& e);
  /// Stores or puts back what the watch knows (geometry/memory.h).
  void remember(Memory& memory);

  /// Records an accepted step to x.
  /// @param h        its length [s]
  /// @param at_stop  is x at a stop?
  /// @param defect   of the energy balance [J]
  /// @param steps    number of accepted steps
  /// @throws Error (numerical) when the material has turned inside out, or when a motion that
  ///         nothing drives has gained more than EnergyGrowth::kLargest
  void see(const State& x, const Energies& e, const Powers& p, double defect, double h,
           bool at_stop, int steps);
  /// Records a step of a leg with equal steps.
  /// @param meant  its length, had Newton's method solved it [s]
  void see_equal(const State& x, double h, double meant);
  /// Records how far a state is from its constraints.
  void see_drift(const State& x);
  /// Looks at the smallest ratio of areas. @throws Error (numerical) unless it is positive.
  void see_material(const State& x, int steps);

  /// Returns the error of a step that failed at x with the names of the joints, where rigid bodies
  /// are near a singular position; nothing elsewhere.
  std::optional<Error> with_joints(const Error& error, const State& x);

  EnergyGain energy_gain() const { return growth_.gain(); }

 private:
  void see_joints(const State& x);

  Workspace& model_;
  const MotionSettings& settings_;
  MotionResult& result_;
  MultiplierWatch multipliers_;
  EnergyGrowth growth_;
  std::optional<ConstraintWatch> joints_;  // only with rigid bodies
  int since_material_ = 0, since_joints_ = 0;
  bool was_near_ = false;
};

}  // namespace flexmorph::fem
