#pragma once

#include <span>
#include <string>
#include <vector>

#include "cases/scene/scene.h"
#include "optim/mmc/problem/body_problem.h"

namespace flexmorph::cases {

/// Supports and loads of a static scene, by the nodes of its design mesh.
struct StaticConditions {
  std::vector<fem::HeldUnknown> held;
  std::vector<mmc::LoadCase> loads;
};
/// @throws Error (input) for a place without a node that can be material: void regions are none.
StaticConditions static_conditions(const Scene& scene, const Grid& grid,
                                   std::span<const signed char> outside);
/// A load case of which a part acts where a design has no material.
struct LoadOnVoid {
  std::string name;
  double part = 0;  ///< of a force of the load, the largest such part [-]
};
/// Finds the load cases that act on void: a node carries a force when the cells around it have at
/// least half a cell of material. Cells of void are solved as a soft material, so that such a load
/// has an energy that the design does not have.
/// @param fractions  area fractions of the crisp design (n_cells)
std::vector<LoadOnVoid> loads_on_void(const Scene& scene, const mmc::BodyProblem& problem,
                                      const VectorXd& fractions);
/// Returns the hole or the void region that a disc is the bore of: centre and radius agree within
/// half a cell; null: the disc is no bore.
const std::vector<Vec2>* bore_of(const Scene& scene, const Disc& disc, const Grid& grid);
/// Gravity of a plate at rest; zero where the case gives none [m/s^2].
Vec2 weight_of(const Scene& scene);
/// Returns the middle lines of its grid that a design is symmetric to: those that `design.symmetry`
/// asks for, or all that domain, regions, supports, loads and start of a plate at rest are
/// symmetric to. A load case may be the image of another one, or the image of its opposite.
/// @param outside  cells outside of the domain (n_cells)
/// @param start    components of the start
/// @throws Error (input) that says what is not symmetric to a line that is asked for
mmc::Symmetry symmetry_of(const Scene& scene, const BodyDesign& design,
                          std::span<const signed char> outside,
                          const std::vector<Component>& start);
}  // namespace flexmorph::cases
