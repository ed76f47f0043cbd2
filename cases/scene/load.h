#pragma once

#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "fem/dynamics/esl.h"
#include "fem/force_element.h"
#include "fem/load_law.h"
#include "fem/term.h"
#include "geometry/base.h"
#include "io/case_files/case_file.h"

/// The loads on moving bodies: [[load]].
namespace flexmorph::cases {

struct Body;
struct LoadRow;
struct Scene;

/// An entry of [[load]] on a moving body.
struct BodyLoad {
  const LoadRow* row = nullptr;  ///< Kind of the load.
  std::string body;              ///< Name of the loaded body.
  std::string edge;              ///< Name of the loaded edge; empty: no edge is loaded.
  Vec2 point{0, 0};              ///< Material point, or location in the axes of a rigid body [m].
  fem::LoadLaw law{0.0};         ///< Force (dim), else magnitude (1), in the unit of the row.
  VectorXd force;                ///< Force at the start (dim); empty: the load is no force.
  double size = 0;               ///< Magnitude at the start of a load that is no force.
  bool turns = false;  ///< True if force components refer to axes that turn with the body.
};

/// A row of the table of loads: everything that is specific to one kind of load (loads.cpp).
struct LoadRow {
  const char* name;      ///< Name in case files: type = "point".
  const char* sentence;  ///< Sentence that describes the load.
  const char* words;     ///< Text for summaries, such as "force along"; the edge follows it.
  bool at_point = false, at_edge = false;  ///< True if it acts at a point (on an edge).

  /// True if the load is no force vector: it turns with the body and has no potential energy.
  bool follows = false;

  bool in_space = false;                    ///< True if it acts on plates in space only.
  bool in_plane = false;                    ///< True if it acts on bodies in the plane only.
  bool on_plates = true, on_beams = false;  ///< True if it acts on plates (on beams).
  const io::Key& key;                       ///< Key of its magnitude, per point, length or area.

  /// Creates the term of a loaded plate or beam.
  std::unique_ptr<fem::Term> (*make)(const BodyLoad& load, const Body& body);
  /// Creates the force element of a loaded rigid body; null if the load does not act on them.
  std::unique_ptr<fem::ForceElement> (*on_rigid)(const BodyLoad& load,
                                                 const std::string& name) = nullptr;
  /// Returns the force that equivalent static loads contain for a load that does not turn with the
  /// body: a force at a point or along the free end. Returns nothing if equivalent static loads do
  /// not include such a load; null means that they never do.
  /// @param longest  length of the body's design domain [m]
  std::optional<fem::AttachedForce> (*attached)(const BodyLoad& load, const VectorXd& force,
                                                const Body& body, double longest) = nullptr;
};

/// Returns all rows, in the order in which messages list them.
std::span<const LoadRow* const> load_rows();

/// Returns the force that equivalent static loads contain for a load at a time t [s], see
/// LoadRow::attached; nothing for loads that turn with the body.
std::optional<fem::AttachedForce> attached_force(const BodyLoad& load, const Scene& scene,
                                                 double t);

/// Returns the indices of all loads in an order that does not depend on their order in the case
/// file. Forces are added in this order, because the last bits of a sum depend on the order of its
/// terms. Loads that differ in their course over time only keep the order of the file.
std::vector<size_t> ordered_loads(const Scene& scene);

/// Reads the loads on moving bodies: [[load]].
void read_loads(const io::Table& root, Scene& scene);

}  // namespace flexmorph::cases
