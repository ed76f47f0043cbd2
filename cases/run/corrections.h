#pragma once

#include "cases/results/run_result.h"
#include "cases/run/run_context.h"

/// Designs and the gradient of the motion itself: corrected cycles, the certificate.
namespace flexmorph::cases {

/// Corrects designs by the gradient of the motion (Cycle::correction). Where the motion with their
/// outlines, on the cells of the case, improves, the outcomes and the loads are replaced. The
/// design before is kept as a drawing; cycles.csv is written after every cycle. Cycle::cell sets
/// the size of the cells of these cycles.
/// @param loads  of the designs; replaced with them
/// @throws Interrupted; as mmc::correct_designs()
void correct_by_motion(const RunContext& run, std::vector<fem::EslSets>& loads,
                       DesignResult& design);

/// Certifies designs under these loads, and writes certificate.csv (of several bodies
/// certificate_<body>.csv) and a picture for every body.
/// @throws Interrupted; as mmc::certify()
mmc::MotionCertificate certify_by_motion(const RunContext& run, const Certify& settings,
                                         std::span<const fem::EslSets> loads,
                                         std::span<const mmc::BodyProblem> designs);

/// Options of the command `certify`.
struct CertifyOptions {
  std::string directory;               ///< of a finished run
  std::vector<std::string> overrides;  ///< KEY=VALUE
  bool quiet = false;
};

/// Certifies the designs of a finished run, and writes the certificate into its folder.
/// @return exit code: 0, 4 interrupted. @throws Error; (input) where there is no such run.
int certify_run(const CertifyOptions& options);

}  // namespace flexmorph::cases
