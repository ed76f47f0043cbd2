#include "cases/check/plausibility.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <tuple>
#include <utility>

#include "cases/check/check_cost.h"
#include "cases/scene/elements/row.h"
#include "cases/scene/joints/row.h"
#include "cases/scene/materials/material.h"
#include "cases/scene/read.h"
#include "io/files.h"

namespace flexmorph::cases {
namespace {

using io::to_text;

/// An interval of plausible values.
struct Usual {
  double lower, upper;
  bool holds(double x) const { return x >= lower && x <= upper; }
  std::string words() const {
    return "the usual range is " + to_text(lower) + " to " + to_text(upper);
  }
};
constexpr Usual kModulus{1e3, 2e12}, kDensity{10, 25000}, kGravity{0.01, 50};
constexpr Usual kSlenderness{2, 5000}, kThinness{1, 1e5};
constexpr double kFastest = 5;          // periods of the lowest frequency in a time step
constexpr double kSlowest = 0.05;       // periods of the lowest frequency in the run
constexpr double kSag = 1, kBend = 10;  // [lengths]; statics may roll a strip up, a bend of 3
constexpr double kTurns = 20;
constexpr double kTurnPerStep = 0.5;  // [rad]

Support support_of(const Scene& scene, const Body& body) {
  int held = 0, frames = 0;
  for (const Joint& j : scene.joints) {
    if (j.drives_line || (j.body != body.name && j.a.body != body.name && j.b.body != body.name))
      continue;
    ++held;
    frames += j.joins_edges() || (j.body == body.name && (j.holds_frame() || j.holds_edges()));
  }
  if (held == 0) return Support::none;
  if (held > 1) return Support::two_locations;
  return frames == 1 ? Support::cantilever : Support::one_point;
}

/// Returns true if the density matters: without it, in statics without gravity, it may be missing.
bool has_density(const Scene& scene) { return !scene.statics || scene.gravity; }

/// Returns the text for a support.
std::string to_string(Support support) {
  static const std::array<const char*, 4> kWords = {"free", "supported by one pin", "cantilever",
                                                    "supported at several points"};
  return kWords[static_cast<size_t>(support)];
}

/// Returns √c of the two lowest bending frequencies, see BendingFigures.
std::array<double, 2> roots_of(Support support) {
  constexpr double pi = std::numbers::pi;
  static const std::array<std::array<double, 2>, 4> kRoots = {
      {{4.7300, 7.8532}, {3.9266, 7.0686}, {1.8751, 4.6941}, {pi, 2 * pi}}};
  return kRoots[static_cast<size_t>(support)];
}

/// Returns the distance from the held line to the farther end [m].
double arm_of(const Scene& scene, const Body& body) {
  const double length = body.longest(scene.time.end);
  for (const Joint& j : scene.joints) {
    if (j.body != body.name || !j.holds_frame() || j.edge == "free_end" || j.line == 0) continue;
    const double at = body.start_lines(0, body.elements[0])[static_cast<size_t>(j.line)];
    return std::max(at, length - at);
  }
  return length;
}

/// Absolute values of the resultant force [N] and moment [N m] of a load.
struct Resultant {
  double force = 0, moment = 0;
};

Resultant resultant(const Scene& scene, const BodyLoad& load, const Body& body) {
  const double length = body.longest(scene.time.end);
  const bool side = load.edge == "side_low" || load.edge == "side_high";
  const double edge = side ? length : body.width;
  // In a static analysis a force along the axis causes no bending.
  double size = std::abs(load.size);
  if (load.force.size() >= 2) {
    VectorXd force = load.force;
    const double angle = start_pose(scene, body).angle;
    const Vec2 axis(std::cos(angle), std::sin(angle));
    if (scene.statics) force.head<2>() -= axis * axis.dot(force.head<2>());
    size = force.norm();
  }
  if (load.row->at_point) return load.row->follows ? Resultant{0, size} : Resultant{size, 0};
  if (load.row->on_beams) return {size * length, 0};
  if (load.row->at_edge && load.row->follows) return {0, size * edge};
  return {size * (load.row->at_edge ? edge : length * body.width), 0};
}

/// Returns the largest deflection of a slender strip by linear theory [m]: under its weight per
/// length [N/m], a force at the most unfavourable location, and a moment at an end.
double deflection(Support support, double EI, double L, double weight, const Resultant& r) {
  if (support == Support::cantilever)
    return weight * std::pow(L, 4) / (8 * EI) + r.force * std::pow(L, 3) / (3 * EI) +
           r.moment * L * L / (2 * EI);
  return 5 * weight * std::pow(L, 4) / (384 * EI) + r.force * std::pow(L, 3) / (48 * EI) +
         r.moment * L * L / (9 * std::sqrt(3.0) * EI);
}

BendingFigures figures_of(const Scene& scene, const Body& body) {
  BendingFigures out;
  out.body = body.name;
  out.support = support_of(scene, body);
  out.length = arm_of(scene, body);
  out.depth = body.in_space() ? body.thickness : body.width;
  const double across = body.in_space() ? body.width : body.thickness;
  const double L = out.length, E = body.youngs_modulus;
  const double EI = E * across * std::pow(out.depth, 3) / 12;
  for (size_t i = 0; has_density(scene) && i < 2; ++i) {
    const double c = std::pow(roots_of(out.support)[i], 2);
    out.frequencies[i] = c / (2 * std::numbers::pi * L * L) * std::sqrt(E / body.density) *
                         out.depth / std::sqrt(12.0);
  }
  if (!scene.statics) out.step_frequency = scene.time.step * out.frequencies[0];
  if (out.support != Support::cantilever && out.support != Support::two_locations) return out;
  if (scene.gravity)
    out.sag = deflection(out.support, EI, L,
                         body.density * scene.gravity->norm() * across * out.depth, {}) /
              L;
  Resultant all;
  for (const BodyLoad& load : scene.loads) {
    if (load.body != body.name) continue;
    const Resultant r = resultant(scene, load, body);
    all.force += r.force;
    all.moment += r.moment;
  }
  if (all.force > 0 || all.moment > 0) out.bend = deflection(out.support, EI, L, 0, all) / L;
  return out;
}

/// Returns the largest absolute change of a law over the run, relative to the start.
double reach(const Scene& scene, const Law& law) {
  const auto motion = scene.motion_of(law);
  const std::array<double, 2> range = range_of(motion, scene.time.end);
  const double start = motion(0).value;
  return std::max(std::abs(range[0] - start), std::abs(range[1] - start));
}

/// Returns true for multiples of 15, from 15 on, which are probably degrees: 45 rad is unusual.
bool looks_like_degrees(double angle) {
  return std::abs(angle) >= 15 && std::abs(std::remainder(angle, 15)) < 1e-9 * std::abs(angle);
}

struct Remarks {
  const Scene& scene;
  std::vector<std::string> out = {};

  void add(const std::string& key, const std::string& words) {
    out.push_back((scene.file ? scene.file->where(key) : key) + ": " + words);
  }
  void check(const std::string& key, double found, const Usual& usual, const std::string& noun) {
    if (!usual.holds(found)) add(key, noun + "; " + usual.words());
  }
};

/// Returns true if a modulus would be that of a known material if it were in MPa.
/// @param density  density [kg/m^3]; 0: unknown
bool looks_like_mpa(double modulus, double density) {
  constexpr double kNear = 0.05;
  const auto near = [](double a, double b) { return std::abs(a - b) <= kNear * b; };
  return std::ranges::any_of(materials(), [&](const Material& m) {
    return near(1e6 * modulus, m.youngs_modulus) && (density == 0 || near(density, m.density));
  });
}

void remark_modulus(const std::string& key, double modulus, double density, Remarks& out) {
  if (looks_like_mpa(modulus, density))
    out.add(key, "Young's modulus is " + to_text(modulus, 3) +
                     " Pa, which looks like a number in "
                     "MPa; write \"" +
                     to_text(modulus, 6) + " MPa\"");
  else if (!out.scene.domain)  // the modulus of a static plate may be 1
    out.check(key, modulus, kModulus, "Young's modulus is " + to_text(modulus, 3) + " Pa");
}

void remark_body(const Body& body, const BendingFigures& f, Remarks& out) {
  const Scene& scene = out.scene;
  const std::string path = "body." + body.name + ".", modulus = path + "youngs_modulus";
  remark_modulus(modulus, body.youngs_modulus, body.density, out);
  if (has_density(scene))
    out.check(path + "density", body.density, kDensity,
              "the density is " + to_text(body.density, 3) + " kg/m^3");
  const bool beam = !body.row->across;
  std::string depth = "height", other = "width";
  if (!beam && body.in_space()) depth = "thickness";
  if (!beam && !body.in_space()) std::tie(depth, other) = std::pair("width", "thickness");
  const double across = body.in_space() ? body.width : body.thickness;
  const auto check_ratio = [&](const std::string& size, double ratio, const Usual& usual) {
    out.check(path + size, ratio, usual, "length / " + size + " = " + to_text(ratio, 3));
  };
  check_ratio(depth, f.slenderness(), kSlenderness);
  check_ratio(other, f.length / across, body.in_space() ? Usual{0.1, 5000} : kThinness);
  const double frequency = f.frequencies[0], periods = frequency * scene.time.end;
  const std::string lowest = "the lowest bending frequency, " + to_text(frequency, 3) + " Hz, has ";
  if (f.step_frequency > kFastest)
    out.add(modulus, lowest + to_text(f.step_frequency, 3) +
                         " periods per time step: the body is almost rigid");
  if (!scene.statics && frequency > 0 && periods < kSlowest)
    out.add(modulus, lowest + "a period of " + to_text(1 / periods, 3) +
                         " times the simulated time: the body has almost no stiffness");
  if (f.sag && *f.sag > kSag)
    out.add(modulus, "the deflection under gravity is " + to_text(*f.sag, 3) +
                         " times the length (linear theory)");
  if (f.bend && *f.bend > kBend)
    out.add(modulus, "the deflection under the loads is " + to_text(*f.bend, 3) +
                         " times the length (linear theory)");
}

void remark_start(const std::string& key, double angle, Remarks& out) {
  if (std::abs(angle) > 2 * std::numbers::pi)
    out.add(key, "the angle is " + to_text(angle, 4) +
                     " rad, more than one revolution; angles are in radians");
}

void remark_turns(Remarks& out) {
  for (const TurnFigures& turn : turn_figures(out.scene)) {
    const std::string words = turn.what + " rotates by " + to_text(turn.angle, 4) + " rad, " +
                              to_text(turn.angle / (2 * std::numbers::pi), 3) + " revolutions";
    if (turn.per_step > kTurnPerStep)
      out.add(turn.key, words + ", " + to_text(turn.per_step, 2) + " rad per time step");
    else if (turn.angle > 2 * std::numbers::pi * kTurns || looks_like_degrees(turn.angle))
      out.add(turn.key, words + "; angles are in radians");
  }
}

std::string bending_text(const BendingFigures& f) {
  std::string out;
  const std::string what = "bending of " + f.body;
  std::string words = to_string(f.support) +
                      ", as a slender strip with length / depth = " + to_text(f.slenderness(), 3);
  out = summary_row(what, words);
  words.clear();
  const auto add = [&](const std::string& more) { words += (words.empty() ? "" : "; ") + more; };
  if (f.sag) add("deflection under gravity " + to_text(*f.sag, 2) + " times the length");
  if (f.bend) add("deflection under loads " + to_text(*f.bend, 2) + " times the length (linear)");
  return words.empty() ? out : out + summary_row("", words);
}

std::string of_all(double bytes, double all) {
  return bytes_text(bytes) + (std::isfinite(all) ? " of " + bytes_text(all) : "");
}

/// Returns the expected times of the phases of a run, with equal phases of several cycles in one
/// number.
std::string phases_text(const Scene& scene, const Mechanism* mechanism) {
  std::vector<std::pair<std::string, double>> sums;
  for (const PhaseCost& phase : phase_costs(scene, mechanism)) {
    const auto known =
        std::ranges::find(sums, phase.name, [](const auto& sum) { return sum.first; });
    if (known == sums.end())
      sums.emplace_back(phase.name, phase.seconds);
    else
      known->second += phase.seconds;
  }
  std::string out;
  for (const auto& [name, seconds] : sums)
    out += summary_row(out.empty() ? "time by phases" : "",
                       name + " " + duration_text(std::max(seconds, 0.1)));
  return out;
}

std::string disk_text(const Scene& scene, const Mechanism* mechanism, const Machine& machine) {
  const ResourceEstimate resource_estimate = estimate_resources(scene);
  const bool most = resource_estimate.iterations > 0 ||
                    resource_estimate.step_key == "static.max_steps",
             least = scene.time.tolerance.has_value();
  const std::string bound = most ? "at most about " : least ? "at least about " : "about ";
  const ExpectedSeconds seconds = expected_seconds(scene, mechanism);
  const bool cycles = seconds.one_cycle < 0.9 * seconds.most;
  return summary_row("expected",
                     "memory about " + of_all(resource_estimate.memory_bytes(), machine.memory) +
                         ", time " +
                         (cycles ? "about " + duration_text(seconds.one_cycle) +
                                       " with one cycle of motion and design, "
                                 : std::string()) +
                         bound + duration_text(seconds.most) + ", disk " +
                         (most ? "at most about " : "about ") +
                         of_all(resource_estimate.disk_bytes(), machine.disk) + " free") +
         phases_text(scene, mechanism);
}

}  // namespace

std::vector<BendingFigures> bending_figures(const Scene& scene) {
  std::vector<BendingFigures> out;
  for (const Body& body : scene.bodies) out.push_back(figures_of(scene, body));
  return out;
}

std::vector<TurnFigures> turn_figures(const Scene& scene) {
  std::vector<TurnFigures> out;
  if (scene.domain || scene.statics) return out;
  // Adaptive steps are short enough for any rotation.
  const bool even = !scene.time.tolerance && scene.time.integrator != "minimal_coordinates";
  const double part = even ? std::min(1.0, scene.time.step / scene.time.end) : 0;
  for (const Hub& hub : scene.hubs) {
    const bool driven = !hub.turn.drive.empty();
    const double angle =
        driven ? reach(scene, hub.turn) : std::abs(hub.angular_velocity) * scene.time.end;
    out.push_back({"hub '" + hub.name + "'",
                   "hub." + hub.name + (driven ? ".angle" : ".angular_velocity"), angle,
                   part * angle});
  }
  for (size_t i = 0; i < scene.joints.size(); ++i) {
    const Joint& joint = scene.joints[i];
    if (!joint.row->drives_angle || joint.laws.empty()) continue;
    const double angle = reach(scene, joint.laws[0]);
    out.push_back(
        {"joint '" + joint.name + "'", "joint." + std::to_string(i), angle, part * angle});
  }
  return out;
}

std::vector<std::string> plausibility_remarks(const Scene& scene) {
  Remarks out{scene};
  if (scene.domain)
    remark_modulus("domain.youngs_modulus", scene.domain->youngs_modulus, scene.domain->density,
                   out);
  for (const Body& body : scene.bodies) remark_body(body, figures_of(scene, body), out);
  if (scene.gravity && scene.gravity->norm() > 0)
    out.check("gravity", scene.gravity->norm(), kGravity,
              "gravity is " + to_text(scene.gravity->norm(), 3) + " m/s^2");
  for (const Hub& hub : scene.hubs)
    if (hub.turn.drive.empty()) remark_start("hub." + hub.name + ".angle", hub.angle, out);
  for (const RigidBody& body : scene.rigid_bodies)
    remark_start("rigid_body." + body.name + ".angle", body.angle, out);
  for (const Body& body : scene.bodies)
    remark_start("body." + body.name + ".angle", body.angle, out);
  for (size_t i = 0; i < scene.springs.size(); ++i)
    if (scene.springs[i].row->name == std::string("torsion"))
      remark_start("spring." + std::to_string(i) + ".rest_angle", scene.springs[i].rest, out);
  remark_turns(out);
  return out.out;
}

std::string summary_row(const std::string& what, const std::string& words) {
  constexpr size_t kColumn = kSummaryIndent - 2;
  const size_t gap = what.size() < kColumn ? kColumn - what.size() : 1;
  return "  " + what + std::string(gap, ' ') + words + "\n";
}

std::string numbers_text(const Scene& scene, const Mechanism* mechanism, const Machine& machine) {
  std::string out = "\nplausibility\n";
  for (const BendingFigures& f : bending_figures(scene)) out += bending_text(f);
  for (const TurnFigures& turn : turn_figures(scene))
    out += summary_row(turn.what,
                       "rotates by up to " + to_text(turn.angle, 4) + " rad, " +
                           to_text(turn.angle * 180 / std::numbers::pi, 4) + " degrees, " +
                           to_text(turn.angle / (2 * std::numbers::pi), 3) + " revolutions");
  out += disk_text(scene, mechanism, machine);
  if (!scene.notes.empty()) out += "\nnotes\n";
  for (const std::string& note : scene.notes) out += "  " + note + "\n";
  const std::vector<std::string> odd = plausibility_remarks(scene);
  if (!odd.empty()) out += "\nimplausible\n";
  for (const std::string& each : odd) out += "  " + each + "\n";
  return out;
}

}  // namespace flexmorph::cases
