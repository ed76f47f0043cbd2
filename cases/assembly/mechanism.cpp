#include <algorithm>
#include <cmath>
#include <limits>

#include "cases/assembly/build.h"
#include "cases/assembly/heat.h"
#include "cases/assembly/joints.h"
#include "cases/assembly/reservoir.h"
#include "cases/assembly/start.h"
#include "cases/scene/elements/row.h"
#include "cases/scene/joints/row.h"
#include "fem/dynamics/starts/rigid_motion.h"
#include "fem/loads.h"
#include "fem/terms.h"
#include "io/files.h"

namespace flexmorph::cases {
namespace {

/// Returns the motion of a hub whose angle or position is prescribed by drives.
fem::FrameDrive driven_hub(const Scene& scene, const Hub& hub) {
  const bool turns = !hub.turn.drive.empty(), travels = !hub.path[0].drive.empty();
  const auto turn = scene.motion_of(hub.turn);
  const std::array path = {scene.motion_of(hub.path[0]), scene.motion_of(hub.path[1])};
  return [=](double t) {
    fem::FrameMotion f;
    f.origin = hub.position;
    f.angle = hub.angle + hub.angular_velocity * t;
    f.angle_rate = hub.angular_velocity;
    if (turns) {
      const fem::Motion angle = turn(t);
      f.angle = angle.value;
      f.angle_rate = angle.rate;
      f.angle_acceleration = angle.acceleration;
    }
    for (int c = 0; c < 2 && travels; ++c) {
      const fem::Motion x = path[static_cast<size_t>(c)](t);
      f.origin[c] = x.value;
      f.origin_rate[c] = x.rate;
      f.origin_acceleration[c] = x.acceleration;
    }
    return f;
  };
}

fem::FrameDrive drive_of(const Scene& scene, const Hub& hub) {
  if (!hub.turn.drive.empty() || !hub.path[0].drive.empty()) return driven_hub(scene, hub);
  const TimeSpan& time = scene.time;
  fem::FrameMotion still;
  still.origin = hub.position;
  if (time.start != Start::hub_at_rest)
    return [hub, still](double t) {
      fem::FrameMotion f = still;
      f.angle = hub.angle + hub.angular_velocity * t;
      f.angle_rate = hub.angular_velocity;
      return f;
    };
  // ω(t) = ω s(t/T), s = 10u³ - 15u⁴ + 6u⁵, so that the angular acceleration is zero at both ends.
  return [hub, still, T = time.spin_up](double t) {
    fem::FrameMotion f = still;
    const double w = hub.angular_velocity, u = std::min(1.0, t / T);
    f.angle = hub.angle + w * T * std::pow(u, 4) * (2.5 - 3 * u + u * u) + w * std::max(0.0, t - T);
    f.angle_rate = w * std::pow(u, 3) * (10 - 15 * u + 6 * u * u);
    f.angle_acceleration = w / T * 30 * u * u * (1 - u) * (1 - u);
    return f;
  };
}

fem::FrameDrive at_rest(const Vec2& origin, double angle) {
  fem::FrameMotion still;
  still.origin = origin;
  still.angle = angle;
  return [still](double) { return still; };
}

void add_body(const Scene& scene, const Body& body, const std::array<int, 2>& count,
              fem::Model& model) {
  const fem::LoadLaw gravity = scene.gravity_law();
  const fem::PlaneSection section = section_of(body);
  std::vector<std::unique_ptr<fem::Term>> terms =
      fem::make_terms(body.terms, section, body.numbers);
  if (gravity.size() > 0) terms.push_back(fem::make_gravity(section, gravity));
  for (const fem::AttachedMass& m : attached_masses(scene, body.name))
    terms.push_back(fem::make_point_mass(m.mass, m.material, gravity));
  for (const size_t i : ordered_loads(scene))
    if (const BodyLoad& load = scene.loads[i]; load.body == body.name)
      terms.push_back(load.row->make(load, body));
  model.add_body(body.name, body.row->make(body, scene.time.end, count), section, std::move(terms));
}

/// Returns the rate of the material coordinate at the start for a material line that a joint drives
/// [m/s]; 0 if no joint drives it.
double slide_of(const Scene& scene, const Joint& frame) {
  for (const Joint& j : scene.joints)
    if (j.drives_line && j.body == frame.body && j.line == frame.line)
      return j.at.drive.empty() ? j.speed : scene.motion_of(j.at)(0).rate;
  return 0;
}

/// Adds the joint of an edge that is held by a hub, a sleeve or a rigid body, and the mesh control
/// of the moving root.
void add_frame(const Scene& scene, const Joint& joint, double finer, Mechanism& out) {
  const Body& body = scene.body(joint.body);
  fem::DrivenFrame driven_frame;
  if (joint.on_rigid_body()) {
    const Anchor& b = joint.b;
    driven_frame = fem::DrivenFrame(b.body, b.point, b.angle);
    out.model.add_joint(fem::make_edge_weld(joint.name, joint.body, joint.edge,
                                            {b.body, b.point, b.angle, {}}, joint.mode));
  } else {
    driven_frame = hub_drive(scene, joint);
    out.model.add_joint(
        fem::make_weld(joint.name, joint.body, joint.edge, driven_frame.drive(), joint.mode));
  }
  if (joint.edge == "free_end" || !body.row->lines) return;
  constexpr double kNever = std::numeric_limits<double>::infinity();
  fem::MovingRoot growth{joint.body, driven_frame, kNever, 0, joint.line, slide_of(scene, joint)};
  if (body.flow && body.on_cells()) {
    growth.cell = finer * body.cell_length();
    growth.max_length = kLongestCell * growth.cell;
    growth.min_length = kShortestCell * growth.cell;
  } else if (body.flow && !body.has_uniform_mesh()) {
    growth.max_length = finer * body.flow->max_length;
    growth.min_length = finer * body.flow->min_length;
  } else if (body.mesh_changes()) {
    growth.max_length = finer * body.lines.front().max_length;
    growth.min_length = finer * body.lines.front().min_length;
  }
  out.moving_roots.push_back(growth);
}

/// Adds one joint for all held edges of a body, so that a corner of two held edges is held once.
void add_holds(const Scene& scene, const Body& body, fem::Model& model) {
  std::vector<fem::Held> all;
  for (const Joint& joint : scene.joints) {
    if (joint.body != body.name || !joint.holds_edges()) continue;
    for (const std::string& edge : joint.edges) {
      const std::vector<fem::Held> held = joint.row->held(joint, edge);
      all.insert(all.end(), held.begin(), held.end());
    }
  }
  if (!all.empty()) model.add_joint(fem::make_hold(body.name + ".held", body.name, std::move(all)));
}

/// Sets the placement of bodies without material lines (beams) in a scene that is no mechanism:
/// they move with their hubs or stay where the case places them.
void location_alone(const Scene& scene, fem::MotionSettings& motion) {
  struct Frame {
    std::string body;
    fem::FrameDrive drive;
    double line;
  };
  std::vector<Frame> frames;
  for (const Body& body : scene.bodies) {
    const auto holds = [&](const Joint& j) {
      return j.body == body.name && j.holds_frame() && j.edge != "free_end";
    };
    const auto hub = std::find_if(scene.joints.begin(), scene.joints.end(), holds);
    const bool rides = hub != scene.joints.end();
    if (body.row->lines) continue;
    const fem::ReferencePose pose = start_pose(scene, body);
    frames.push_back(
        {body.name, rides ? hub_drive(scene, *hub) : at_rest(pose.origin, pose.angle), pose.line});
  }
  if (frames.empty()) return;
  motion.body_poses = [frames](double t) {
    std::vector<fem::BodyPose> out;
    for (const Frame& f : frames) out.push_back({f.body, f.drive(t), f.line});
    return out;
  };
}

}  // namespace

const Hub& hub_of(const Scene& scene, const Joint& joint) {
  return *std::find_if(scene.hubs.begin(), scene.hubs.end(),
                       [&](const Hub& h) { return h.name == joint.to; });
}

fem::FrameDrive hub_drive(const Scene& scene, const Joint& joint) {
  if (joint.to.empty()) return at_rest(joint.position, joint.angle);
  fem::FrameDrive hub = drive_of(scene, hub_of(scene, joint));
  if (joint.angle == 0) return hub;
  return [hub, angle = joint.angle](double t) {
    fem::FrameMotion f = hub(t);
    f.angle += angle;
    return f;
  };
}

namespace {

/// Returns true if no load acts that has no energy, and no heat and no drive exists. Heat and
/// drives can supply energy within one step and be constant at both ends of the step, so that no
/// power of them is visible there.
bool keeps_energy(const Scene& scene) {
  const auto follows = [](const BodyLoad& l) { return l.row->follows || l.turns; };
  return !scene.has_heat() && scene.drives.empty() &&
         std::none_of(scene.loads.begin(), scene.loads.end(), follows);
}

}  // namespace

double stress_round_off(const Scene& scene) {
  double out = 0;
  for (const Body& body : scene.bodies)
    out += 1e-26 * body.youngs_modulus * body.length_at(0) * body.width * body.thickness;
  return out;
}

namespace {

/// Returns the scene with designed bodies that are meshed by the cells of their designs.
/// @param parts   number of elements per cell in each direction
/// @param coarse  number of design cells that are merged into one cell in each direction
Scene on_merged_cells(Scene scene, int parts, int coarse) {
  for (const BodyDesign& design : scene.designs)
    for (Body& body : scene.bodies) {
      if (body.name != design.body) continue;
      body.shape = "q4";
      body.cell = coarse * design.grid.dx() / parts;
      body.elements = {static_cast<int>(std::lround(body.length / body.cell)),
                       parts * design.grid.ny / coarse};
    }
  return scene;
}

}  // namespace

Scene on_cells(Scene scene, int parts) { return on_merged_cells(std::move(scene), parts, 1); }

namespace {

/// Adds the joints of a scene.
/// @param finer  returns the length of the elements of this run relative to those of the scene
void add_joints(const Scene& scene, const std::function<double(const Body&)>& finer,
                const FindLocation& location, Mechanism& out) {
  for (const Joint& joint : scene.joints) {
    if (joint.holds_frame())
      add_frame(scene, joint, finer(scene.body(joint.body)), out);
    else if (auto made = make_joint(scene, joint, location, false))
      out.model.add_joint(std::move(made));
  }
  for (const Body& body : scene.bodies) add_holds(scene, body, out.model);
}

void set_motion(const Scene& scene, fem::MotionSettings& out) {
  out.end = scene.time.end;
  set_step(scene, scene.time.step, out);
  out.integrator = scene.time.integrator;
  out.alpha.rho_inf = scene.time.rho_inf;
  out.minimal_coordinates.tolerance = scene.time.explicit_tolerance;
  if (scene.gravity) out.gravity = *scene.gravity;
  if (keeps_energy(scene)) out.energy_round_off = stress_round_off(scene);
}

}  // namespace

void set_step(const Scene& scene, double step, fem::MotionSettings& motion) {
  motion.step = step;
  motion.adaptive.reset();
  motion.discontinuities.clear();
  if (scene.time.tolerance && step == scene.time.step) {
    motion.adaptive = fem::AdaptiveStep{};
    motion.adaptive->tolerance = *scene.time.tolerance;
    motion.adaptive->largest = scene.time.largest_step;
    if (scene.time.start == Start::hub_at_rest) motion.discontinuities = {scene.time.spin_up};
  }
  for (const Drive& drive : scene.drives)
    motion.discontinuities.insert(motion.discontinuities.end(), drive.discontinuities.begin(),
                                  drive.discontinuities.end());
}

Mechanism build_mechanism(const Scene& scene, const MeshChoice& mesh,
                          const fem::RigidKinematics* rigid) {
  if (mesh.cells > 0) {
    MeshChoice other = mesh;
    other.cells = 0;
    return build_mechanism(on_merged_cells(scene, mesh.cells, mesh.coarse), other, rigid);
  }
  Mechanism out;
  const auto elements = [&](const Body& body) {
    const std::array<int, 2> count = mesh.elements.value_or(body.elements);
    return std::array{mesh.refine * count[0], mesh.refine * count[1]};
  };
  const auto finer = [&](const Body& body) {
    return static_cast<double>(body.elements[0]) / elements(body)[0];
  };
  for (const RigidBody& body : scene.rigid_bodies)
    fem::add_rigid_body(out.model, mechanism_body(body), scene.gravity_law(),
                        reservoirs_in(scene, body.name));
  for (const Body& body : scene.bodies) add_body(scene, body, elements(body), out.model);
  const FindLocation location = [](const Anchor& a) {
    return fem::MarkerLocation{a.body, a.point, a.angle, {}};
  };
  for (const Spring& spring : scene.springs)
    out.model.add_force_element(make_force_element(scene, spring, location));
  for (auto& load : rigid_loads(scene)) out.model.add_force_element(std::move(load));
  add_outlets(scene, out.model);
  add_joints(scene, finer, location, out);
  set_motion(scene, out.motion);
  if (scene.is_mechanism()) {
    const fem::RigidKinematics kinematics = rigid ? *rigid : rigid_kinematics(scene);
    fem::RigidMotion motion(kinematics);
    out.motion.body_poses = fem::rigid_configuration(kinematics);
    out.assembly_text = motion.kinematics().remark();
    set_start(scene, &motion, out);
  } else {
    location_alone(scene, out.motion);
    set_start(scene, nullptr, out);
  }
  if (scene.has_heat()) add_heat(scene, out);
  return out;
}

}  // namespace flexmorph::cases
