#pragma once

#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "optim/mmc/body_problem.h"
#include "optim/mmc/clean_up.h"
#include "optim/mmc/turnover.h"
#include "optim/optimizer.h"

namespace flexmorph::mmc {

/// One row of the history. Everything it refers to lives during the call only.
struct IterationReport {
  const BodyProblem& problem;
  int cycle = 1;
  int iteration = 0;  ///< over all stages of the cycle, from 1
  int evaluations = 0;
  const optim::Iterate& iterate;
  const MmcProblem& state;           ///< values at the iterate's x
  const LoadResponse::Value& value;  ///< compliance and its derivatives there
  LoadResponse& loads;
  const SharpDesign* sharp = nullptr;  ///< when evaluated
  /// What becomes of its components after this iteration.
  std::span<const ComponentEvent> events = {};
};

/// What a body's design came to in one cycle.
struct BodyOutcome {
  std::string body;
  double compliance = 0, volume = 0;  ///< blurred, at the last stage's band
  SharpDesign sharp;
  double worst_compliance = 0;    ///< largest of the loads, of the sharp design
  double uniform_compliance = 0;  ///< same loads, uniform material of the same volume
  double kkt = 0, change = 0;
  int iterations = 0, evaluations = 0, n_loads = 0, n_right_hand_sides = 0;
  int factorizations = 0;
  std::string stop;  ///< why the optimizer stopped
  std::vector<ComponentEvent> events;
  std::optional<CleanUp> clean_up;       ///< when a smallest feature was wanted
  std::vector<double> load_compliances;  ///< F_i . u_i of the sharp design
  std::vector<double> energy_ratios;     ///< ½ F_i . u_i of the starting design / strain energy
};

struct DesignSettings {
  int sharp_every = 25;  ///< iterations between sharp evaluations; 0: only at the end
  optim::Settings optimizer;
};

/// Looks on; false stops the run after the current iteration.
using IterationObserver = std::function<bool(const IterationReport&)>;

/// The design of one body under given loads, over all stages of its band. The design of `problem`
/// is left at the result.
/// @param going  comes back false when the observer stopped the run
/// @throws Error (numerical) from statics; rows reported before it stand.
BodyOutcome design_body(BodyProblem& problem, LoadResponse& loads, int cycle,
                        const DesignSettings& settings, const IterationObserver& observe,
                        bool& going);

}  // namespace flexmorph::mmc
