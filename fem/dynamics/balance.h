#pragma once

#include <algorithm>
#include <cmath>

#include "fem/line_grid.h"
#include "fem/model/workspace.h"

namespace flexmorph::fem {

/// Powers that change the energy of a model [W].
struct Powers {
  /// Power of the prescribed motions of all joints, λ · ∂Φ/∂t [W].
  double drive = 0;
  /// Power that moves the material through the mesh [W]: FlowTerm::flow_power(), and driven
  /// material lines of elements that also have free lines.
  double feed = 0;
  /// Kinetic, strain and potential energy that entering material carries, per time [W].
  double inflow = 0;
  /// Power of force elements with damping or with shifted points of action, and of loads without a
  /// potential [W]: Workspace::force_element_power() and Workspace::load_power().
  double force_elements = 0;
  /// Power of the prescribed temperature of hot bodies, Workspace::heat_power() [W].
  double heat = 0;
  /// Power that dissipative terms take out of the model, Workspace::dissipation() [W].
  double loss = 0;
  /// Returns the net power that enters the model [W].
  double total() const { return drive + feed + inflow + force_elements + heat - loss; }
};

/// Returns the powers in the energy balance of a model with material flow,
///
///   d(T + U + V)/dt = λ·Φ_t + ∫ (Q̇-free rate of r)·(forces) + (energy density) × (inflow).
///
/// The balance follows from the virtual work equation with δq = q̇ and from the moving limit of the
/// integrals: with the root line at m₀(t), each density e contributes -ṁ₀ ∫ e dn.
///
/// If the root line is free, its rate ṁ₀ is one of the velocities q̇, and there is no power at fixed
/// unknowns. The equation of the free line contains the virtual work of inertia and weight at fixed
/// material points; therefore the kinetic and the potential energy density still flow in as above.
/// For the strain energy it contains the gradient of U including the moving limits of integration
/// (EulerianElastic); therefore dU/dt = ∂U/∂q · q̇, and the strain energy density does not appear.
///
/// @param x  State with consistent q̈ and λ.
/// @throws Error (input) if an n-line moves that is driven or is an edge of its body.
Powers powers(Workspace& model, const State& x);

/// Energy balance of a motion: integrates the powers and compares their work with the energies.
class EnergyBalance {
 public:
  /// Starts the balance at time t [s] with the energies e and the powers p.
  void begin(double t, const Energies& e, const Powers& p) {
    start_ = e.total();
    work_ = dissipated_ = 0;
    largest_ = std::abs(e.total());
    t_ = t;
    power_ = p.total();
    loss_ = p.loss;
    known_ = true;
  }
  /// Continues with the powers p after a change of the mesh. The energy that the change itself adds
  /// or removes becomes a part of the residual defect().
  void keep_running(const Powers& p) {
    power_ = p.total();
    loss_ = p.loss;
  }
  /// Adds a step that ends at time t [s], by the trapezoidal rule.
  void add(double t, const Energies& e, const Powers& p) {
    work_ += 0.5 * (t - t_) * ((known_ ? power_ : p.total()) + p.total());
    dissipated_ += 0.5 * (t - t_) * ((known_ ? loss_ : p.loss) + p.loss);
    t_ = t;
    power_ = p.total();
    loss_ = p.loss;
    known_ = true;
    energy_error_ = e.total() - start_ - work_;
    largest_ = std::max({largest_, std::abs(e.total()), e.kinetic, e.strain});
    worst_ = std::max(worst_, std::abs(energy_error_));
  }
  /// Adds a step that ends at time t [s] and whose powers p belong to its middle, by the mid-point
  /// rule.
  void add_mean(double t, const Energies& e, const Powers& p) {
    known_ = false;
    add(t, e, p);
  }
  /// Returns the work of all powers since the start [J].
  double work() const { return work_; }
  /// Returns the energy that was dissipated since the start [J].
  double dissipated() const { return dissipated_; }
  /// Returns the residual of the balance: energy - energy at the start - work [J].
  double energy_error() const { return energy_error_; }
  /// Returns the largest residual so far, relative to the largest energy so far.
  double relative() const { return worst_ / std::max(largest_, 1e-300); }

 private:
  bool known_ = false;  // true if power_ and loss_ belong to the time t_
  double t_ = 0, power_ = 0, loss_ = 0, start_ = 0, work_ = 0, dissipated_ = 0;
  double energy_error_ = 0, largest_ = 0, worst_ = 0;
};

}  // namespace flexmorph::fem
