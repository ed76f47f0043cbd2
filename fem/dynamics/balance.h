#pragma once

#include "fem/dynamics/growth.h"

namespace flexmorph::fem {

/// Power that enters a model [W].
struct Powers {
  double drive = 0;   ///< of the drives of all joints, λ · ∂Φ/∂t
  double feed = 0;    ///< of what pushes the material through the mesh, Term::flow_power()
  double inflow = 0;  ///< kinetic, strain and potential energy that entering material brings along
  double total() const { return drive + feed + inflow; }
};

/// The energy balance of a model with material flow,
///
///   d(T + U + V)/dt = λ·Φ_t + ∫ (Q̇-free rate of r)·(forces) + (energy density) × (inflow),
///
/// which follows from the virtual work equation with δq = q̇ and the moving limit of the integrals
/// (root line at m₀(t): each density e contributes -ṁ₀ ∫ e dn).
///
/// @param growths  bodies that grow; x consistent (λ belongs to q̈); prepare(x.t) done
Powers powers(const Model& model, std::span<const Growth> growths, const State& x,
              const VectorXd& gravity);

/// Integrates the powers along a run and compares with the energies.
class EnergyBalance {
 public:
  /// First state, or the state after a change of the mesh (same energies, other powers).
  void restart(double t, const Powers& p) {
    t_ = t;
    power_ = p.total();
  }
  void begin(double t, const Energies& e, const Powers& p) {
    start_ = e.total();
    work_ = 0;
    largest_ = std::abs(e.total());
    restart(t, p);
  }
  /// After a step: trapezoidal rule.
  void add(double t, const Energies& e, const Powers& p) {
    work_ += 0.5 * (t - t_) * (power_ + p.total());
    restart(t, p);
    defect_ = e.total() - start_ - work_;
    largest_ = std::max({largest_, std::abs(e.total()), e.kinetic, e.strain});
    worst_ = std::max(worst_, std::abs(defect_));
  }
  /// After a step whose powers are those of its middle: mid-point rule.
  void add_mean(double t, const Energies& e, const Powers& p) {
    power_ = p.total();
    add(t, e, p);
  }
  double work() const { return work_; }      ///< [J]
  double defect() const { return defect_; }  ///< energy - start - work [J]
  double relative() const { return worst_ / std::max(largest_, 1e-300); }  ///< largest so far

 private:
  double t_ = 0, power_ = 0, start_ = 0, work_ = 0, defect_ = 0, largest_ = 0, worst_ = 0;
};

}  // namespace flexmorph::fem
