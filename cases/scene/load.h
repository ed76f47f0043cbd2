#pragma once

#include <memory>
#include <optional>
#include <span>
#include <string>

#include "fem/dynamics/esl.h"
#include "fem/term.h"
#include "geometry/base.h"
#include "io/case_file.h"

/// [[load]] on bodies that move.
namespace flexmorph::cases {

struct Body;
struct LoadRow;
struct Scene;

struct BodyLoad {
  const LoadRow* row = nullptr;
  std::string body;
  std::string edge;
  Vec2 point{0, 0};  ///< material [m]
  VectorXd force;    ///< (dim), in the unit of the row
  double size = 0;   ///< of a load that follows the plate, in the unit of the row
};

/// A row of the table of loads: all that the program knows of one kind (loads.cpp).
struct LoadRow {
  const char* name;      ///< as cases say it: type = "point"
  const char* sentence;  ///< what it does
  const char* words;     ///< of summaries: "force along"; its edge follows
  bool at_point, at_edge;
  bool follows;        ///< turns with the plate and has no energy; in space, by generalized-alpha
  const io::Key& key;  ///< of its size, per point, length or area
  std::unique_ptr<fem::Term> (*make)(const BodyLoad& load);
  /// What equivalent static loads make of it: a force at a point, or along the free end; nothing
  /// where they know no such load. @param longest  length of the body's design domain [m]
  std::optional<fem::AttachedForce> (*attached)(const BodyLoad& load, const Body& body,
                                                double longest) = nullptr;
};

/// All rows, in the order in which messages list them.
std::span<const LoadRow* const> load_rows();

/// What equivalent static loads make of it, see LoadRow::attached.
std::optional<fem::AttachedForce> attached_force(const BodyLoad& load, const Scene& scene);

/// [[load]].
void read_loads(const io::Table& root, Scene& scene);

}  // namespace flexmorph::cases
