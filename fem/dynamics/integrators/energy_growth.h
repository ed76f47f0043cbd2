#pragma once

#include "fem/dynamics/balance.h"

namespace flexmorph::fem {

/// Energy that a motion has gained out of nothing.
struct EnergyGain {
  double part = 0;  ///< largest gain, of the largest energy
  double time = 0;  ///< when it first was more than EnergyGrowth::kNoticed [s]; 0: never
};

/// Watches motions that nothing drives: no power of drives, material flow or heat enters, so that
/// what energy they gain is made by the steps. Methods that damp high frequencies do so in linear
/// problems only; where a step leaves the vibrations of a softly stretched or buckling body
/// unresolved, or lets multipliers alternate, energy grows, frequencies grow with it, and in the
/// end Newton's method fails (Simo & Tarnow 1992, ZAMP 43, 757-792).
///
/// The gain, defect of the balance, is measured against the largest of kinetic energy, strain
/// energy and change of potential energy. A bounded error ∝ (hω)² is no growth: it stays below
/// kNoticed where the step resolves the motion.
class EnergyGrowth {
 public:
  static constexpr double kNoticed = 0.1;  ///< of the largest energy: worth a warning
  static constexpr double kLargest = 0.5;  ///< what comes after is no motion of the model

  /// @param round_off  energies that mean nothing [J]
  void begin(const Energies& e, double round_off);
  /// After a step. @param defect  EnergyBalance::defect() [J]
  void see(double t, const Energies& e, const Powers& p, double defect);

  bool is_watched() const { return watched_; }  ///< false once power has come in
  /// Nothing where power has come in.
  EnergyGain gain() const { return watched_ ? gain_ : EnergyGain{}; }
  bool is_too_large() const { return watched_ && gain_.part > kLargest; }

 private:
  bool watched_ = false;
  double potential_ = 0, largest_ = 0;
  EnergyGain gain_;
};

}  // namespace flexmorph::fem
