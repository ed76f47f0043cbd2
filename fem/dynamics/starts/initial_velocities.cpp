#include <algorithm>
#include <cmath>

#include "fem/body_joints.h"
#include "fem/dynamics/integrators/integrator.h"
#include "fem/dynamics/starts/rigid_kinematics.h"
#include "fem/solve/assembly.h"
#include "geometry/text.h"

namespace flexmorph::fem {
namespace {

/// A given velocity: the name of the joint that drives the body with it, and its text in messages.
struct Given {
  std::string joint;
  const MechanismBody* body;
  std::string words;
};

std::string text_of(double value, int digits = 6) { return formatted("%.*g", digits, value); }

/// Adds joints that drive all bodies with their given velocities, and returns these velocities.
std::vector<Given> drive_as_given(const RigidMechanism& mechanism, const State& x,
                                  Workspace& model) {
  std::vector<Given> out;
  const double t0 = x.t;
  for (const MechanismBody& b : mechanism.bodies) {
    const FrameMotion frame = frame_of(model.body(b.name), x);
    if (b.velocity) {
      out.push_back(
          {"velocity of " + b.name, &b,
           "velocity = [" + text_of(b.velocity->x()) + ", " + text_of(b.velocity->y()) + "]"});
      model.add_joint(make_point_drive(
          out.back().joint, {b.name},
          [r = frame.origin, rate = *b.velocity, t0](double t) {
            const Vec2 now = r + (t - t0) * rate;
            return std::vector<Motion>{{now.x(), rate.x(), 0}, {now.y(), rate.y(), 0}};
          },
          {}));
    }
    if (b.angular_velocity) {
      out.push_back({"angular velocity of " + b.name, &b,
                     "angular_velocity = " + text_of(*b.angular_velocity)});
      model.add_joint(
          make_angle_drive(out.back().joint, {}, {b.name},
                           [angle = frame.angle, rate = *b.angular_velocity, t0](double t) {
                             return Motion{angle + (t - t0) * rate, rate, 0};
                           }));
    }
  }
  return out;
}

/// Returns the largest difference between the given velocities and the nearest velocities (in the
/// mass norm) that joints and drives allow [m/s]; an angular velocity counts times the size of the
/// body. Returns nothing if joints depend on each other.
std::optional<double> largest_difference(const RigidKinematics& kinematics, State x) {
  Workspace model(kinematics.model());
  VectorXd given = VectorXd::Zero(model.n_dofs());
  std::vector<std::pair<int, int>> rows;  // first unknown and number of unknowns
  for (const MechanismBody& b : kinematics.mechanism().bodies) {
    const int at = model.body(b.name).first_dof;
    const Vec2 u = x.q.segment<2>(at + 2);
    if (b.velocity) given.segment<2>(at) = *b.velocity;
    if (b.angular_velocity) given.segment<2>(at + 2) = *b.angular_velocity * Vec2(-u.y(), u.x());
    if (b.velocity) rows.emplace_back(at, 2);
    if (b.angular_velocity) rows.emplace_back(at + 2, 2);
  }
  x.v = given;
  try {
    make_integrator(model, {})->project_velocity(x);
  } catch (const Error&) {
    return {};
  }
  const VectorXd difference = model.scales().cwiseProduct(x.v - given);
  double out = 0;
  for (const auto& [at, n] : rows) out = std::max(out, difference.segment(at, n).norm());
  return std::isfinite(out) && out > 0 ? std::optional(out) : std::nullopt;
}

/// Returns the error about the first group of constraint rows that contradict each other in
/// velocity and include a given velocity; nothing if there is no such group.
/// @param difference  Difference between given and allowed velocities [m/s]; if it is absent, the
///                    residual of the rows is reported.
std::optional<Error> contradiction(const std::vector<Given>& given, const Diagnosis& diagnosis,
                                   std::optional<double> difference) {
  for (const DependentGroup& group : diagnosis.groups) {
    if (!(group.rate_miss > 0)) continue;
    std::string words, source;
    std::vector<std::string> joints;
    for (const std::string& name : group.joints) {
      const auto found =
          std::find_if(given.begin(), given.end(), [&](const Given& g) { return g.joint == name; });
      if (found == given.end()) {
        joints.push_back(name);
        continue;
      }
      if (words.empty()) source = found->body->source;
      words += (words.empty() ? "" : ", ") + found->body->name + "." + found->words;
    }
    if (words.empty()) continue;
    return Error::input(
        source + words + ": " +
        (joints.empty() ? "these velocities contradict each other"
                        : "this contradicts " + list_joints(joints)) +
        " by " + text_of(difference.value_or(group.rate_miss), 3) +
        " m/s. Velocities that are not given are computed from the given velocities");
  }
  return {};
}

}  // namespace

void give_initial_velocities(const RigidKinematics& kinematics, State& x) {
  Workspace model(kinematics.model());
  x.v.setZero();
  const std::vector<Given> given = drive_as_given(kinematics.mechanism(), x, model);
  try {
    assemble(model, x);
  } catch (const Error&) {
    const Diagnosis diagnosis = diagnose(model, x);
    if (const auto why = contradiction(given, diagnosis, largest_difference(kinematics, x)))
      throw *why;
    throw;
  }
}

}  // namespace flexmorph::fem
