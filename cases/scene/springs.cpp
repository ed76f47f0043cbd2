#include <algorithm>

#include "cases/scene/joints/reading.h"
#include "cases/scene/tables.h"
#include "geometry/registry.h"

namespace flexmorph::cases {
namespace {

using io::not_negative;
using io::Table;

constexpr const char *kLinearType = "`type = \"linear\"`", *kTorsionType = "`type = \"torsion\"`";

const io::Key& size_key(const char* name, io::Quantity quantity, const char* type,
                        const char* sentence) {
  return io::key("spring", name)
      .number(std::move(quantity))
      .otherwise(0.0)
      .when(type)
      .description(sentence);
}

const io::Key& unloaded_key(const char* name, io::Quantity quantity, const char* type,
                            const char* sentence) {
  return io::key("spring", name)
      .number(std::move(quantity))
      .otherwise(0.0)
      .when(type)
      .description(sentence);
}

/// Reads a stiffness, a damping, and the length or angle without force.
void read_numbers(const Table& t, const io::Key& stiffness, const io::Key& damping,
                  const io::Key& rest, Spring& spring) {
  spring.stiffness = t.number(stiffness);
  spring.damping = t.number(damping);
  if (spring.stiffness == 0 && spring.damping == 0)
    t.fail("a spring needs a positive `stiffness`, a positive `damping` or both");
  spring.rest = t.number(rest);
}

const io::Key &
    kStiffness = size_key("stiffness", not_negative("a stiffness", "N/m"), kLinearType,
                          "Stiffness of the spring; `stiffness`, `damping` or both are positive."),
   &kDamping =
       size_key("damping", not_negative("a damping", "N s/m"), kLinearType,
                "Damping coefficient of the damper; `stiffness`, `damping` or both are positive."),
   &kTorsionStiffness =
       size_key("stiffness", not_negative("a stiffness", "N m/rad"), kTorsionType,
                "Torsional stiffness of the spring; `stiffness`, `damping` or both are positive."),
   &kTorsionDamping =
       size_key("damping", not_negative("a damping", "N m s/rad"), kTorsionType,
                "Torsional damping coefficient; `stiffness`, `damping` or both are positive."),
   &kFreeLength = unloaded_key("free_length", not_negative("a length", "m"), kLinearType,
                               "Distance between the two points at which the spring has no force."),
   &kRestAngle =
       unloaded_key("rest_angle", io::any_number("an angle", "rad"), kTorsionType,
                    "Angle from the first axis of `a` to the first axis of `b` without moment.");

const SpringRow kLinear = {
    .name = "linear",
    .sentence = "A spring and damper along the line between two points.",
    .points = true,
    .axes = false,
    .read = [](const Table& t,
               Spring& s) { read_numbers(t, kStiffness, kDamping, kFreeLength, s); },
    .make =
        [](const Spring& s, const fem::MarkerLocation& a, const fem::MarkerLocation& b, double) {
          return fem::make_spring(s.name, a, b, {s.stiffness, s.damping, s.rest});
        }};

const SpringRow kTorsion = {
    .name = "torsion",
    .sentence =
        "A torsion spring and damper between the axes of rigid bodies or the ground; full turns "
        "are counted.",
    .points = false,
    .axes = true,
    .read = [](const Table& t,
               Spring& s) { read_numbers(t, kTorsionStiffness, kTorsionDamping, kRestAngle, s); },
    .make =
        [](const Spring& s, const fem::MarkerLocation& a, const fem::MarkerLocation& b,
           double start_angle) {
          return fem::make_torsion_spring(s.name, a, b,
                                          {s.stiffness, s.damping, s.rest, start_angle});
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
                           .description("Kind of the spring.");
const io::Key& kName = io::key("spring", "name")
                           .text("the name of a spring")
                           .otherwise_as("`spring` and the number of the spring")
                           .description(
                               "Name of the spring in messages. The forces of a named spring are "
                               "columns of motion.csv.");

/// Returns true if b is a plate or a beam.
bool is_flexible(const Table& t, const Scene& scene) {
  const std::vector<std::string> flexible = names_of(scene.bodies);
  std::vector<std::string> known = names_of(scene.rigid_bodies);
  known.insert(known.end(), flexible.begin(), flexible.end());
  known.push_back("ground");
  const std::string name = t.choice(kAnchorB.body, known);
  return std::find(flexible.begin(), flexible.end(), name) != flexible.end();
}

/// Reads both anchors. If the row does not need the axis of b, b may be a point of a plate or beam.
void read_locations(const Table& t, const Scene& scene, const SpringRow& row, Spring& spring) {
  if (!row.axes || row.needs_axis_b) {
    const auto [a, b] = read_anchors(t, scene, row.points, row.axes);
    spring.a = a, spring.b = b;
    return;
  }
  const bool rigid_b = !is_flexible(t, scene);
  spring.a = read_anchor(t, kAnchorA, scene, row.points, true);
  spring.b = read_anchor(t, kAnchorB, scene, row.points, rigid_b);
  if (spring.a.on_ground() && spring.b.on_ground())
    t.fail("`a` and `b` are both the ground: `a`, `b` or both must name a body");
  if (spring.a.body == spring.b.body)
    t.fail(kAnchorB.body, "a spring acts between two different bodies");
}

Spring read_spring(const Table& t, const Scene& scene) {
  Spring spring;
  spring.row = find_spring(t.choice(kType));
  const SpringRow& row = *spring.row;
  read_locations(t, scene, row, spring);
  row.read(t, spring);
  spring.name = "spring " + std::to_string(scene.springs.size() + 1);
  spring.named = t.has(kName);
  if (spring.named) spring.name = read_word(t, kName);
  for (const Spring& other : scene.springs)
    if (other.name == spring.name) t.fail(kName, "there is another spring of this name");
  const auto same = [&](const auto& other) { return other.name == spring.name; };
  if (std::any_of(scene.joints.begin(), scene.joints.end(), same) ||
      std::any_of(scene.hubs.begin(), scene.hubs.end(), same))
    t.fail(kName, "a joint or a hub has this name already: '" + spring.name + "'");
  return spring;
}

}  // namespace

extern const SpringRow kBushing, kStop, kDistanceStop, kAngleStop;

namespace {

Registry<SpringRow>& registry() {
  static Registry<SpringRow> all(
      "spring", [](const SpringRow& row) -> std::string { return row.name; },
      {&kLinear, &kTorsion, &kBushing, &kStop, &kDistanceStop, &kAngleStop});
  return all;
}

}  // namespace

std::span<const SpringRow* const> spring_rows() { return registry().rows(); }
const SpringRow* find_spring(std::string_view name) { return registry().find(name); }
void register_spring(const SpringRow& row) {
  if (!row.read || !row.make)
    throw Error::input("spring '" + std::string(row.name) + "' lacks read() or make()");
  registry().add(row);
}

void read_springs(const Table& root, Scene& scene) {
  for (const Table& t : root.tables(tables::kSpring))
    scene.springs.push_back(read_spring(t, scene));
}

}  // namespace flexmorph::cases
