#pragma once

#include <any>
#include <memory>
#include <span>
#include <string>
#include <string_view>

#include "cases/scene/rigid_body.h"
#include "fem/link.h"
#include "io/case_files/case_file.h"

/// [[spring]].
namespace flexmorph::cases {

struct Scene;
struct SpringRow;

/// Spring and damper between two anchors, in the units of the row.
struct Spring {
  const SpringRow* row = nullptr;
  std::string name;
  Anchor a, b;
  double stiffness = 0, damping = 0;
  double rest = 0;     ///< length or angle without force
  bool named = false;  ///< by the case: its forces are in the table of the motion
  std::any own;        ///< what only its row knows
};

/// A row of the table of springs: all that the program knows of one kind (springs.cpp).
struct SpringRow {
  const char* name;      ///< as cases say it: type = "torsion"
  const char* sentence;  ///< what it does
  bool points, axes;     ///< does it look at points, at axes?
  /// Reads its numbers; both places are read.
  /// @throws Error (input) located in the file
  void (*read)(const io::Table& t, Spring& spring);
  /// @param start_angle  from the first axis of a to that of b, whole turns counted [rad]
  std::unique_ptr<fem::Link> (*make)(const Spring& spring, const fem::MarkerPlace& a,
                                     const fem::MarkerPlace& b, double start_angle);
  bool needs_axis_b = true;  ///< of those that look at axes: at both of them?
};

/// All rows, in the order in which messages list them; the first one is meant where a case says
/// none.
std::span<const SpringRow* const> spring_rows();
/// Returns the row of this name; null where there is none.
const SpringRow* find_spring(std::string_view name);
/// Adds a row, see Registry::add(): a force element between two places. Keys that it reads are
/// declared with io::key().
void register_spring(const SpringRow& row);

/// [[spring]].
void read_springs(const io::Table& root, Scene& scene);

}  // namespace flexmorph::cases
