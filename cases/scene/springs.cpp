#include <algorithm>
#include <array>

#include "cases/scene/joints/reading.h"
#include "cases/scene/tables.h"

namespace flexmorph::cases {
namespace {

using io::not_negative;
using io::Table;

const io::Key& size_key(const char* name, io::Quantity quantity, const char* type) {
  return io::key("spring", name)
      .number(std::move(quantity))
      .otherwise(0.0)
      .when(type)
      .says("At least one of `stiffness` and `damping` is given.");
}

const io::Key& rest_key(const char* name, io::Quantity quantity, const char* type) {
  return io::key("spring", name)
      .number(std::move(quantity))
      .otherwise(0.0)
      .when(type)
      .says("Where it pulls and pushes nothing.");
}

const SpringRow kLinear = {
    .name = "linear",
    .sentence = "Spring and damper along the line between two points.",
    .points = true,
    .axes = false,
    .stiffness = size_key("stiffness", not_negative("a stiffness", "N/m"), "linear"),
    .damping = size_key("damping", not_negative("a damping", "N s/m"), "linear"),
    .rest = rest_key("free_length", not_negative("a length", "m"), "linear"),
    .make = [](const Spring& s, const fem::MarkerPlace& a, const fem::MarkerPlace& b, double) {
      return fem::make_spring(s.name, a, b, {s.stiffness, s.damping, s.rest});
    }};

const SpringRow kTorsion = {
    .name = "torsion",
    .sentence =
        "Spring and damper between the first axes of two rigid bodies, or of the ground; turns "
        "count.",
    .points = false,
    .axes = true,
    .stiffness = size_key("stiffness", not_negative("a stiffness", "N m/rad"), "torsion"),
    .damping = size_key("damping", not_negative("a damping", "N m s/rad"), "torsion"),
    .rest = rest_key("rest_angle", io::any_number("an angle", "rad"), "torsion"),
    .make = [](const Spring& s, const fem::MarkerPlace& a, const fem::MarkerPlace& b,
               double start_angle) {
      return fem::make_torsion_spring(s.name, a, b, {s.stiffness, s.damping, s.rest, start_angle});
    }};

const io::Key& kType = io::key("spring", "type")
                           .word("a spring",
                                 [] {
                                   io::Glossary rows;
                                   for (const SpringRow* row : spring_rows())
                                     rows.emplace_back(row->name, row->sentence);
                                   return rows;
                                 })
                           .otherwise("linear")
                           .says("Along the line between two points, or between two axes.");
const io::Key& kName = io::key("spring", "name")
                           .text("the name of a spring")
                           .otherwise_as("`spring` and its number")
                           .says("What messages call it.");

Spring read_spring(const Table& t, const Scene& scene) {
  const std::string type = t.choice(kType);
  Spring spring;
  spring.row = *std::find_if(spring_rows().begin(), spring_rows().end(),
                             [&](const SpringRow* row) { return row->name == type; });
  const SpringRow& row = *spring.row;
  read_anchors(t, scene, row.points, row.axes, spring.a, spring.b);
  spring.stiffness = t.number(row.stiffness);
  spring.damping = t.number(row.damping);
  if (spring.stiffness == 0 && spring.damping == 0)
    t.fail("a spring has a `stiffness`, a `damping` or both");
  spring.rest = t.number(row.rest);
  spring.name = "spring " + std::to_string(scene.springs.size() + 1);
  if (t.has(kName)) spring.name = read_word(t, kName);
  for (const Spring& other : scene.springs)
    if (other.name == spring.name) t.fail(kName, "there is another spring of this name");
  return spring;
}

}  // namespace

std::span<const SpringRow* const> spring_rows() {
  static const std::array kRows = {&kLinear, &kTorsion};
  return kRows;
}

void read_springs(const Table& root, Scene& scene) {
  for (const Table& t : root.tables(tables::kSpring))
    scene.springs.push_back(read_spring(t, scene));
}

}  // namespace flexmorph::cases
