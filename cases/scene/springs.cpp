#include <algorithm>
#include <array>

#include "cases/scene/joints/reading.h"

namespace flexmorph::cases {
namespace {

using io::not_negative;
using io::Table;

const SpringRow kLinear = {
    .name = "linear",
    .sentence = "Spring and damper along the line between two points.",
    .points = true,
    .axes = false,
    .stiffness_unit = "N/m",
    .damping_unit = "N s/m",
    .rest_key = "free_length",
    .rest = io::not_negative("a length", "m"),
    .make = [](const Spring& s, const fem::MarkerPlace& a, const fem::MarkerPlace& b) {
      return fem::make_spring(s.name, a, b, {s.stiffness, s.damping, s.rest});
    }};

const SpringRow kTorsion = {
    .name = "torsion",
    .sentence = "Spring and damper between the first axes of two rigid bodies, or of the ground.",
    .points = false,
    .axes = true,
    .stiffness_unit = "N m/rad",
    .damping_unit = "N m s/rad",
    .rest_key = "rest_angle",
    .rest = io::any_number("an angle", "rad"),
    .make = [](const Spring& s, const fem::MarkerPlace& a, const fem::MarkerPlace& b) {
      return fem::make_torsion_spring(s.name, a, b, {s.stiffness, s.damping, s.rest});
    }};

Spring read_spring(const Table& t, const Scene& scene) {
  std::vector<std::string> names;
  for (const SpringRow* row : spring_rows()) names.emplace_back(row->name);
  const std::string type = t.choice("type", "a spring", names, names.front());
  Spring spring;
  spring.row = *std::find_if(spring_rows().begin(), spring_rows().end(),
                             [&](const SpringRow* row) { return row->name == type; });
  const SpringRow& row = *spring.row;
  read_anchors(t, scene, row.points, row.axes, spring.a, spring.b);
  spring.stiffness = t.number("stiffness", not_negative("a stiffness", row.stiffness_unit), 0.0);
  spring.damping = t.number("damping", not_negative("a damping", row.damping_unit), 0.0);
  if (spring.stiffness == 0 && spring.damping == 0)
    t.fail("a spring has a `stiffness`, a `damping` or both");
  spring.rest = t.number(row.rest_key, row.rest, 0.0);
  spring.name = "spring " + std::to_string(scene.springs.size() + 1);
  if (t.has("name")) spring.name = read_word(t, "the name of a spring");
  for (const Spring& other : scene.springs)
    if (other.name == spring.name) t.fail("name", "there is another spring of this name");
  return spring;
}

}  // namespace

std::span<const SpringRow* const> spring_rows() {
  static const std::array kRows = {&kLinear, &kTorsion};
  return kRows;
}

void read_springs(const Table& root, Scene& scene) {
  for (const Table& t : root.tables("spring")) scene.springs.push_back(read_spring(t, scene));
}

}  // namespace flexmorph::cases
