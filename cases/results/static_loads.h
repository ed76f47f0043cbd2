#pragma once

#include <span>
#include <string>
#include <vector>

#include "cases/results/parts/verified_outline.h"
#include "cases/scene/scene.h"

/// Results of the load cases of a static plate, for its final design.
namespace flexmorph::cases {

/// The result of one load case: a row of loads/DOMAIN.csv.
struct StaticLoad {
  std::string name;                 ///< Name of the load case.
  double weight = 1;                ///< Weight of the load case [-].
  double compliance = 0;            ///< Compliance of the cells of the crisp design [J].
  bool active = false;              ///< True if the compliance is within 1 % of the largest one.
  double strain_energy = 0;         ///< Strain energy, computed by the model `source` [J].
  double largest_displacement = 0;  ///< Largest displacement, by the model `source` [m].
  double largest_stress = 0;        ///< Largest von Mises stress, by the model `source` [Pa].
  std::string source;               ///< Model of the three results: "outline" or "cells".

  /// Displacements of the nodes of the cells of the crisp design (2 n_nodes) [m]; empty if the
  /// results come from the outline.
  VectorXd displacement;
};

/// Returns the results of all load cases of a static plate, in the order of the domain. The results
/// come from the verification of the outline if it has numbers, otherwise from the cells of the
/// crisp design. The displacement is the largest one of any point of the material. The stress of an
/// outline is the largest one away from supports and loads; the stress of cells is the largest one
/// at the centres of cells that are at least half full.
/// @param loads    evaluator of the load cases on the cells
/// @param outcome  outcome of the final design
/// @param outline  verification of the outline; null means that there is none
/// @throws Error (numerical) from statics
std::vector<StaticLoad> static_loads_of(const Domain& domain, const mmc::BodyProblem& problem,
                                        mmc::ComplianceEvaluator& loads,
                                        const mmc::BodyOutcome& outcome,
                                        const VerifiedOutline* outline);

}  // namespace flexmorph::cases
