#pragma once

#include <any>
#include <memory>
#include <span>
#include <string>
#include <string_view>

#include "cases/scene/rigid_body.h"
#include "fem/force_element.h"
#include "io/case_files/case_file.h"

/// The springs and dampers of a case: [[spring]].
namespace flexmorph::cases {

struct Scene;
struct SpringRow;

/// A spring and damper between two anchors, with numbers in the units of its row.
struct Spring {
  const SpringRow* row = nullptr;     ///< Kind of the spring.
  std::string name;                   ///< Name in messages and tables.
  Anchor a, b;                        ///< Anchors between which the spring acts.
  double stiffness = 0, damping = 0;  ///< Stiffness and damping.
  double rest = 0;                    ///< Length [m] or angle [rad] without force.
  bool named = false;  ///< True if the case names it; motion.csv then has its forces.
  std::any own;        ///< Data that only the functions of the row use.
};

/// A row of the table of springs: everything that is specific to one kind of spring (springs.cpp).
struct SpringRow {
  const char* name;      ///< Name in case files: type = "torsion".
  const char* sentence;  ///< Sentence that describes the spring.
  bool points, axes;     ///< True if it uses the points (the axes) of its anchors.

  /// Reads the numbers of a spring, whose anchors are read before.
  /// @throws Error (input) located in the file
  void (*read)(const io::Table& t, Spring& spring);
  /// Creates the force element.
  /// @param start_angle  angle at the start from the first axis of a to the first axis of b, whole
  ///                     turns included [rad]
  std::unique_ptr<fem::ForceElement> (*make)(const Spring& spring, const fem::MarkerLocation& a,
                                             const fem::MarkerLocation& b, double start_angle);

  /// True if a row with `axes` needs the axes of both anchors; if false, b may be a point of a
  /// plate or beam, which has no axis.
  bool needs_axis_b = true;
};

/// Returns all rows, in the order in which messages list them. The first row is the default of the
/// key `type`.
std::span<const SpringRow* const> spring_rows();
/// Returns the row of this name; null where there is none.
const SpringRow* find_spring(std::string_view name);
/// Adds a row to the table of springs, see Registry::add(). The row declares the keys that it reads
/// with io::key().
/// @throws Error (input) if the row lacks read() or make(), or for a name that is taken
void register_spring(const SpringRow& row);

/// Reads the springs of a case: [[spring]].
void read_springs(const io::Table& root, Scene& scene);

}  // namespace flexmorph::cases
