#pragma once

#include "cases/output/report.h"
#include "cases/run/motion_run.h"
#include "cases/run/progress.h"

/// What the motion itself does to designs and says of them: corrected cycles, the certificate.
namespace flexmorph::cases {

/// Corrects the designs of the report (Cycle::correction); where the motion with their outlines, on
/// the cells of the case, is better by it, its outcomes and the loads are those of the result. The
/// design before is kept as a drawing. Writes cycles.csv as it goes. With Cycle::cell designs, too,
/// are on these cells meanwhile.
/// @throws Interrupted; as mmc::correct_designs()
void correct_by_motion(const Scene& scene, const std::function<bool()>& go_on,
                       std::vector<fem::EslSets>& loads, RunFolder& folder, Progress& progress,
                       RunReport& report);

/// The certificate of the designs of the report under these loads: into the report, and for every
/// body into certificate.csv (of several bodies certificate_<body>.csv) and a picture.
/// @throws Interrupted; as mmc::certify()
void certify_by_motion(const Scene& scene, const Certify& wishes,
                       std::span<const fem::EslSets> loads, const std::function<bool()>& go_on,
                       RunFolder& folder, Progress& progress, RunReport& report);

/// One line: J, KKT residual, angle, what is left.
std::string certificate_words(const mmc::MotionCertificate& certificate);
/// "gradient of J and of the loads 12 degrees apart, ..." of a cycle.
std::string corrected_words(const mmc::CorrectedCycle& cycle);

std::string corrected_words(const CorrectedMotion& corrected);

struct CertifyOptions {
  std::string directory;               ///< of a finished run
  std::vector<std::string> overrides;  ///< KEY=VALUE
  bool quiet = false;
};

/// Certifies the designs of a finished run, and writes the certificate into its folder.
/// @return exit code: 0, 4 interrupted. @throws Error; (input) where there is no such run.
int certify_run(const CertifyOptions& options);

}  // namespace flexmorph::cases
