#include "fem/dynamics/starts/reference_pose.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "fem/dynamics/starts/driven_frame.h"

namespace flexmorph::fem {

Vec2 location_on_arc(double curvature, const Vec2& material) {
  const double turn = curvature * material.x(), half = 0.5 * turn;
  const double chord = material.x() * (turn == 0 ? 1 : std::sin(half) / half);
  return chord * Vec2(std::cos(half), std::sin(half)) +
         material.y() * Vec2(-std::sin(turn), std::cos(turn));
}

Vec3 ReferencePose::location(const Vec2& material) const {
  const Vec2 flat(material.x() - line, material.y());
  const Vec2 r =
      origin + rotation(angle) * (curvature == 0 ? flat : location_on_arc(curvature, flat));
  return {r.x(), r.y(), 0};
}

namespace {

const UndeformedBody& find_body(std::span<const UndeformedBody> bodies, const std::string& name) {
  const auto found = std::find_if(bodies.begin(), bodies.end(),
                                  [&](const UndeformedBody& b) { return b.name == name; });
  if (found == bodies.end()) throw Error::input("reference pose: there is no body '" + name + "'");
  return *found;
}

/// Returns the pose of a body, or nothing if no chain of welds ends at a body with a known pose.
/// @param from  Bodies of the chain so far, which the search does not visit again.
std::optional<ReferencePose> known_pose(std::span<const UndeformedBody> bodies,
                                        std::span<const ReferenceWeld> welds,
                                        const UndeformedBody& body,
                                        std::vector<std::string> from = {}) {
  if (body.pose) return body.pose;
  from.push_back(body.name);
  for (const ReferenceWeld& weld : welds) {
    if (weld.a.body != body.name && weld.b.body != body.name) continue;
    const bool at_a = weld.a.body == body.name;
    const ReferenceWeld::End &here = at_a ? weld.a : weld.b, &there = at_a ? weld.b : weld.a;
    if (std::find(from.begin(), from.end(), there.body) != from.end()) continue;
    const auto other = known_pose(bodies, welds, find_body(bodies, there.body), from);
    if (!other) continue;
    ReferencePose pose{{0, 0}, other->angle + there.angle - here.angle, body.line, body.curvature};
    pose.origin = (other->location(there.point) - pose.location(here.point)).head<2>();
    return pose;
  }
  return {};
}

}  // namespace

ReferencePose reference_pose(std::span<const UndeformedBody> bodies,
                             std::span<const ReferenceWeld> welds, const std::string& body) {
  const UndeformedBody& asked = find_body(bodies, body);
  if (const auto known = known_pose(bodies, welds, asked)) return *known;
  ReferencePose pose;
  pose.curvature = asked.curvature;
  return pose;
}

}  // namespace flexmorph::fem
