#pragma once

#include <span>
#include <string>
#include <vector>

#include "cases/results/verified_outline.h"
#include "cases/scene/scene.h"

/// What the load cases of a plate at rest do to its final design.
namespace flexmorph::cases {

/// The result of one load case: a row of loads/<domain>.csv.
struct StaticLoad {
  std::string name;
  double weight = 1;
  double compliance = 0;            ///< of the cells of the crisp design [J]
  bool active = false;              ///< whether it is within 1 % of the largest compliance
  double strain_energy = 0;         ///< by `source` [J]
  double largest_displacement = 0;  ///< by `source` [m]
  double largest_stress = 0;        ///< von Mises, by `source` [Pa]
  std::string source;               ///< "outline" or "cells"
};

/// Returns the results of all load cases of a plate at rest, in their order: those of the
/// verification of the outline where it has numbers, otherwise those of the cells of the crisp
/// design. Displacements are the largest of any point of the material. The stress of an outline is
/// the largest one away from supports and loads, that of cells the largest one at the centres of
/// cells that are at least half full.
/// @param outline  null: there is no verification
/// @throws Error (numerical) from statics
std::vector<StaticLoad> static_loads_of(const Domain& domain, const mmc::BodyProblem& problem,
                                        mmc::ComplianceEvaluator& loads,
                                        const mmc::BodyOutcome& outcome,
                                        const VerifiedOutline* outline);

}  // namespace flexmorph::cases
