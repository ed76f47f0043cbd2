#pragma once

#include <string>
#include <vector>

namespace flexmorph::cases {

/// Options of the command `verify`.
struct VerifyOptions {
  std::string case_name;  ///< Path of a case, name of a shipped case, or folder of a finished run.
  std::vector<std::string> parts;      ///< Drawings of parts, "BODY=FILE".
  std::string directory;               ///< Run folder; empty means runs/<name>_verify.
  std::vector<std::string> overrides;  ///< Overrides of keys of the case, "KEY=VALUE".
  int threads = 1;                     ///< Number of motions computed at the same time.
  bool quiet = false;                  ///< True if only warnings and errors are printed.
};

/// Replaces designs by redrawn parts and computes all results of a run without optimization: the
/// motion on cells, the mass, the body-fitted stress and deflection, and the widths. They are
/// compared with the results of uniform material and, if the folder of a finished run is given,
/// with the results of its design, which are computed in the same way. Every result belongs to the
/// loads of its own motion.
/// @return exit code: 0; 4 if interrupted; 5 if the part lacks material at supports, joints or
///         solid regions, is not usable, or violates an expectation of its case
/// @throws Error (input) for options, cases and parts that cannot be read; as run_case()
int verify_parts(const VerifyOptions& options);

}  // namespace flexmorph::cases
