#pragma once

#include "cases/results/run_result.h"
#include "cases/run/run_context.h"

/// Corrected design cycles and optimality certificates. Both use the gradient of the motion itself
/// instead of the gradient under equivalent static loads.
namespace flexmorph::cases {

/// Corrects designs by the gradient of the motion (Cycle::correction). The outcomes and the loads
/// are replaced if the objective of the motion with the outlines, on the cells of the case,
/// improves. The drawing of the design before the correction is kept in the folder; cycles.csv is
/// written after every cycle. Cycle::cell sets the size of the cells of the corrected cycles.
/// @param loads  loads of the designs; replaced together with the designs
/// @throws Interrupted; as mmc::correct_designs()
void correct_by_motion(const RunContext& run, std::vector<fem::EslSets>& loads,
                       DesignResult& design);

/// Certifies designs under the given loads, and writes certificate.csv (for several bodies
/// certificate_<body>.csv) and a picture for every body.
/// @throws Interrupted; as mmc::certify()
mmc::OptimalityCertificate certify_by_motion(const RunContext& run, const Certify& settings,
                                             std::span<const fem::EslSets> loads,
                                             std::span<const mmc::BodyProblem> designs);

/// Options of the command `certify`.
struct CertifyOptions {
  std::string directory;               ///< Folder of a finished run.
  std::vector<std::string> overrides;  ///< Overrides of keys of the case, "KEY=VALUE".
  bool quiet = false;                  ///< True if only the certificate is printed.
};

/// Certifies the designs of a finished run, and writes the certificate into its folder.
/// @return exit code: 0, or 4 if the run was interrupted
/// @throws Error of the run; Error (input) if the folder contains no finished run
int certify_run(const CertifyOptions& options);

}  // namespace flexmorph::cases
