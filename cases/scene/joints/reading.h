#pragma once

#include <string>
#include <vector>

#include "cases/scene/read.h"

/// Functions that several joints, springs and loads use to read their keys.
namespace flexmorph::cases {

/// The keys of one anchor: `a`, `point_a` and `angle_a`, or `b`, `point_b` and `angle_b`.
struct AnchorKeys {
  const io::Key &body, &point, &angle;  ///< Keys of the body, of the point and of the angle.
};
extern const AnchorKeys kAnchorA, kAnchorB;
/// Reads an anchor: a body or the ground, and a location on it.
/// @param with_point  true if the point is used
/// @param with_axis   true if the axis is used; plates and beams have no axis and are then refused
Anchor read_anchor(const io::Table& t, const AnchorKeys& keys, const Scene& scene, bool with_point,
                   bool with_axis);
/// Reads the anchors a and b on two bodies, or on a body and the ground.
/// @param with_points  true if the points are used
/// @param with_axes    true if the axes are used
/// @throws Error (input) where both are on the ground or on one body
std::array<Anchor, 2> read_anchors(const io::Table& t, const Scene& scene, bool with_points,
                                   bool with_axes);
/// Sets the name of a joint between bodies: the key `name`, or a unique name made of its type and
/// its bodies.
void name_between(const io::Table& t, const Scene& scene, Joint& joint);

/// Keys at which errors about the kind of a joint, its body or its edge are located.
namespace joint_keys {
extern const io::Key &kType, &kBody, &kEdge;
}  // namespace joint_keys

/// Reads the key `body`, sets the body and the name of the joint, and returns the plate or beam.
const Body& read_jointed_body(const io::Table& t, const Scene& scene, Joint& joint);
/// Returns the names of the four edges of a plate.
const std::vector<std::string>& edge_names();
/// Reads an edge: one of `names`, or an m-line such as "line 3" of a mesh that does not change.
std::string read_edge(const io::Table& t, const io::Key& key, const Body& body,
                      const std::vector<std::string>& names);
/// Returns the number of the m-line that a text such as "line 3" names; -1 if it names no m-line of
/// the body.
int line_of(const std::string& edge, const Body& body);
/// Reads a material point of a body that may be outside of its hub [m].
/// @param end  end of the run [s]
Vec2 read_point(const io::Table& t, const io::Key& key, const Body& body, double end);
/// Reads the key `mode` of a plate: the components that the joint keeps at the edge.
fem::WeldMode read_mode(const io::Table& t, fem::WeldMode fallback);
/// Reads the key `edge` of an edge in a hub, in a sleeve or on a rigid body, and sets edge, line
/// and name of the joint.
/// @param names  edges besides m-lines that may be held
void read_framed_edge(const io::Table& t, const Body& body, const std::vector<std::string>& names,
                      Joint& joint);
/// Throws if an edge is held twice, or if a body is held by two hubs or sleeves besides its free
/// end.
/// @throws Error (input) located in the file
void check_frame(const io::Table& t, const Scene& scene, const Body& body, const Joint& joint);

/// Reads a pair of numbers.
/// @param computed  the pair that a missing key stands for
Vec2 read_pair(const io::Table& t, const io::Key& key, const std::optional<Vec2>& computed = {});

}  // namespace flexmorph::cases
