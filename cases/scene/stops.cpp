#include <cmath>

#include "cases/scene/joints/reading.h"
#include "fem/stop.h"

namespace flexmorph::cases {
namespace {

using io::Key;
using io::Table;
using Coordinate = fem::StopData::Coordinate;

const char* const kLengths = "`type` is \"stop\" or \"distance_stop\"";
const char* const kAngles = "`type = \"angle_stop\"`";

/// Keys of the numbers of a stop, in metres or in radians.
struct StopKeys {
  const Key &least, &most, &stiffness, &damping, &onset;
};

StopKeys stop_keys(const char* types, const char* unit) {
  const std::string u = unit, per = u == "m" ? "N/m" : "N m/rad",
                    rate = u == "m" ? "N s/m" : "N m s/rad";
  const auto limit = [&](const char* name, const char* sentence) -> const Key& {
    return io::key("spring", name)
        .number(io::any_number("a limit", u))
        .otherwise_as("no limit")
        .when(types)
        .description(sentence);
  };
  return {
      limit("least",
            "Lower limit, below which the stop pushes back; `least`, `most` or both are required."),
      limit("most",
            "Upper limit, above which the stop pushes back; `least`, `most` or both are required."),
      io::key("spring", "stiffness")
          .number(io::positive("a stiffness", per))
          .when(types)
          .description("Stiffness of the stop beyond a limit."),
      io::key("spring", "damping")
          .number(io::not_negative("a damping", rate))
          .otherwise(0.0)
          .when(types)
          .description("Damping coefficient of the stop beyond a limit. The stop never pulls."),
      io::key("spring", "onset")
          .number(io::not_negative("a width", u))
          .otherwise(0.0)
          .when(types)
          .description("Width of the transition beyond a limit, in which the stiffness rises from "
                       "0 to `stiffness`.")};
}
const StopKeys kOfLengths = stop_keys(kLengths, "m"), kOfAngles = stop_keys(kAngles, "rad");

void read_stop(const Table& t, const StopKeys& keys, Coordinate coordinate, Spring& spring) {
  fem::StopData data;
  data.coordinate = coordinate;
  if (t.has(keys.least)) data.least = t.number(keys.least);
  if (t.has(keys.most)) data.most = t.number(keys.most);
  if (!std::isfinite(data.least) && !std::isfinite(data.most))
    t.fail("a stop needs a limit: `least`, `most` or both");
  if (data.least >= data.most)
    t.fail(keys.most, "an upper limit `most` is greater than the lower limit `least`");
  if (coordinate == Coordinate::distance && std::isfinite(data.most) && data.most <= 0)
    t.fail(keys.most, "a distance is positive");
  data.stiffness = t.number(keys.stiffness);
  data.damping = t.number(keys.damping);
  data.onset = t.number(keys.onset);
  spring.own = data;
}

std::unique_ptr<fem::ForceElement> make(const Spring& spring, const fem::MarkerLocation& a,
                                        const fem::MarkerLocation& b, double start_angle) {
  fem::StopData data = std::any_cast<const fem::StopData&>(spring.own);
  data.start_angle = start_angle;
  return fem::make_stop(spring.name, a, b, data);
}

}  // namespace

extern const SpringRow kStop, kDistanceStop, kAngleStop;

const SpringRow kStop = {
    .name = "stop",
    .sentence =
        "A stop that pushes point b back if its position along the first axis of a is beyond a "
        "limit.",
    .points = true,
    .axes = true,
    .read = [](const Table& t, Spring& s) { read_stop(t, kOfLengths, Coordinate::along, s); },
    .make = make,
    .needs_axis_b = false};

const SpringRow kDistanceStop = {
    .name = "distance_stop",
    .sentence = "A stop that limits the distance between two points, such as a bumper or a rope.",
    .points = true,
    .axes = false,
    .read = [](const Table& t, Spring& s) { read_stop(t, kOfLengths, Coordinate::distance, s); },
    .make = make};

const SpringRow kAngleStop = {
    .name = "angle_stop",
    .sentence = "A stop that limits the angle between the first axes of two rigid bodies.",
    .points = false,
    .axes = true,
    .read = [](const Table& t, Spring& s) { read_stop(t, kOfAngles, Coordinate::angle, s); },
    .make = make};

}  // namespace flexmorph::cases
