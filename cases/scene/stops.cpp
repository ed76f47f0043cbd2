#include <cmath>

#include "cases/scene/joints/reading.h"
#include "fem/stop.h"

namespace flexmorph::cases {
namespace {

using io::Key;
using io::Table;
using Coordinate = fem::StopData::Coordinate;

const char* const kLengths = "stop, distance_stop";
const char* const kAngles = "angle_stop";

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
        .otherwise_as("there is none")
        .when(types)
        .says(sentence);
  };
  return {limit("least", "Below this it pushes; at least one of `least` and `most` is given."),
          limit("most", "Above this it pushes."),
          io::key("spring", "stiffness")
              .number(io::positive("a stiffness", per))
              .when(types)
              .says("Beyond the limit."),
          io::key("spring", "damping")
              .number(io::not_negative("a damping", rate))
              .otherwise(0.0)
              .when(types)
              .says("Beyond the limit; it never pulls."),
          io::key("spring", "onset")
              .number(io::not_negative("a width", u))
              .otherwise(0.0)
              .when(types)
              .says("Beyond the limit it takes this to become fully stiff: no kink of the force.")};
}
const StopKeys kOfLengths = stop_keys(kLengths, "m"), kOfAngles = stop_keys(kAngles, "rad");

void read_stop(const Table& t, const StopKeys& keys, Coordinate coordinate, Spring& spring) {
  fem::StopData data;
  data.coordinate = coordinate;
  if (t.has(keys.least)) data.least = t.number(keys.least);
  if (t.has(keys.most)) data.most = t.number(keys.most);
  if (!std::isfinite(data.least) && !std::isfinite(data.most))
    t.fail("a stop has a limit: `least`, `most` or both");
  if (data.least >= data.most) t.fail(keys.most, "`least` lies below `most`");
  if (coordinate == Coordinate::distance && std::isfinite(data.most) && data.most <= 0)
    t.fail(keys.most, "a distance is positive");
  data.stiffness = t.number(keys.stiffness);
  data.damping = t.number(keys.damping);
  data.onset = t.number(keys.onset);
  spring.own = data;
}

std::unique_ptr<fem::Link> make(const Spring& spring, const fem::MarkerPlace& a,
                                const fem::MarkerPlace& b, double start_angle) {
  fem::StopData data = std::any_cast<const fem::StopData&>(spring.own);
  data.start_angle = start_angle;
  return fem::make_stop(spring.name, a, b, data);
}

}  // namespace

extern const SpringRow kStop, kDistanceStop, kAngleStop;

const SpringRow kStop = {
    .name = "stop",
    .sentence = "Pushes where point b, along the first axis of a, is beyond a limit.",
    .points = true,
    .axes = true,
    .read = [](const Table& t, Spring& s) { read_stop(t, kOfLengths, Coordinate::along, s); },
    .make = make,
    .needs_axis_b = false};

const SpringRow kDistanceStop = {
    .name = "distance_stop",
    .sentence = "Pushes where two points are nearer or farther than a limit: a bumper, a rope.",
    .points = true,
    .axes = false,
    .read = [](const Table& t, Spring& s) { read_stop(t, kOfLengths, Coordinate::distance, s); },
    .make = make};

const SpringRow kAngleStop = {
    .name = "angle_stop",
    .sentence = "Turns back where the axes of two rigid bodies are turned beyond a limit.",
    .points = false,
    .axes = true,
    .read = [](const Table& t, Spring& s) { read_stop(t, kOfAngles, Coordinate::angle, s); },
    .make = make};

}  // namespace flexmorph::cases
