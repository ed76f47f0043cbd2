#pragma once

#include "optim/mmc/response.h"

/// Rows that others name; the table has more.
namespace flexmorph::mmc {

extern const ResponseRow kComplianceSum;    ///< Σ w_l C_l [J]
extern const ResponseRow kComplianceWorst;  ///< C_l of every load [J]
extern const ResponseRow kVolume;           ///< V, part of the domain [-]
extern const ResponseRow kStrainEnergy;     ///< mean of 2 U at the loads' times [J]
extern const ResponseRow kMass;             ///< m V, m the mass of the full domain [kg]

}  // namespace flexmorph::mmc
