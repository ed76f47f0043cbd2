#pragma once

#include <memory>
#include <span>
#include <string>

#include "cases/scene/rigid_body.h"
#include "fem/link.h"
#include "io/case_file.h"

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
  double rest = 0;  ///< length or angle without force
};

/// A row of the table of springs: all that the program knows of one kind (springs.cpp).
struct SpringRow {
  const char* name;      ///< as cases say it: type = "torsion"
  const char* sentence;  ///< what it does
  bool points, axes;     ///< does it look at points, at axes?
  const io::Key &stiffness, &damping;
  const io::Key& rest;  ///< length or angle without force
  /// @param start_angle  from the first axis of a to that of b, whole turns counted [rad]
  std::unique_ptr<fem::Link> (*make)(const Spring& spring, const fem::MarkerPlace& a,
                                     const fem::MarkerPlace& b, double start_angle);
};

/// All rows, in the order in which messages list them; the first one is meant where a case says
/// none.
std::span<const SpringRow* const> spring_rows();

/// [[spring]].
void read_springs(const io::Table& root, Scene& scene);

}  // namespace flexmorph::cases
