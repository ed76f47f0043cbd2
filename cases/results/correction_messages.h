#pragma once

#include "cases/results/run_result.h"

/// Sentences on corrected cycles and certificates.
namespace flexmorph::cases {

/// "strain energy in motion 0.0044 (sharp 0.0046), KKT residual 0.1, ..."
std::string certificate_words(const mmc::MotionCertificate& certificate);
/// "cycle 2 of the motion: J 0.0044, KKT residual 0.1, ..."
std::string corrected_words(const mmc::CorrectedCycle& cycle);
/// "corrected, J of the outlines on the cells of the case is 0.0044 instead of 0.0048"
std::string corrected_words(const CorrectedMotion& corrected);

}  // namespace flexmorph::cases
