#pragma once

#include "optim/mmc/problem/response.h"

/// Rows of the table of responses that other files refer to; the table has more rows.
namespace flexmorph::mmc {

/// Exponent p of power means (Σ f_l^p / m)^(1/p), which are smooth and close to the largest f_l.
constexpr double kPeakExponent = 8;

extern const ResponseRow kComplianceSum;    ///< Weighted sum of the compliances, Σ w_l C_l [J].
extern const ResponseRow kComplianceWorst;  ///< Compliance C_l of every load [J].

/// Power mean of the compliances C_l [J]. It is not in the table, because problems under loads use
/// a bound on every C_l instead.
extern const ResponseRow kCompliancePeak;
extern const ResponseRow kVolume;        ///< Volume fraction V of the domain [-].
extern const ResponseRow kStrainEnergy;  ///< Mean of 2 U over the load times [J].

/// Power mean of 2 U over the load times [J], which is close to the largest value.
extern const ResponseRow kPeakStrainEnergy;
extern const ResponseRow kMass;  ///< Mass m V, with the mass m of the full domain [kg].

}  // namespace flexmorph::mmc
