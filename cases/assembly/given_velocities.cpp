#include "cases/assembly/given_velocities.h"

#include "fem/body_joints.h"
#include "fem/dynamics/carrier.h"
#include "fem/solve/assembly.h"
#include "fem/solve/diagnosis.h"
#include "io/files.h"

namespace flexmorph::cases {
namespace {

/// A velocity of the case, as a joint that drives the body with it.
struct Given {
  std::string joint;
  const RigidBody* body;
  std::string words;
};

std::vector<Given> drive_as_given(const Scene& scene, const fem::State& x, fem::Workspace& model) {
  std::vector<Given> out;
  const double t0 = x.t;
  for (const RigidBody& b : scene.rigid_bodies) {
    const fem::FrameMotion frame = fem::frame_of(model.body(b.name), x);
    if (b.velocity) {
      out.push_back({"velocity of " + b.name, &b,
                     "velocity = [" + io::to_text(b.velocity->x(), 6) + ", " +
                         io::to_text(b.velocity->y(), 6) + "]"});
      model.add_joint(fem::make_point_drive(
          out.back().joint, {b.name},
          [r = frame.origin, rate = *b.velocity, t0](double t) {
            const Vec2 now = r + (t - t0) * rate;
            return std::vector<fem::Motion>{{now.x(), rate.x(), 0}, {now.y(), rate.y(), 0}};
          },
          {}));
    }
    if (b.angular_velocity) {
      out.push_back({"angular velocity of " + b.name, &b,
                     "angular_velocity = " + io::to_text(*b.angular_velocity, 6)});
      model.add_joint(
          fem::make_angle_drive(out.back().joint, {}, {b.name},
                                [angle = frame.angle, rate = *b.angular_velocity, t0](double t) {
                                  return fem::Motion{angle + (t - t0) * rate, rate, 0};
                                }));
    }
  }
  return out;
}

/// What the first rows that miss each other in velocity say to the user; nothing where no given one
/// is among them.
std::optional<Error> contradiction(const std::vector<Given>& given,
                                   const fem::Diagnosis& diagnosis) {
  for (const fem::DependentGroup& group : diagnosis.groups) {
    if (!(group.rate_miss > 0)) continue;
    std::string words, place;
    std::vector<std::string> joints;
    for (const std::string& name : group.joints) {
      const auto found =
          std::find_if(given.begin(), given.end(), [&](const Given& g) { return g.joint == name; });
      if (found == given.end()) {
        joints.push_back(name);
        continue;
      }
      if (place.empty()) place = found->body->place;
      words += (words.empty() ? "" : ", ") + found->body->name + "." + found->words;
    }
    if (words.empty()) continue;
    return Error::input(place + ": rigid_body." + words + ": " +
                        (joints.empty() ? "they contradict each other"
                                        : "contradicts " + fem::list_joints(joints)) +
                        " by " + io::to_text(group.rate_miss, 3) +
                        " m/s. Velocities that are not given follow from those that are");
  }
  return {};
}

}  // namespace

void move_as_given(const Scene& scene, const fem::Model& twin, fem::State& x) {
  fem::Workspace model(twin);
  x.v.setZero();
  const std::vector<Given> given = drive_as_given(scene, x, model);
  try {
    fem::assemble(model, x);
  } catch (const Error&) {
    if (const auto why = contradiction(given, fem::diagnose(model, x))) throw *why;
    throw;
  }
}

}  // namespace flexmorph::cases
