#pragma once

#include <algorithm>
#include <cmath>

#include "fem/line_grid.h"
#include "fem/model/workspace.h"

namespace flexmorph::fem {

/// Power that enters a model [W].
struct Powers {
  double drive = 0;   ///< of the drives of all joints, λ · ∂Φ/∂t
  double feed = 0;    ///< of what pushes the material through the mesh, FlowTerm::flow_power()
  double inflow = 0;  ///< kinetic, strain and potential energy that entering material brings along
  double links = 0;   ///< of dampers, shifted places of links and loads without a potential:
                      ///< Workspace::link_power(), load_power()
  double heat = 0;    ///< of the temperature of hot bodies, Model::heat_power()
  double loss = 0;    ///< of terms that dissipate, Model::dissipation(): it leaves the model
  double total() const { return drive + feed + inflow + links + heat - loss; }
};

/// The energy balance of a model with material flow,
///
///   d(T + U + V)/dt = λ·Φ_t + ∫ (Q̇-free rate of r)·(forces) + (energy density) × (inflow),
///
/// which follows from the virtual work equation with δq = q̇ and the moving limit of the integrals
/// (root line at m₀(t): each density e contributes -ṁ₀ ∫ e dn).
///
/// Where the root line is free, ṁ₀ is among q̇: no power at fixed unknowns. Its equation holds the
/// virtual work of inertia and weight at fixed material points, so that their densities flow in as
/// above; but of the strain energy the gradient, limits included (FreeElastic): dU/dt is ∂U/∂q · q̇
/// and the strain density does not appear.
///
/// @param x  consistent (λ belongs to q̈)
/// @throws Error (input) where an n-line moves that is driven or an edge of its body
Powers powers(Workspace& model, const State& x);

/// Integrates the powers along a run and compares with the energies.
class EnergyBalance {
 public:
  void begin(double t, const Energies& e, const Powers& p) {
    start_ = e.total();
    work_ = dissipated_ = 0;
    largest_ = std::abs(e.total());
    t_ = t;
    power_ = p.total();
    loss_ = p.loss;
    known_ = true;
  }
  /// Goes on with the power p after a change of the mesh. What the change did to the energy is a
  /// part of the defect.
  void go_on(const Powers& p) {
    power_ = p.total();
    loss_ = p.loss;
  }
  /// After a step: trapezoidal rule.
  void add(double t, const Energies& e, const Powers& p) {
    work_ += 0.5 * (t - t_) * ((known_ ? power_ : p.total()) + p.total());
    dissipated_ += 0.5 * (t - t_) * ((known_ ? loss_ : p.loss) + p.loss);
    t_ = t;
    power_ = p.total();
    loss_ = p.loss;
    known_ = true;
    defect_ = e.total() - start_ - work_;
    largest_ = std::max({largest_, std::abs(e.total()), e.kinetic, e.strain});
    worst_ = std::max(worst_, std::abs(defect_));
  }
  /// After a step whose powers are those of its middle: mid-point rule.
  void add_mean(double t, const Energies& e, const Powers& p) {
    known_ = false;
    add(t, e, p);
  }
  double work() const { return work_; }              ///< of all powers [J]
  double dissipated() const { return dissipated_; }  ///< of the loss [J]
  double defect() const { return defect_; }          ///< energy - start - work [J]
  double relative() const { return worst_ / std::max(largest_, 1e-300); }  ///< largest so far

 private:
  bool known_ = false;  // is the power at t_?
  double t_ = 0, power_ = 0, loss_ = 0, start_ = 0, work_ = 0, dissipated_ = 0;
  double defect_ = 0, largest_ = 0, worst_ = 0;
};

}  // namespace flexmorph::fem
