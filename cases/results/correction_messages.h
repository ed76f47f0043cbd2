#pragma once

#include "cases/results/run_result.h"

/// Messages on corrected cycles and optimality certificates.
namespace flexmorph::cases {

/// Returns a message on a certificate: objective, KKT residual, angle between the gradients of
/// motion and loads, and predicted decrease.
std::string certificate_text(const mmc::OptimalityCertificate& certificate);
/// Returns a message on a corrected cycle: objective, KKT residual, predicted and actual decrease.
std::string corrected_text(const mmc::CorrectedCycle& cycle);
/// Returns a message on the objective of the outlines before and after the corrected cycles.
std::string corrected_text(const CorrectedMotion& corrected);

}  // namespace flexmorph::cases
