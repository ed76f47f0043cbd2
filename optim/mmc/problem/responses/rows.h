#pragma once

#include "optim/mmc/problem/response.h"

/// Rows that others name; the table has more.
namespace flexmorph::mmc {

/// p of power means (Σ f_l^p / m)^(1/p) that stand for the largest f_l: near it, and smooth.
constexpr double kPeakExponent = 8;

extern const ResponseRow kComplianceSum;    ///< Σ w_l C_l [J]
extern const ResponseRow kComplianceWorst;  ///< C_l of every load [J]
/// Power mean of C_l [J]. It is not in the table: problems on loads have bounds instead.
extern const ResponseRow kCompliancePeak;
extern const ResponseRow kVolume;        ///< V, part of the domain [-]
extern const ResponseRow kStrainEnergy;  ///< mean of 2 U at the loads' times [J]
/// Power mean of 2 U at the loads' times [J]: near the largest.
extern const ResponseRow kPeakStrainEnergy;
extern const ResponseRow kMass;  ///< m V, m the mass of the full domain [kg]

}  // namespace flexmorph::mmc
