#pragma once

#include <string>
#include <vector>

#include "cases/scene/scene.h"

/// The quantities that a [[measure]] may list: their names, their columns, and the bodies for which
/// they are defined.
namespace flexmorph::cases {

/// Returns the names of all quantities that a [[measure]] may list. Their columns are named
/// <body>.<column>:
///
/// temperature          temperature [K]: temperature rise ΔT of a heated body
/// max_elastic_strain   max_elastic_strain [-]: largest entry of the elastic Green strain
///                      (FᵀF/s² - 1)/2, s = 1 + α ΔT, over Gauss points (of a plate: mid-surface)
/// midpoint_deflection  midpoint_deflection [m]: distance of the middle of the axis from the line
///                      between the ends of the axis, minus this distance in the undeformed body;
///                      positive to the left of the line from root to free end
/// end_displacements    root_ux, root_uy, end_ux, end_uy [m]: displacements of both ends of the
///                      axis
/// end_velocity         end_vx, end_vy [m/s]: velocity of the free end
/// end_slopes           end_rx, end_ry [-]: |∂r/∂X|, |∂r/∂Y| at the free end
/// free_expansion       free_ux, free_uy [m], free_kinetic [J]: values of an identical body
/// that is
///                      free, unstressed and not turned: displacement α ΔT (X - X_c) of the free
///                      end relative to the centre of mass, and kinetic energy
///                      (α Ṫ)² ½ ∫ ρ |X - X_c|² dV; T (12), (19)
const std::vector<std::string>& measured_quantities();

/// Describes one column of a measured quantity.
struct MeasuredColumn {
  const char *name, *unit, *meaning;  ///< Name after "<body>.", unit, and meaning of the column.
};
/// Returns the columns of a quantity. @throws std::out_of_range for a quantity that does not exist.
const std::vector<MeasuredColumn>& columns_of_quantity(const std::string& quantity);

/// Returns the reason why a quantity of a body cannot be measured; empty if it can.
std::string refusal_of_measure(const Scene& scene, const Body& body, const std::string& quantity);

}  // namespace flexmorph::cases
