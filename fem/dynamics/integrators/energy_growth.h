#pragma once

#include "fem/dynamics/balance.h"

namespace flexmorph::fem {

/// Energy that a motion has gained without a source.
struct EnergyGain {
  double part = 0;  ///< Largest gain, relative to the largest energy.
  double time = 0;  ///< First time of a gain above EnergyGrowth::kNoticed [s]; 0: there was none.
};

/// Check of motions without drives for a growth of energy. No power of drives, material flow or
/// heat enters such a motion; therefore any gain of energy is an error of the time steps.
/// Integrators that damp high frequencies do so only for linear problems. If a step does not
/// resolve the vibrations of a softly stretched or buckling body, or if it lets multipliers
/// alternate, the energy grows, the frequencies grow with it, and finally Newton's method fails
/// (Simo & Tarnow 1992, ZAMP 43, 757-792).
///
/// The gain, which is the residual of the energy balance, is related to the largest of kinetic
/// energy, strain energy and change of potential energy. A bounded error ∝ (hω)² is no growth: it
/// stays below kNoticed if the step resolves the motion.
class EnergyGrowth {
 public:
  static constexpr double kNoticed = 0.1;  ///< Relative gain above which a warning is given.
  static constexpr double kLargest = 0.5;  ///< Relative gain above which the motion is stopped.

  /// Starts the check with the energies e of the initial state.
  /// @param round_off  Energy below which differences are round-off [J].
  void begin(const Energies& e, double round_off);
  /// Checks the energies e and powers p after a step that ended at time t [s].
  /// @param energy_error  EnergyBalance::energy_error() [J].
  void see(double t, const Energies& e, const Powers& p, double energy_error);

  /// Returns true after begin() until power enters the motion.
  bool is_watched() const { return watched_; }
  /// Returns the largest gain so far; zero if power has entered the motion.
  EnergyGain gain() const { return watched_ ? gain_ : EnergyGain{}; }
  /// Returns true if the gain is above kLargest and no power has entered the motion.
  bool is_too_large() const { return watched_ && gain_.part > kLargest; }

 private:
  bool watched_ = false;
  double potential_ = 0, largest_ = 0;
  EnergyGain gain_;
};

}  // namespace flexmorph::fem
