#pragma once

#include <string>
#include <vector>

#include "cases/scene/scene.h"

/// What a [[measure]] may say: names, columns, and what can be measured of which body.
namespace flexmorph::cases {

/// Quantities that a [[measure]] may list, and their columns <body>.<column>:
///
/// temperature          temperature [K]: ΔT of a hot body
/// max_elastic_strain   max_elastic_strain [-]: largest entry of the elastic Green strain
///                      (FᵀF/s² - 1)/2, s = 1 + α ΔT, over Gauss points (of a plate: mid-surface)
/// midpoint_deflection  midpoint_deflection [m]: of the middle of the axis across the line between
///                      its ends, less that of the undeformed body; positive to the left of the
///                      line from root to free end
/// end_displacements    root_ux, root_uy, end_ux, end_uy [m]: of the ends of the axis
/// end_velocity         end_vx, end_vy [m/s]: of the free end
/// end_slopes           end_rx, end_ry [-]: |∂r/∂X|, |∂r/∂Y| at the free end
/// free_expansion       free_ux, free_uy [m], free_kinetic [J]: of the same body, free, unstressed
///                      and not turned: displacement α ΔT (X - X_c) of the free end against its
///                      centre of mass, and kinetic energy (α Ṫ)² ½ ∫ ρ |X - X_c|² dV; T (12), (19)
const std::vector<std::string>& measured_quantities();

/// A column that a quantity of a [[measure]] has: its name behind "<body>.", unit and meaning.
struct MeasuredColumn {
  const char *name, *unit, *meaning;
};
/// Columns of a quantity. @throws std::out_of_range for a quantity that does not exist.
const std::vector<MeasuredColumn>& columns_of_quantity(const std::string& quantity);

/// Why a quantity cannot be measured; empty where it can.
std::string refusal_of_measure(const Scene& scene, const Body& body, const std::string& quantity);

}  // namespace flexmorph::cases
