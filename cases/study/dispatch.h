#pragma once

#include <optional>
#include <string>

namespace flexmorph::cases {

/// The destination of the rows of a study. Without any of these options they are run on this
/// machine.
struct Dispatch {
  bool commands = false;  ///< True if the command lines of the rows are printed and none is run.
  bool collect = false;   ///< True if the results that exist are collected and no row is run.

  /// Options of sbatch: a script that runs the rows as a job array of Slurm is printed.
  std::optional<std::string> sbatch = {};

  std::string hosts = {};    ///< File of machines for GNU parallel (--sshloginfile); or empty.
  bool shared_disk = false;  ///< True if the machines work in this folder, on a shared disk.
  std::string program = "flexmorph";  ///< Command that starts the program on every machine.

  /// Tells whether the study prints command lines or a script instead of results.
  bool prints() const { return commands || sbatch.has_value(); }
};

}  // namespace flexmorph::cases
