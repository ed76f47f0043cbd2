#pragma once

#include <map>
#include <string>
#include <vector>

#include "cases/check/check_cost.h"

namespace flexmorph::cases {

/// Smallest fraction of the permitted iterations that are left which a design is expected to take;
/// 12 shipped designs took 0.73 to 1 of all.
inline constexpr double kExpectedPart = 0.65;

/// A range of a duration [s].
struct SecondsRange {
  double least = 0, most = 0;  ///< Ends of the range [s].
};

/// The planned phases of a run, and the time that is left. Expected times of phases are corrected
/// by the speed of phases that have run on this machine: of the same kind if there is one, by the
/// mean of all kinds otherwise. All times are wall-clock seconds since the start of the run.
///
/// The result is a range: cycles and iterations may end early, and a phase that has not run yet may
/// take longer or shorter than expected.
class WorkPlan {
 public:
  /// Creates a plan without phases, which expects nothing.
  WorkPlan() = default;
  /// Creates a plan.
  /// @param phases   phases in the order in which they run
  /// @param designs  costs of the iterations of all designs
  /// @param threads  number of motions of a group that run at the same time
  WorkPlan(std::vector<PhaseCost> phases, std::vector<IterationCost> designs, int threads);

  /// Begins the next planned phase with a name; planned phases before it are over. Names that are
  /// not planned are ignored.
  void begin(const std::string& name, double now);
  /// Notes the progress of a phase, which begins if it is not running.
  /// @param done  completed units of work of the phase, in any unit
  /// @param left  range of the units that are left, in the same unit
  void advance(const std::string& name, double done, SecondsRange left, double now);

  /// Numbers of iterations of one body in the phase "design" of a cycle.
  struct Iterations {
    int done = 0, done_with_widths = 0;       ///< Iterations so far, and those with widths.
    int most_left = 0, left_with_widths = 0;  ///< Permitted iterations that follow.
  };
  /// Notes an iteration of a design.
  void iterate(const std::string& body, const Iterations& now_at, double now);

  /// Returns the time that is left [s].
  SecondsRange left(double now) const;
  /// Returns the completed fraction of the expected time of the run, 0 to 1.
  double completed(double now) const;

 private:
  struct Entry {
    PhaseCost cost;
    double begin = -1, end = -1;  // negative: not yet
    double done = 0;              // completed units
    SecondsRange units = {0, 0};  // units that are left
    double first_time = -1,
           first_done = 0;  // of the first report: what is built before has no units
    bool is_running() const { return begin >= 0 && end < 0; }
    bool is_over() const { return end >= 0; }
    double completed() const { return done > 0 ? done / (done + units.most) : 0; }
    /// Returns the time that all units take at the speed so far [s].
    double at_own_speed(double now) const {
      return (now - first_time) / (done - first_done) * (done + units.most);
    }
    bool tells_its_speed(double now) const;
  };
  /// Ratio of measured and expected times.
  struct Speed {
    double ratio = 1;
    double spread = 1;  // factor between the expected time and the ends of its range
  };
  Entry* running(const std::string& name);
  Speed speed_of(const Entry& entry, double now) const;
  SecondsRange left_of(const Entry& entry, double now) const;
  int last_certain_cycle() const;

  std::vector<Entry> entries_;
  std::vector<IterationCost> designs_;
  std::map<std::string, Iterations> iterations_;  // of each body in the running phase "design"
  int threads_ = 1;
};

/// Returns ", 30 to 45 s left" or ", about 40 s left"; empty if nothing is known.
std::string left_text(const SecondsRange& left);

}  // namespace flexmorph::cases
