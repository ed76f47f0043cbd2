#pragma once

#include <string>
#include <vector>

namespace flexmorph::cases {

/// Options of the command `verify`.
struct VerifyOptions {
  std::string case_name;           ///< path, name of a shipped case, or folder of a finished run
  std::vector<std::string> parts;  ///< BODY=FILE
  std::string directory;           ///< of the run folder; empty: runs/<name>_verify
  std::vector<std::string> overrides;  ///< KEY=VALUE
  int threads = 1;
  bool quiet = false;
};

/// Puts redrawn parts in place of designs, and finds all numbers of a run with nothing optimized:
/// motion on cells, mass, body-fitted stress and deflection, widths. Beside them are those of
/// uniform material and, of the folder of a finished run, those of its design, found in the same
/// way: each under the loads of its own motion.
/// @return exit code: 0, 4 interrupted, 5 where the part lacks material at supports, joints or
///         solid regions, is of no use, or misses an expectation of its case
/// @throws Error (input) for options, cases and parts that cannot be read; as run_case()
int verify_parts(const VerifyOptions& options);

}  // namespace flexmorph::cases
