#pragma once

#include "cases/results/run_result.h"

/// Sentences on corrected cycles and certificates.
namespace flexmorph::cases {

/// Says the objective of a certificate, its KKT residual, the angle and what is left.
std::string certificate_words(const mmc::MotionCertificate& certificate);
/// Says what a corrected cycle found: objective, KKT residual, predicted and actual decrease.
std::string corrected_words(const mmc::CorrectedCycle& cycle);
/// Says the objective of the outlines before and after the corrected cycles.
std::string corrected_words(const CorrectedMotion& corrected);

}  // namespace flexmorph::cases
