#pragma once

#include <string>
#include <vector>

#include "cases/scene/read.h"

/// What several joints, links and loads read in the same way.
namespace flexmorph::cases {

/// Keys `a`, `point_a`, `angle_a` (or of b): a body or the ground, and a place on it.
struct AnchorKeys {
  const io::Key &body, &point, &angle;
};
extern const AnchorKeys kAnchorA, kAnchorB;
/// @param with_point, with_axis  does it look at points, at axes? Only rigid bodies have axes.
Anchor read_anchor(const io::Table& t, const AnchorKeys& keys, const Scene& scene, bool with_point,
                   bool with_axis);
/// Reads the anchors a and b, on two bodies of which one may be the ground.
/// @param with_points, with_axes  as of read_anchor()
/// @throws Error (input) where both are on the ground or on one body
std::array<Anchor, 2> read_anchors(const io::Table& t, const Scene& scene, bool with_points,
                                   bool with_axes);
/// Its `name`, or one made of its type and bodies, unlike all others.
void name_between(const io::Table& t, const Scene& scene, Joint& joint);

/// What is wrong about the kind of a joint, its body or its edge is said of these keys.
namespace joint_keys {
extern const io::Key &kType, &kBody, &kEdge;
}  // namespace joint_keys

/// Key `body`: a plate or a beam.
const Body& read_jointed_body(const io::Table& t, const Scene& scene, Joint& joint);
/// Names of the four edges.
const std::vector<std::string>& edge_names();
/// An edge by its name, or, where the mesh does not change, an m-line: "line 3".
std::string read_edge(const io::Table& t, const io::Key& key, const Body& body,
                      const std::vector<std::string>& names);
/// "line 3" of a body of so many elements; -1 for other words.
int line_of(const std::string& edge, const Body& body);
/// A material point that is outside of the hub all the time.
Vec2 read_point(const io::Table& t, const io::Key& key, const Body& body, double end);
/// Key `mode` of a plate: what the edge keeps.
fem::WeldMode read_mode(const io::Table& t, fem::WeldMode fallback);
/// What every edge in a frame asks: `edge`, which is held once only, and its line.
/// @param names  edges besides lines that may be held
void read_framed_edge(const io::Table& t, const Body& body, const std::vector<std::string>& names,
                      Joint& joint);
void check_frame(const io::Table& t, const Scene& scene, const Body& body, const Joint& joint);

/// Two numbers.
Vec2 read_pair(const io::Table& t, const io::Key& key, const std::optional<Vec2>& computed = {});

}  // namespace flexmorph::cases
