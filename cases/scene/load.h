#pragma once

#include <memory>
#include <optional>
#include <span>
#include <string>

#include "fem/dynamics/esl.h"
#include "fem/link.h"
#include "fem/load_law.h"
#include "fem/term.h"
#include "geometry/base.h"
#include "io/case_files/case_file.h"

/// [[load]] on bodies that move.
namespace flexmorph::cases {

struct Body;
struct LoadRow;
struct Scene;

struct BodyLoad {
  const LoadRow* row = nullptr;
  std::string body;
  std::string edge;
  Vec2 point{0, 0};       ///< material, or in the axes of a rigid body [m]
  fem::LoadLaw law{0.0};  ///< in the unit of the row: (dim) of a force, (1) of others
  VectorXd force;         ///< (dim), at the start; empty: no force
  double size = 0;        ///< of a load that is no force, at the start
  bool turns = false;     ///< is the force along axes that turn with the body?
};

/// A row of the table of loads: all that the program knows of one kind (loads.cpp).
struct LoadRow {
  const char* name;      ///< as cases say it: type = "point"
  const char* sentence;  ///< what it does
  const char* words;     ///< of summaries: "force along"; its edge follows
  bool at_point = false, at_edge = false;
  bool follows = false;   ///< is no force, turns with the body and has no energy
  bool in_space = false;  ///< of plates in space only
  bool in_plane = false;  ///< never there
  bool on_plates = true, on_beams = false;
  const io::Key& key;  ///< of its size, per point, length or area
  std::unique_ptr<fem::Term> (*make)(const BodyLoad& load, const Body& body);
  /// The same on a rigid body; null where there is none.
  std::unique_ptr<fem::Link> (*on_rigid)(const BodyLoad& load, const std::string& name) = nullptr;
  /// What equivalent static loads make of a force that does not turn: at a point, or along the free
  /// end; nothing where they know no such load. @param longest  length of the body's design domain
  /// [m]
  std::optional<fem::AttachedForce> (*attached)(const BodyLoad& load, const VectorXd& force,
                                                const Body& body, double longest) = nullptr;
};

/// All rows, in the order in which messages list them.
std::span<const LoadRow* const> load_rows();

/// What equivalent static loads make of it at a time, see LoadRow::attached.
std::optional<fem::AttachedForce> attached_force(const BodyLoad& load, const Scene& scene,
                                                 double t);

/// [[load]].
void read_loads(const io::Table& root, Scene& scene);

}  // namespace flexmorph::cases
