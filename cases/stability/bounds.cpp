#include <algorithm>
#include <cmath>
#include <numbers>

#include "cases/scene/joints/row.h"
#include "cases/stability/judge.h"

namespace flexmorph::cases {
namespace {

constexpr double kPositionDrift = 1e-8;  // of the length of a scene [-]

void offer(double omega, const std::string& what, Bounds& out) {
  if (!(omega > out.omega)) return;
  out.omega = omega;
  out.fastest = what;
}

/// Slowest bending of a strip, ω = c/L² √(E/ρ) r with the radius of gyration r of its section: c is
/// 1.8751² of a cantilever, π² between pins. Where it starts without equilibrium (unstrained, hit
/// by heat, or falling) the slowest axial wave moves too, ω = π/2 √(E/ρ)/L.
void offer_body(const Scene& scene, const Body& body, Bounds& out) {
  const double length = body.longest(scene.time.end);
  const double wave = std::sqrt(body.youngs_modulus / body.density);
  const double depth = body.in_space() ? body.thickness : body.width;
  int held = 0;
  bool carried = false;
  for (const Joint& j : scene.joints) {
    if (j.body != body.name && j.a.body != body.name && j.b.body != body.name) continue;
    ++held;
    carried = carried || j.holds_frame() || j.holds_edges() || j.joins_edges();
  }
  const double shape = held > 1 ? std::numbers::pi * std::numbers::pi : 1.8751 * 1.8751;
  offer(shape / (length * length) * wave * depth / std::sqrt(12.0),
        "bending of '" + body.name + "'", out);
  const bool sudden = body.heat && (body.heat->profile.empty() || body.heat->profile == "step" ||
                                    body.heat->profile == "linear");
  const bool falls = scene.gravity && !carried;
  // A smooth change is one swing of its acceleration.
  if (body.heat && !sudden)
    offer(2 * std::numbers::pi / body.heat->settle, "the warming of '" + body.name + "'", out);
  if (scene.time.start == Start::rigid || sudden || falls || held == 0)
    offer(0.5 * std::numbers::pi * wave / length, "axial vibration of '" + body.name + "'", out);
}

/// Largest size of the rate of a drive.
double largest_rate(const Scene& scene, const Law& law) {
  if (law.drive.empty() || scene.follows_trajectory(law)) return 0;
  double out = 0;
  for (int k = 0; k <= 50; ++k)
    out = std::max(out, std::abs(scene.motion_of(law)(scene.time.end * k / 50).rate));
  return out;
}

bool is_driven(const Scene& scene) {
  const bool hubs = std::any_of(scene.hubs.begin(), scene.hubs.end(), [](const Hub& hub) {
    return hub.angular_velocity != 0 || !hub.turn.drive.empty() || !hub.path[0].drive.empty();
  });
  const bool flows = std::any_of(scene.bodies.begin(), scene.bodies.end(), [](const Body& body) {
    return body.flow && (body.flow->speed != 0 || !body.flow->length.drive.empty());
  });
  return hubs || flows || scene.has_heat() || !scene.drives.empty() || !scene.loads.empty() ||
         std::any_of(scene.joints.begin(), scene.joints.end(),
                     [](const Joint& j) { return j.drives_line; });
}

}  // namespace

Bounds bounds_of(const Scene& scene) {
  Bounds out;
  if (scene.domain || scene.statics) return out;
  out.step = scene.time.step;
  out.length = 0;
  for (const Body& body : scene.bodies) {
    offer_body(scene, body, out);
    const double length = body.longest(scene.time.end);
    const double volume = length * body.width * body.thickness;
    out.length = std::max({out.length, length, body.width});
    out.mass += body.density * volume;
    // Strains of 1e-13 are round-off of slopes of size one.
    out.rounding += 1e-26 * body.youngs_modulus * volume;
  }
  for (const RigidBody& body : scene.rigid_bodies) {
    out.mass += body.mass;
    for (const RigidBody::AddedMass& added : body.masses) out.mass += added.mass;
    out.length = std::max({out.length, body.position.norm(), body.size.norm()});
  }
  if (scene.gravity)
    offer(std::sqrt(scene.gravity->norm() / out.length), "swinging under gravity", out);
  for (const PointMass& mass : scene.point_masses) out.mass += mass.mass;
  for (const Hub& hub : scene.hubs)
    offer(std::max(std::abs(hub.angular_velocity), largest_rate(scene, hub.turn)),
          "the turning of '" + hub.name + "'", out);
  if (scene.time.start == Start::hub_at_rest)
    offer(2 * std::numbers::pi / scene.time.spin_up, "the spin-up", out);
  for (const Joint& joint : scene.joints)
    if (joint.row->drives_angle)
      for (const Law& law : joint.laws)
        offer(largest_rate(scene, law), "the drive '" + law.drive + "'", out);
  out.undriven = !is_driven(scene);
  return out;
}

double Bounds::defect() const { return std::clamp(h_omega() * h_omega(), 1e-6, kLargestDefect); }
double Bounds::position() const { return kPositionDrift * length; }
double Bounds::velocity(double kinetic) const {
  const double speed = mass > 0 ? std::sqrt(2 * kinetic / mass) : 1;
  const double rounding = step > 0 ? 1e-14 * length / step : 0;  // of positions, by the step
  return std::max({1e-9, rounding, defect() * speed});
}

}  // namespace flexmorph::cases
