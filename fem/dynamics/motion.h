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

/// A function that returns an archive (checkpoint) from which the running motion can be continued.
/// It does not change the motion.
using SaveCheckpoint = std::function<std::string()>;

/// Settings of the time integration of one motion.
struct MotionSettings {
  /// Time at which the motion ends [s].
  double end = 1;
  /// Length of equal time steps [s]. With adaptive steps it is only the spacing of the search for
  /// the next change of the mesh.
  double step = 1e-3;
  /// Settings of adaptive time steps, for integrators that estimate their local error
  /// (generalized_alpha); absent: equal steps.
  std::optional<AdaptiveStep> adaptive;
  /// Kind of the initial state.
  Start start = Start::prestretched;
  /// Motion of the bodies that no hub carries (hub: the rigid frame that carries a body; its motion
  /// is prescribed, or it is fixed to a rigid body); empty if there are no such bodies.
  BodyPoses body_poses;
  /// Name of the integrator, see make_integrator().
  std::string integrator = "generalized_alpha";
  /// Settings of the integrator generalized_alpha.
  AlphaSettings alpha;
  /// Settings of the integrator energy_momentum.
  EnergyMomentumSettings energy_momentum;
  /// Settings of the integrator minimal_coordinates.
  MinimalCoordinatesSettings minimal_coordinates;
  /// Acceleration of gravity (dim) [m/s²], or empty.
  VectorXd gravity;
  /// Times at which the state is needed for loads or output [s], in any order. Equal steps end at
  /// these times; adaptive steps are interpolated there (DenseOutput).
  std::vector<double> stops;
  /// Discontinuities of drives and loads [s], in any order: each is the first time at which the
  /// function after the discontinuity holds. Steps end at these times. The last step uses the
  /// function before the discontinuity, and the motion continues with the function after it.
  std::vector<double> discontinuities;
  /// True if the energy balance is computed (this costs a few percent of the time).
  bool balance = true;
  /// Energy below which differences are round-off [J]. If it is given, a motion with energy balance
  /// and without drives is stopped when it gains energy (EnergyGrowth). It is absent if the motion
  /// may gain energy: loads without a potential, sudden drives.
  std::optional<double> energy_round_off;
  /// True if the condition number is estimated at the end (this costs a factorization).
  bool condition = false;
  /// States that are stored in the trajectory of the result.
  Keep keep = Keep::nothing;
  /// Archive from which the motion continues: the result of a SaveCheckpoint in the same motion of
  /// the same model; empty: the motion starts at t = 0. The continued motion is bit for bit the
  /// same as without interruption, whenever and however often archives were made.
  std::string memory;
  /// End of a part of the motion [s]: integration stops after the first step that ends at or after
  /// this time, before a change of the mesh that follows there. Not for adaptive steps.
  double until = std::numeric_limits<double>::infinity();
  /// Callback at the end of every step, but not after the substeps into which a failure of Newton's
  /// method divides it, and at the end of the motion. It may throw. It is called only if no
  /// trajectory is stored.
  std::function<void(const SaveCheckpoint&)> between_steps;
};

/// A change of the mesh, and the jumps of the state that it caused.
struct MeshEvent {
  /// Time of the change [s].
  double time = 0;
  /// Name of the body whose mesh has changed.
  std::string body;
  /// Kind of the change.
  MeshChange change = MeshChange::insertion;
  /// Energies of the model before and after the change [J].
  Energies before, after;
  /// Linear momentum of the model before and after the change [kg m/s].
  Vec3 momentum_before = Vec3::Zero(), momentum_after = Vec3::Zero();
  /// Jump of the mid-point of the free end [m].
  double tip_jump = 0;
};

struct MotionResult;

/// The data that the observer of a motion receives at the start and after every accepted step. If
/// the integrator has a step_mean(), accelerations, multipliers and powers are means over the step,
/// but at stops x is consistent.
struct MotionStep {
  /// Work space of the motion, prepared for x.
  Workspace& model;
  /// State at the end of the step.
  const State& x;
  /// Energies of the model at x [J].
  Energies energies;
  /// Powers that enter the model [W]; zero if no energy balance is computed.
  Powers powers;
  /// Work of all powers since the start [J].
  double work = 0;
  /// Energy that dissipative terms have taken out of the model since the start [J].
  double dissipated = 0;
  /// Residual of the energy balance: energy - energy at the start - work [J].
  double energy_error = 0;
  /// True if x.t is one of MotionSettings::stops, or the end.
  bool stop = false;
  /// Result so far: the change of the velocities at the start, and all warnings since.
  const MotionResult& so_far;
};

/// A function that is called at the start and after every accepted step of a motion.
using MotionObserver = std::function<void(const MotionStep&)>;

/// Result of a motion: its final state, its statistics, and the findings of its checks.
struct MotionResult {
  /// State at the end of the motion.
  State final;
  /// Stored states, according to MotionSettings::keep.
  Trajectory trajectory;
  /// Statistics of the time integration.
  StepCounts counts;
  /// Lengths of the shortest and of the longest accepted step [s].
  double smallest_step = 0, largest_step = 0;
  /// All changes of the mesh in the order of time.
  std::vector<MeshEvent> events;
  /// Largest residual of the energy balance, relative to the largest energy.
  double energy_error = 0;
  /// Largest energy that a motion without drives has gained; zero if the motion was not checked.
  EnergyGain energy_gain;
  /// Largest change of a velocity at the start that the joints required, as a displacement [m/s].
  double start_change = 0;
  /// Alternating multipliers, if any were found.
  std::optional<Alternation> alternation;
  /// Equal steps that were shortened because Newton's method failed.
  CutSteps cut;
  /// Largest |Φ| of all accepted steps [m].
  double constraint_drift = 0;
  /// Largest |Φ_q q̇ + Φ_t| of all accepted steps [m/s].
  double velocity_drift = 0;
  /// Condition number of the last factored matrix if MotionSettings::condition is true, see
  /// Integrator::condition().
  std::optional<double> condition;
  /// Smallest area ratio |r_m × r_n|, evaluated at every tenth step and at the stops.
  double smallest_area_ratio = 1;
  /// Times at which the joints of a model with rigid bodies were nearly dependent (condition above
  /// 1e6), evaluated at every 25th step. Of consecutive findings only the worst one is stored.
  std::vector<Conditioning> near_singular;
  /// Names of redundant joints, whose forces are not unique: the multipliers that the observer
  /// receives are those of least norm (fem/solve/redundancy.h).
  std::vector<std::string> redundant_joints;
};

/// Integrates the motion of a model from t = 0 (or from MotionSettings::memory) to its end. The
/// work space is left with the mesh of the end. Motions with separate work spaces are independent
/// of each other: they may run at the same time, and each is bit for bit the same as if it ran
/// alone.
///
/// Steps end at stops (see MotionSettings), at discontinuities and at changes of the mesh. A change
/// of the mesh at the end of the motion is not executed.
///
/// @param moving_roots  Moving-root mesh control of the plates: when elements at a moving root are
/// split
///                 or merged.
/// @throws Error (input) if adaptive steps are requested from an integrator without error estimate.
/// @throws Error (numerical) if a step fails, if the material collapses, or if a motion without
///         drives has gained more than EnergyGrowth::kLargest. The observer has received every step
///         before the failure. If rigid bodies are near a singular position, the message of a
///         failed step names the joints.
MotionResult integrate(Workspace& model, std::span<const MovingRoot> moving_roots,
                       const MotionSettings& settings, const MotionObserver& observe);

}  // namespace flexmorph::fem
