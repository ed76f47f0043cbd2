#include "fem/dynamics/starts/inverse_kinematics.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "fem/body_joints.h"
#include "fem/solve/kinematics.h"

namespace flexmorph::fem {
namespace {

constexpr int kIntervals = 2000;  // number of intervals between samples

/// Returns the quintic between two samples that has value, rate and acceleration of both (Hermite).
/// @param h  Time between the samples [s].   @param s  Local coordinate, 0 at a and 1 at b.
Motion quintic(const Motion& a, const Motion& b, double h, double s) {
  const double d = b.value - a.value - h * a.rate - 0.5 * h * h * a.acceleration,
               d1 = h * (b.rate - a.rate - h * a.acceleration),
               d2 = h * h * (b.acceleration - a.acceleration);
  const double c3 = 10 * d - 4 * d1 + 0.5 * d2, c4 = -15 * d + 7 * d1 - d2,
               c5 = 6 * d - 3 * d1 + 0.5 * d2;
  const double t = s * h;
  return {a.value + t * (a.rate + 0.5 * t * a.acceleration) + s * s * s * (c3 + s * (c4 + s * c5)),
          a.rate + t * a.acceleration + s * s * (3 * c3 + s * (4 * c4 + s * 5 * c5)) / h,
          a.acceleration + s * (6 * c3 + s * (12 * c4 + s * 20 * c5)) / (h * h)};
}

/// Returns the mechanism with the drives released and the body driven along its path.
RigidMechanism led_along(RigidMechanism mechanism, const RigidTrajectory& path,
                         std::span<const std::string> drives) {
  RigidMechanism out = released(std::move(mechanism), [&](const MechanismJoint& joint) {
    return std::find(drives.begin(), drives.end(), joint.drive) != drives.end();
  });
  const auto lead = [&](std::unique_ptr<Joint> joint) {
    out.joints.push_back({.joint = std::move(joint), .prescribes = true});
  };
  lead(make_point_drive("trajectory", {path.body},
                        [x = path.x, y = path.y](double t) {
                          return std::vector{x(t), y(t)};
                        },
                        {}));
  lead(make_angle_drive("angle of the trajectory", {}, {path.body}, path.angle));
  return out;
}

}  // namespace

std::vector<std::function<Motion(double)>> inverse_kinematics(RigidMechanism mechanism,
                                                              const RigidTrajectory& trajectory,
                                                              std::span<const std::string> drives) {
  RigidKinematics model(led_along(std::move(mechanism), trajectory, drives));
  State start = model.guess();
  model.assemble(start);
  KinematicsSettings settings;
  settings.most_steps = 5 * kIntervals;
  Kinematics motion(model.model(), start, settings);
  std::vector<std::vector<Motion>> samples(drives.size());
  const double h = trajectory.end / kIntervals;
  for (int k = 0; k <= kIntervals; ++k) {
    const State& x = motion.at(k * h);
    for (size_t i = 0; i < drives.size(); ++i) {
      Motion m = model.coordinate_of(drives[i], x);
      // Multiples of 360 degrees are removed from jumps of angles. Lengths are not affected,
      // because they never jump by 3.14 m.
      if (k > 0) {
        const double turn = 2 * std::numbers::pi;
        const double jump = m.value - samples[i].back().value;
        m.value -= turn * std::round(jump / turn);
      }
      samples[i].push_back(m);
    }
  }
  std::vector<std::function<Motion(double)>> out;
  for (std::vector<Motion>& sample : samples)
    out.emplace_back([h, sample = std::move(sample)](double t) {
      const auto k = static_cast<size_t>(std::clamp(std::floor(t / h), 0.0, kIntervals - 1.0));
      return quintic(sample[k], sample[k + 1], h, t / h - static_cast<double>(k));
    });
  return out;
}

}  // namespace flexmorph::fem
