#pragma once

#include <span>
#include <string>
#include <vector>

#include "cases/scene/scene.h"
#include "optim/mmc/problem/body_problem.h"

namespace flexmorph::cases {

/// The supports and the loads of a static scene at the nodes of its design mesh.
struct StaticConditions {
  std::vector<fem::HeldUnknown> held;  ///< Displacements that are held at zero.
  std::vector<mmc::LoadCase> loads;    ///< Load cases.
};
/// Returns the supports and the loads of a static scene on its design mesh.
/// @param outside  1 for cells outside of the domain (n_cells); empty: none
/// @throws Error (input) for a location without a node that can be material; nodes that only touch
///         void regions cannot.
StaticConditions static_conditions(const Scene& scene, const Grid& grid,
                                   std::span<const signed char> outside);
/// The nodes of a support or of a force of a static scene.
struct LocatedNodes {
  std::string what;  ///< Name for messages: "support 1", "load 'middle'".
  int count = 0;     ///< Number of nodes.
  Box extent;        ///< Bounding box of the nodes [m].
};
/// Finds the nodes of all supports and forces of a static scene.
/// @throws Error (input) as static_conditions() does.
std::vector<LocatedNodes> located_nodes(const Scene& scene, const Grid& grid,
                                        std::span<const signed char> outside);
/// A load case that acts partly where a design has no material.
struct LoadOnVoid {
  std::string name;  ///< Name of the load case.
  double part = 0;   ///< Largest fraction of a force of the load case that acts on void [-].
};
/// Finds the load cases that act on void. A node can carry a force when the area fractions of the
/// cells around it sum up to at least half a cell. Void cells are solved as a soft material, so
/// that a load on void leads to an energy that the design does not have.
/// @param fractions  area fractions of the crisp design (n_cells)
std::vector<LoadOnVoid> loads_on_void(const Scene& scene, const mmc::BodyProblem& problem,
                                      const VectorXd& fractions);
/// Returns the hole or the void region whose centre and radius agree with a disc within half a
/// cell; null if there is none, so that the disc is no bore.
const std::vector<Vec2>* bore_of(const Scene& scene, const Disc& disc, const Grid& grid);
/// Returns the acceleration of gravity of a static plate [m/s^2]; zero where the case gives none.
Vec2 weight_of(const Scene& scene);
/// Returns the symmetry lines of a design among the middle lines of its grid: those that
/// `design.symmetry` requires, or for "auto" all lines to which domain, regions, supports, loads
/// and start of a static plate are symmetric. A load case may be the mirror image of another load
/// case or of its opposite.
/// @param outside  1 for cells outside of the domain (n_cells); empty: none
/// @param start    components of the start
/// @throws Error (input) that names the input which is not symmetric to a required line
mmc::Symmetry symmetry_of(const Scene& scene, const BodyDesign& design,
                          std::span<const signed char> outside,
                          const std::vector<Component>& start);
}  // namespace flexmorph::cases
