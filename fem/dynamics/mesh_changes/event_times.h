#pragma once

#include <vector>

namespace flexmorph::fem {

struct MotionSettings;

/// An event time of a motion: a time at which a step must end.
struct EventTime {
  double t = 0;                ///< Time [s].
  bool stop = false;           ///< True if the observer of the motion needs the state at this time.
  bool discontinuity = false;  ///< True if accelerations and forces may jump at this time.
};

/// Returns all event times of a motion in ascending order: the stops (for equal steps), the
/// discontinuities between start and end, and the end. A discontinuity and any event that is closer
/// to it than `near` [s] become one event, at the time of the last discontinuity.
std::vector<EventTime> event_times(const MotionSettings& settings, double near);

/// Returns the time at which the last step before a discontinuity ends: earlier than the
/// discontinuity by more than the round-off of times.
double just_before(double discontinuity);

}  // namespace flexmorph::fem
