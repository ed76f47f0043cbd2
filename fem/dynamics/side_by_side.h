#pragma once

#include <functional>
#include <string>
#include <vector>

namespace flexmorph::fem {

/// Something that takes a while and needs nothing of what runs beside it: a motion with a model, a
/// work space and files of its own.
struct Job {
  std::string name;  ///< begins the message of its errors: "the motion of uniform material"
  double cost = 1;   ///< about, against the others
  /// @param go_on  false: somebody else failed, end early
  std::function<void(const std::function<bool()>& go_on)> run;
};

/// Runs jobs: one after the other by a single thread, else by `threads` at a time, dear ones first.
/// Those at a time have one thread of OpenMP each.
///
/// A job that throws lets those before it in the list run to their end and stops those behind it
/// (they are asked by `go_on`, or never begun): so all jobs up to the first one that fails have
/// done what they would have done one after the other.
/// @throws what the first one in the list threw that did; an Error says its name.
void side_by_side(int threads, const std::vector<Job>& jobs);

}  // namespace flexmorph::fem
