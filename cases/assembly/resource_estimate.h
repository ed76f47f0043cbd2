#pragma once

#include <string>
#include <vector>

#include "cases/scene/scene.h"

namespace flexmorph::cases {

/// An item of the resource estimate: the memory or disk space of one component of a run.
struct ResourceItem {
  std::string what;  ///< Name for messages, such as "the design of 'plate'".
  std::string key;   ///< Key of the case that determines the size, see Scene::refuse().
  double bytes = 0;  ///< Size [bytes].
};

/// The size of a run, estimated from its scene before anything is built. All counts are doubles,
/// because they are exact up to 2^53 and no case can make them overflow.
struct ResourceEstimate {
  double steps = 0;      ///< Number of steps of a motion (adaptive: lower bound) or of a path.
  std::string step_key;  ///< Key of the case that determines the number of steps.
  double frames = 0;     ///< Number of frames of the motion for ParaView.

  /// Number of motions that a run keeps: with designs also those of uniform material and of finer
  /// meshes.
  double motions = 1;
  double iterations = 0;  ///< Upper bound of the number of iterations of all designs.
  std::vector<ResourceItem> memory, disk;  ///< Items of memory and of disk space.

  /// Returns the total memory [bytes].
  double memory_bytes() const;
  /// Returns the total disk space [bytes].
  double disk_bytes() const;
};

/// Returns the estimated size of a run. Memory is within a factor of 1.5 and disk space within a
/// factor of three of the measured ones for the shipped cases, also on finer meshes
/// (tests/cases/scene/resource_estimate_test.cpp). Files of designs are counted for all permitted
/// iterations, files of arc-length paths for all permitted equilibria.
ResourceEstimate estimate_resources(const Scene& scene);

/// Memory and disk space that a run may use; infinite where the system gives no limit.
struct Machine {
  double memory = 0;  ///< Memory of the machine, or the limit of the process if smaller [bytes].
  double disk = 0;    ///< Free disk space at the run folder [bytes].
};
/// Returns the limits of this machine for a run in a folder.
/// @param directory  a folder that may not exist yet; empty: the working directory
Machine this_machine(const std::string& directory = "");

/// Checks that a run fits the limits of a machine.
/// @throws Error (input) at the key that determines the size when a run has more steps than can be
///         counted, or needs more memory or disk space than available.
void require_disk(const Scene& scene, const Machine& machine);

/// Returns the message for a run that exhausts the memory: the estimate and the available memory.
std::string out_of_memory_text(const ResourceEstimate& resource_estimate);

/// Returns a number of bytes as text, such as "1.2 GB".
std::string bytes_text(double bytes);
/// Returns the time that an option of the command line gives as "120s", "2min", "1.5h", "30d", or
/// as a number of seconds without unit [s].
/// @throws Error (input) for another text, and for a time that is not positive.
double read_duration(const std::string& option, const std::string& text);
/// Returns a duration in seconds as text: "40 s", "12 min", "3.1 h", "8 days".
std::string duration_text(double seconds);

}  // namespace flexmorph::cases
