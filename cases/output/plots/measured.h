#pragma once

#include "cases/results/motion_record.h"
#include "io/plots.h"

namespace flexmorph::cases {

/// Adds panels of the measured columns of a table over x: temperature, lengths of the position
/// gradients, displacements, velocities, strains, deflections; T Figs. 4 to 10 and 14.
void add_measured(const std::vector<double>& x, const std::string& x_label, const Series& table,
                  io::Figure& figure);

/// Draws the measured columns of a motion over time, with the kinetic energy of the model beside
/// those of free bodies: T Fig. 12. Empty without measured columns.
std::string measured_plot(const MotionRecord& motion);

}  // namespace flexmorph::cases
