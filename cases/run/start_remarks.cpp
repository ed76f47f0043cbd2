#include "cases/run/start_remarks.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "fem/dynamics/starts/driven_frame.h"
#include "fem/solve/redundancy.h"
#include "io/files.h"

namespace flexmorph::cases {
namespace {

constexpr double kReportedLength =
    1e-9;  // smallest reported difference, above round-off of assembly
// Relative error, with respect to the largest velocity, of the finite differences that compute the
// rates of a prestretched start.
constexpr double kDifference = 1e-6;
constexpr size_t kMaxListed = 5;  // largest number of bodies that are named

/// Returns a list of names for messages: "a, b and 3 more".
std::string list_of(const std::vector<std::string>& all) {
  std::string out;
  for (size_t i = 0; i < std::min(all.size(), kMaxListed); ++i) out += (i > 0 ? ", " : "") + all[i];
  if (all.size() > kMaxListed) out += " and " + std::to_string(all.size() - kMaxListed) + " more";
  return out;
}

std::string moved_text(const RigidBody& body, const fem::FrameMotion& frame) {
  const double by = (frame.origin - body.position).norm(),
               turn = std::remainder(frame.angle - body.angle, 2 * std::numbers::pi);
  std::string out;
  if (by > kReportedLength) out = "by " + io::to_text(by, 3) + " m";
  if (std::abs(turn) > kReportedLength)
    out += (out.empty() ? "by " : " and ") + io::to_text(turn, 3) + " rad";
  return out.empty() ? "" : "'" + body.name + "' " + out;
}

/// Returns a message on velocities of a rigid body that differ from the given ones; empty if none
/// does.
/// @param largest  is increased to the largest difference from a given velocity of a point [m/s]
std::string speed_text(const RigidBody& body, const fem::FrameMotion& frame, double& largest) {
  std::string out;
  if (body.velocity)
    if (const double by = (frame.origin_rate - *body.velocity).norm(); by > kReportedLength) {
      out = "velocity [" + io::to_text(frame.origin_rate.x(), 6) + ", " +
            io::to_text(frame.origin_rate.y(), 6) + "] (difference " + io::to_text(by, 3) + " m/s)";
      largest = std::max(largest, by);
    }
  if (body.angular_velocity)
    if (const double by = std::abs(frame.angle_rate - *body.angular_velocity); by > kReportedLength)
      out += (out.empty() ? "" : ", ") + ("angular_velocity " + io::to_text(frame.angle_rate, 6)) +
             " (difference " + io::to_text(by, 3) + " rad/s)";
  return out.empty() ? "" : "'" + body.name + "' " + out;
}

}  // namespace

std::vector<std::string> start_remarks(const Scene& scene, const fem::Model& model,
                                       const fem::State& x, double change) {
  std::vector<std::string> moved, faster, out;
  double largest = 0;
  for (const RigidBody& body : scene.rigid_bodies) {
    const fem::FrameMotion frame = fem::frame_of(model.body(body.name), x);
    if (body.is_placed)
      if (std::string words = moved_text(body, frame); !words.empty()) moved.push_back(words);
    if (std::string words = speed_text(body, frame, largest); !words.empty())
      faster.push_back(words);
  }
  if (!moved.empty())
    out.push_back("At the start, joints moved bodies from their positions in the case: " +
                  list_of(moved));
  if (!faster.empty())
    out.push_back("The velocities at the start differ from the velocities in the case: " +
                  list_of(faster));
  const double speed = model.scales().cwiseProduct(x.v).lpNorm<Eigen::Infinity>();
  if (change > kReportedLength + kDifference * speed)
    out.push_back("The velocities at the start were changed by up to " +
                  io::to_text(std::max(change, largest), 3) +
                  " m/s, because the joints do not allow the original velocities");
  if (const std::vector<std::string> joints = fem::redundant_joints(model); !joints.empty())
    out.push_back(
        "The forces of these joints are not unique, because one or more of the joints are "
        "redundant: " +
        list_of(joints) + ". The forces with the least sum of squares are given");
  return out;
}

}  // namespace flexmorph::cases
