#pragma once

#include <functional>
#include <limits>
#include <optional>
#include <span>
#include <vector>

#include "fem/dynamics/balance.h"
#include "fem/dynamics/integrators/energy_growth.h"
#include "fem/dynamics/integrators/integrator.h"
#include "fem/dynamics/integrators/step_control.h"
#include "fem/dynamics/integrators/step_watch.h"
#include "fem/dynamics/starts/start.h"
#include "fem/dynamics/trajectory.h"
#include "fem/solve/diagnosis.h"

namespace flexmorph::fem {

/// Takes down what the motion needs to go on from where it is. Changes nothing.
using TakeDown = std::function<std::string()>;

struct MotionSettings {
  double end = 1;      ///< [s]
  double step = 1e-3;  ///< [s]; where steps adapt only the spacing of looks for mesh changes
  /// Steps that adapt to their local error, where the integrator knows it (generalized_alpha);
  /// absent: equal steps.
  std::optional<AdaptiveStep> adaptive;
  Start start = Start::prestretched;
  Placement placement;  ///< of bodies that ride in no hub; empty where there are none
  std::string integrator = "generalized_alpha";  ///< see make_integrator()
  AlphaSettings alpha;
  EnergyMomentumSettings energy_momentum;
  MinimalCoordinatesSettings minimal_coordinates;
  VectorXd gravity;           ///< (dim) or empty
  std::vector<double> stops;  ///< times to be seen (loads, output), any order: equal steps land on
                              ///< them, adaptive ones are interpolated (DenseOutput)
  /// Kinks of drives and loads, any order: first times of what is behind them. Steps land on them,
  /// the last one with what is before, and the motion goes on with what is behind.
  std::vector<double> kinks;
  bool balance = true;  ///< keep the energy balance (costs a few percent)
  /// Energies that are round-off [J]. Given, a balanced motion that nothing drives is stopped when
  /// it gains energy (EnergyGrowth); absent where it may: loads without an energy, sudden drives.
  std::optional<double> energy_round_off;
  bool condition = false;     ///< estimate the condition at the end (costs a factorization)
  Keep keep = Keep::nothing;  ///< of the trajectory, for those who look at it afterwards
  /// Where the motion goes on: what a TakeDown gave in the same motion of the same model; empty: it
  /// begins. All that follows is the same bit for bit, whenever and however often it was taken.
  std::string memory;
  /// The motion stops at the end of the first step at or behind this time, before what follows
  /// there (a change of a mesh): a part of a motion. Not with adaptive steps [s].
  double until = std::numeric_limits<double>::infinity();
  /// Called at the end of every step (not of the parts that Newton's method cut it into) and of the
  /// motion; may throw. Not with a trajectory that is kept.
  std::function<void(const TakeDown&)> between_steps;
};

/// A change of the mesh, and what it did to the state.
struct MeshEvent {
  double time = 0;
  std::string body;
  MeshChange change = MeshChange::insertion;
  Energies before, after;
  Vec3 momentum_before = Vec3::Zero(), momentum_after = Vec3::Zero();
  double tip_jump = 0;  ///< of the free end's mid-point [m]
};

struct MotionResult;

/// What an observer of a motion sees at every accepted step (and at the start). With an integrator
/// that has a step_mean(), accelerations, multipliers and powers are means over the step before,
/// but at stops x is consistent.
struct MotionStep {
  Workspace& model;  ///< prepared for x
  const State& x;
  Energies energies;
  Powers powers;               ///< zero when no balance is kept
  double work = 0;             ///< of all powers since the start [J]
  double dissipated = 0;       ///< of terms that dissipate, a part of it [J]
  double defect = 0;           ///< energy - energy at the start - work [J]
  bool stop = false;           ///< is x.t one of the settings' stops (or the end)?
  const MotionResult& so_far;  ///< what was changed at the start, went wrong since
};
using MotionObserver = std::function<void(const MotionStep&)>;

struct MotionResult {
  State final;
  Trajectory trajectory;  ///< as far as MotionSettings::keep asks for it
  StepCounts counts;
  double smallest_step = 0, largest_step = 0;  ///< of the accepted ones [s]
  std::vector<MeshEvent> events;
  double energy_defect = 0;  ///< largest relative defect of the balance
  EnergyGain energy_gain;    ///< out of nothing, where nothing drives
  /// Largest change of a velocity at the start, so that joints allow it, as a displacement [m/s].
  double start_change = 0;
  std::optional<Alternation> alternation;  ///< of multipliers
  CutSteps cut;                            ///< of equal steps
  double constraint_drift = 0;             ///< largest |Φ| met [m]
  double velocity_drift = 0;               ///< largest |Φ_q q̇ + Φ_t| met [m/s]
  /// Of the matrix that was factored last, where it was asked for: Integrator::condition().
  std::optional<double> condition;
  double smallest_area_ratio = 1;  ///< |r_m × r_n|, every tenth step and at the stops
  /// With rigid bodies: times at which the joints were nearly dependent (condition above 1e6), seen
  /// at every 25th step; of looks in a row the worst.
  std::vector<Conditioning> near_singular;
};

/// Advances a model from t = 0 to the end. Its work space is left with the mesh of the end. Motions
/// that have a work space each do not know of each other: they may run at the same time, and every
/// one is the same bit for bit as if it were alone.
///
/// Steps land on stops (see MotionSettings), kinks and
/// changes of the mesh; a change that falls on the end itself is not executed.
///
/// @throws Error (input) for an integrator whose steps cannot adapt, where they should.
/// @throws Error (numerical) when a step fails, the material collapses, or a motion that nothing
///         drives has gained more than EnergyGrowth::kLargest; the observer has seen every step
///         before it. Where rigid bodies are near a singular position, the message of a
///         failed step names the joints.
MotionResult integrate(Workspace& model, std::span<const Growth> growths,
                       const MotionSettings& settings, const MotionObserver& observe);

/// Linear momentum of all bodies' own mass [kg m/s]; z = 0 in the plane.
Vec3 momentum_in_space(Workspace& model, const State& x);
/// Its first two entries.
Vec2 momentum(Workspace& model, const State& x);

}  // namespace flexmorph::fem
