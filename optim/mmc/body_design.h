#pragma once

#include <functional>
#include <span>
#include <string>
#include <vector>

#include "fem/element.h"
#include "geometry/picture.h"
#include "optim/mmc/mmc_problem.h"
#include "optim/mmc/responses.h"
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
  Goal goal;
  double stiffness_void = 1e-4, mass_void = 1e-3;  ///< in dynamics
  ComplianceSettings compliance;
  std::vector<Vec2> domain;              ///< polygon; empty: the whole grid
  std::vector<signed char> outside;      ///< cells_outside() of it; empty: none
  std::vector<std::vector<int>> places;  ///< cells of loaded and held places; empty: both ends
};

/// Chain of factors of the problem's cells.
Ersatz ersatz_of(const BodyProblem& problem);
/// Area fractions of true material (n_cells), 0 outside of the domain.
VectorXd fractions_of(const BodyProblem& problem, std::span<const Component> components);

/// A design without blur: what its outlines enclose.
struct SharpDesign {
  VectorXd fractions;     ///< of true material per cell (n_cells)
  double compliance = 0;  ///< of the same loads: weighted sum, or the largest
  double volume = 0;
  Connectivity connectivity;
};
SharpDesign sharp_design(const BodyProblem& problem, std::span<const Component> components,
                         LoadResponse& loads);

/// Factors of the body for dynamics: the sharp picture with the void factors of dynamics.
fem::Factors dynamic_factors(const BodyProblem& problem, std::span<const Component> components);

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
  std::string stop;                      ///< why the optimizer stopped
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
