#pragma once

#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "fem/element.h"
#include "fem/esl_set.h"
#include "geometry/outline.h"
#include "optim/mmc/mmc_problem.h"
#include "optim/optimizer.h"

namespace flexmorph::mmc {

/// The design problem of one body, over all cycles.
struct BodyProblem {
  std::string body;
  Grid grid;  ///< design mesh over the body at its longest
  fem::PlaneSection section;
  Design design;
  std::vector<Box> solid, empty;    ///< passive regions
  std::vector<TdfSettings> stages;  ///< continuation of the band, coarse to fine
  double max_volume = 0.5;
  double stiffness_void = 1e-4, mass_void = 1e-3;  ///< in dynamics
  ComplianceSettings compliance;
};

/// A design without blur: what its outlines enclose.
struct SharpDesign {
  VectorXd fractions;     ///< of true material per cell (n_cells)
  double compliance = 0;  ///< of the same loads
  double volume = 0;
  Connectivity connectivity;
};
SharpDesign sharp_design(const BodyProblem& problem, std::span<const Component> components,
                         Compliance& compliance);

/// Factors of the body for dynamics: the sharp picture with the void factors of dynamics.
fem::Factors dynamic_factors(const BodyProblem& problem, std::span<const Component> components);

/// Motion of the whole scene with these factors (one per problem) -> loads of every body.
using Simulate = std::function<std::vector<fem::EslSets>(std::span<const fem::Factors>)>;

/// One row of the history. Everything it refers to lives during the call only.
struct IterationReport {
  const BodyProblem& problem;
  int cycle = 1;
  int iteration = 0;  ///< over all stages of the cycle, from 1
  int evaluations = 0;
  const optim::Iterate& iterate;
  const MmcProblem& state;         ///< values at the iterate's x
  const Compliance::Value& value;  ///< compliance and its derivatives there
  Compliance& compliance;
  const SharpDesign* sharp = nullptr;  ///< when evaluated
};

/// What a body's design came to in one cycle.
struct BodyOutcome {
  std::string body;
  double compliance = 0, volume = 0;  ///< blurred, at the last stage's band
  SharpDesign sharp;
  double uniform_compliance = 0;  ///< same loads, uniform material of the same volume
  double kkt = 0, change = 0;
  int iterations = 0, evaluations = 0, n_loads = 0, n_right_hand_sides = 0;
  std::string stop;                      ///< why the optimizer stopped
  std::vector<double> load_compliances;  ///< F_i . u_i of the sharp design
  std::vector<double> energy_ratios;     ///< ½ F_i . u_i of the starting design / strain energy
};

/// A cycle as a whole, judged by the motion with its designs.
struct CycleVerdict {
  int cycle = 1;
  double strain_energy_integral = 0;  ///< ∫ U dt of that motion [J s]; smaller is better
  bool best = false;                  ///< of all cycles: its designs are the result
};

struct LoopSettings {
  int max_cycles = 1;
  double tolerance = 0.01;  ///< stop when every compliance changes by less between cycles
  int sharp_every = 25;     ///< iterations between sharp evaluations; 0: only at the end
  optim::Settings optimizer;
};

/// Looks on; false stops the run after the current iteration: the outcomes of that cycle are then
/// those of the bodies up to the one that was stopped.
struct LoopObserver {
  std::function<bool(const IterationReport&)> iteration;
  /// After the motion of a cycle: its loads, one entry per problem.
  std::function<void(int cycle, std::span<const fem::EslSets>)> loads;
  std::function<void(int cycle, std::span<const BodyOutcome>)> cycle;
  /// At the end of a run of several cycles.
  std::function<void(std::span<const CycleVerdict>)> verdict;
};

/// dynamics -> ESL -> design problem -> dynamics ..., until the designs rest (design.md section
/// 10). The designs of `problems` are left at the result; the outcome is that of the last cycle.
/// @throws Error (numerical) from dynamics or statics; rows reported before it stand.
std::vector<BodyOutcome> esl_loop(std::vector<BodyProblem>& problems, const Simulate& simulate,
                                  const LoopSettings& settings, const LoopObserver& observer);

}  // namespace flexmorph::mmc
