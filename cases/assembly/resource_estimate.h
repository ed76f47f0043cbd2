#pragma once

#include <string>
#include <vector>

#include "cases/scene/scene.h"

namespace flexmorph::cases {

/// What one part of a run takes, and the key whose number is to blame for it.
struct Share {
  std::string what;  ///< "steps", "the design of 'plate'"
  std::string key;   ///< see Scene::refuse()
  double bytes = 0;
};

/// The size of a run, from the scene alone, before anything is built. All counts are doubles: exact
/// up to 2^53, and nothing a case may say overflows them.
struct Extent {
  double steps = 0;       ///< of a motion (adaptive: at the least), or of a path
  std::string step_key;   ///< the key that says how many
  double frames = 0;      ///< of the motion, for ParaView
  double motions = 1;     ///< that are kept: of designs with uniform material and finer meshes
  double iterations = 0;  ///< of designs, at most
  std::vector<Share> memory, disk;

  double memory_bytes() const;
  double disk_bytes() const;
};

/// Memory and disk are within a factor of two of what was measured of shipped cases and of such on
/// finer meshes (tests/cases/scene/resource_estimate_test.cpp). Of designs the files are those of
/// all iterations that are allowed, of paths along their arc those of all equilibria.
Extent extent_of(const Scene& scene);

/// Bytes that a run may take; infinite where the system does not say.
struct Machine {
  double memory = 0;  ///< of the machine, or less where its administrator allows less
  double disk = 0;    ///< free, where the run folder will be
};
/// @param directory  a folder that may not exist yet; empty: the working directory
Machine this_machine(const std::string& directory = "");

/// @throws Error (input) at the key to blame when a run has more steps than can be counted, or
///         takes more memory or disk than there is.
void require_room(const Scene& scene, const Machine& machine);

/// What is said when memory runs out all the same: the estimate, and what there is.
std::string out_of_memory_words(const Extent& extent);

/// "1.2 GB".
std::string bytes_text(double bytes);
/// "40 s", "12 min", "3.1 h", "8 days".
std::string duration_text(double seconds);

}  // namespace flexmorph::cases
