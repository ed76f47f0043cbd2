#pragma once

#include <string>
#include <vector>

#include "cases/scene/scene.h"

/// The two halves of read_scene(): what moves, and what is designed.
namespace flexmorph::cases {

/// [time] or [static], gravity, [[hub]], [[body]], [[joint]], [[point_mass]], [[load]],
/// [[observe]].
void read_motion(const io::Table& root, const Follow& follow, Scene& scene);

/// The entries of [[joint]] without what must fit together with them.
std::vector<Joint> read_joint_list(const io::Table& root, const Scene& scene);
/// [constants], [[drive]]; needs the time of the run.
void read_drives(const io::Table& root, Scene& scene);

/// See overrides_of_files(). @param t  [accuracy]
std::vector<std::string> overrides_of_drive_files(const io::Table& root);
std::vector<std::string> overrides_of_reference_files(const io::Table& t);
std::vector<std::string> overrides_of_start_files(const io::Table& root);
std::vector<std::string> overrides_of_outline(const io::Table& root);

/// A number, or the name of a drive in its place. What follows it moves: value and rate of the
/// drive are continuous.
Law read_law(const io::Table& t, const io::Key& key, const Scene& scene,
             std::optional<double> computed = {});

/// The same of loads, which may jump; and a list of them.
Law read_load_law(const io::Table& t, const io::Key& key, const Scene& scene);
std::vector<Law> read_load_laws(const io::Table& t, const io::Key& key, const Scene& scene);

/// @throws Error (input) at the key for a drive that jumps, or whose rate does.
void refuse_jumps(const io::Table& t, const io::Key& key, const Scene& scene,
                  const std::string& drive);

/// Smallest and largest value in [0, end]: extremes are looked for between 1000 samples, where the
/// rate changes its sign.
std::array<double, 2> range_of(const std::function<fem::Motion(double)>& motion, double end);

/// Resolves the drive of body.flow and checks the limits of the boundary element against all
/// lengths of the run. @param t  its [[body]]
void follow_length(const io::Table& t, const Scene& scene, Body& body);

/// [[joint]] and what must fit together with them; needs hubs and bodies.
void read_joints(const io::Table& root, Scene& scene);

/// [[observe]].
void read_observed(const io::Table& root, Scene& scene);

/// The list of terms of a [[body]], whose element and space are read, and the numbers they read.
void read_terms(const io::Table& t, const Scene& scene, Body& body);

/// [[measure]].
void read_measures(const io::Table& root, Scene& scene);

/// [[rigid_body]].
void read_rigid_bodies(const io::Table& root, Scene& scene);

/// What a scene with rigid bodies asks of all its parts; needs joints and springs.
void check_mechanism_parts(const io::Table& root, const Scene& scene);

/// [trajectory]; lets `follow` fill the drives that follow from it (needs bodies and joints).
void read_trajectory(const io::Table& root, const Follow& follow, Scene& scene);

/// The name of a plate or beam that the case has; of a rigid body or a hub it says that it is one.
std::string read_flexible(const io::Table& t, const io::Key& key, const Scene& scene);

/// The name of a body, unlike all others.
std::string read_name(const io::Table& t, const io::Key& key, const Scene& scene);

/// [static].
StaticAnalysis read_analysis(const io::Table& t);
/// What grows in it: needs loads and bodies.
void read_growing(const io::Table& root, Scene& scene);

/// [[body.line]].
std::vector<BodyLine> read_lines(const io::Table& body_table, const Body& body);

/// A name that becomes part of column names and file names, so: a letter, then letters, digits,
/// underscores.
std::string read_word(const io::Table& t, const io::Key& key);

/// A polygon from x0, y0, x1, y1, ...: counterclockwise; it has an area and does not cross itself.
std::vector<Vec2> read_polygon(const io::Table& t, const io::Key& key);

/// [domain], [[support]], [[load]]: a plate at rest.
void read_static(const io::Table& root, Scene& scene);

/// [[design]]; needs what read_motion() read, or read_static().
BodyDesign read_design(const io::Table& t, const Scene& scene);
/// [[design.solid]], [[design.void]]; needs the grid.
/// @param t  the [[design]]
void read_regions(const io::Table& t, const Body& body, const Scene& scene, BodyDesign& design);

/// A designed body that no root carries: a link between two points that joints hold.
/// @param key  that names the body, for what is wrong about it
Link read_link(const io::Table& t, const io::Key& key, const Body& body, const Scene& scene);
/// Joints act at nodes of the design mesh.
void check_joint_points(const io::Table& t, const io::Key& key, const Scene& scene,
                        const BodyDesign& design);
/// Both pins of a link sit in solid regions: without them they would end up in the void.
void check_pins_solid(const io::Table& t, const BodyDesign& design);
/// Reads the eyes around the pins of a link and the bores in them; eyes are solid regions.
/// @throws Error (input) for eyes beyond the plate or with thin walls, and for other bodies
void read_eyes(const io::Table& t, BodyDesign& design);

/// [[design]], [esl], [optimizer], [cycle], [verify]; needs what read_motion() read.
void read_designs(const io::Table& root, Scene& scene);

/// What [cycle] says of cycles that correct designs, and [certificate]; needs the designs.
void read_correction(const io::Table& root, Scene& scene);

/// Is the ratio a whole number, up to the rounding of decimal input?
bool is_whole(double ratio);

template <class T>
std::vector<std::string> names_of(const std::vector<T>& list) {
  std::vector<std::string> names;
  names.reserve(list.size());
  for (const T& each : list) names.push_back(each.name);
  return names;
}

}  // namespace flexmorph::cases
