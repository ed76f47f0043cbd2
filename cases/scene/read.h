#pragma once

#include <map>
#include <string>
#include <vector>

#include "cases/scene/scene.h"

/// The parts of read_scene(): the motion or the static scene, and the designs. Unless a comment
/// says otherwise, the functions throw Error (input) located in the file.
namespace flexmorph::cases {

/// Reads everything that moves: [time] or [static], gravity, drives, hubs, bodies, joints, springs,
/// point masses, loads, [[observe]] and [[measure]].
/// @param follow  computes the drives that follow from a trajectory
void read_motion(const io::Table& root, const Follow& follow, Scene& scene);

/// Reads the entries of [[joint]] without the checks that need all joints, see read_joints().
std::vector<Joint> read_joint_list(const io::Table& root, const Scene& scene);
/// Reads [constants]: values by their names.
std::map<std::string, double> read_constants(const io::Table& root);
/// Reads [[drive]]; the time span of the run must be read before.
void read_drives(const io::Table& root, Scene& scene);

/// Returns overrides with the absolute paths of the CSV files of drives, see overrides_of_files().
std::vector<std::string> overrides_of_drive_files(const io::Table& root);
/// Returns overrides with the absolute paths of the CSV files of references.
/// @param t  the table [accuracy]
std::vector<std::string> overrides_of_reference_files(const io::Table& t);
/// Returns overrides with the absolute paths of the components files that designs start from.
std::vector<std::string> overrides_of_start_files(const io::Table& root);
/// Returns the override with the absolute path of the drawing of the [domain]; empty if it has
/// none.
std::vector<std::string> overrides_of_outline(const io::Table& root);

/// Reads a number, or the name of a drive in its place. Value and rate of the drive must be
/// continuous because it prescribes a motion.
/// @param computed  the number that a missing key stands for
Law read_law(const io::Table& t, const io::Key& key, const Scene& scene,
             std::optional<double> computed = {});

/// Reads a number, or the name of a drive in its place, for a load; the drive may jump.
Law read_load_law(const io::Table& t, const io::Key& key, const Scene& scene);
/// Reads a list of numbers or names of drives for the components of a load; the drives may jump.
std::vector<Law> read_load_laws(const io::Table& t, const io::Key& key, const Scene& scene);

/// Throws if a drive cannot prescribe a motion: its value or rate jumps, or it is a coordinate of a
/// curve (Drive::until).
/// @throws Error (input) located at the key
void refuse_jumps(const io::Table& t, const io::Key& key, const Scene& scene,
                  const std::string& drive);

/// Returns the smallest and the largest value in [0, end]. Extremes are located by bisection
/// between 1000 equally spaced samples, where the rate changes its sign.
std::array<double, 2> range_of(const std::function<fem::Motion(double)>& motion, double end);

/// Resolves the drive of body.flow.length, sets the length at the start and the longest and
/// shortest length over the run, and checks that the material reservoir is large enough.
/// @param t  the [[body]]
void follow_length(const io::Table& t, const Scene& scene, Body& body);

/// Reads [[joint]] and checks the bodies against all joints: a body with material flow needs a
/// joint at its root, and a free line needs a joint that holds or drives it. Hubs and bodies must
/// be read before.
void read_joints(const io::Table& root, Scene& scene);

/// Reads the observed points of a case: [[observe]].
void read_observed(const io::Table& root, Scene& scene);

/// Reads the list of terms of a [[body]] and the numbers that these terms need. The element and the
/// space of the body must be read before.
void read_terms(const io::Table& t, const Scene& scene, Body& body);

/// Reads the measured quantities of a case: [[measure]].
void read_measures(const io::Table& root, Scene& scene);

/// Reads the rigid bodies of a case: [[rigid_body]].
void read_rigid_bodies(const io::Table& root, Scene& scene);

/// Throws if a body of a mechanism has neither a joint nor a spring; only a rigid body with a given
/// velocity may be free. Joints and springs must be read before.
void check_mechanism_parts(const io::Table& root, const Scene& scene);

/// Reads [trajectory], and lets `follow` compute the drives that follow from it. Bodies must be
/// read before. Joints are read here as a draft only: their final reading needs the lengths of
/// bodies, which may depend on the drives that follow.
void read_trajectory(const io::Table& root, const Follow& follow, Scene& scene);

/// Reads the name of a plate or beam of the case; for the name of a rigid body or a hub the error
/// message says so.
std::string read_flexible(const io::Table& t, const io::Key& key, const Scene& scene);

/// Reads the name of a new body or hub, which must differ from the names of all others.
std::string read_name(const io::Table& t, const io::Key& key, const Scene& scene);

/// Reads the table [static] except its key `grows`, see read_growing().
StaticAnalysis read_analysis(const io::Table& t);
/// Reads the key `grows` of [static], which names the quantities that the load factor multiplies.
/// Loads, gravity and bodies must be read before.
void read_growing(const io::Table& root, Scene& scene);

/// Reads the material lines of a body, [[body.line]], sorted by their index.
std::vector<BodyLine> read_lines(const io::Table& body_table, const Body& body);

/// Reads a name that becomes part of column names and file names. Therefore it is a letter followed
/// by letters, digits and underscores, 64 characters at most.
std::string read_word(const io::Table& t, const io::Key& key);

/// Reads a polygon x0, y0, x1, y1, ... and returns its corners counterclockwise [m].
/// @throws Error (input) for a polygon without an area or one that crosses itself
std::vector<Vec2> read_polygon(const io::Table& t, const io::Key& key);

/// Reads a static scene, which consists of one plate: [domain], [[support]], [[load]], gravity.
void read_static(const io::Table& root, Scene& scene);

/// Reads a [[design]]; read_motion() or read_static() must be called before.
BodyDesign read_design(const io::Table& t, const Scene& scene);
/// Reads the regions [[design.solid]] and [[design.void]]; the grid must be set before.
/// @param t  the [[design]]
void read_regions(const io::Table& t, const Body& body, const Scene& scene, BodyDesign& design);

/// Reads a designed body that is not welded at its root: a link, which joints hold at two points.
/// @param key  the key that names the body, at which errors are located
Link read_link(const io::Table& t, const io::Key& key, const Body& body, const Scene& scene);
/// Throws if a joint holds a designed body at a point that is no node of the design mesh.
/// @param key  the key that names the body, at which errors are located
void check_joint_points(const io::Table& t, const io::Key& key, const Scene& scene,
                        const BodyDesign& design);
/// Throws if solid regions do not cover the cells around both pins of a link, because the optimizer
/// could otherwise remove the material there.
void check_pins_solid(const io::Table& t, const BodyDesign& design);
/// Reads the eyes around the pins of a link and the bores in them, and adds the eyes to the solid
/// regions.
/// @throws Error (input) for eyes beyond the plate or with thin walls, and for bodies that are no
///         links
void read_eyes(const io::Table& t, BodyDesign& design);

/// Reads [[design]], [esl], [optimizer], [cycle], [verify] and [certificate]; read_motion() or
/// read_static() must be called before.
void read_designs(const io::Table& root, Scene& scene);

/// Reads the keys of [cycle] about the correction of designs with the gradient of the motion, and
/// [certificate]. Designs must be read before.
void read_correction(const io::Table& root, Scene& scene);

/// Returns true if a ratio is a whole number up to the rounding of decimal input (1e-6).
bool is_whole(double ratio);

/// Returns the names of the entries of a list, in their order.
template <class T>
std::vector<std::string> names_of(const std::vector<T>& list) {
  std::vector<std::string> names;
  names.reserve(list.size());
  for (const T& each : list) names.push_back(each.name);
  return names;
}

}  // namespace flexmorph::cases
