#pragma once

#include "cases/output/run_folder.h"
#include "io/plots.h"

namespace flexmorph::cases {

/// Adds panels of measured columns (see BodyMeasures) over x: temperature, norms of the slopes,
/// displacements, velocities, strains, deflections; T Figs. 4 to 10 and 14.
void add_measured(const std::vector<double>& x, const std::string& x_label,
                  const std::vector<Column>& columns, io::Figure& figure);

/// The measured columns of a motion over time, with the kinetic energy of the model beside those of
/// free bodies: T Fig. 12. Empty without measured columns.
std::string measured_plot(const MotionRecord& motion);

}  // namespace flexmorph::cases
