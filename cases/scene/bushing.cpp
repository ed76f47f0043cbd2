#include "fem/bushing.h"

#include "cases/scene/joints/reading.h"

namespace flexmorph::cases {
namespace {

using io::Table;

const io::Key& pair_key(const char* name, const char* quantity, const char* unit,
                        const char* sentence) {
  return io::key("spring", name)
      .numbers(io::not_negative(quantity, unit), 2, 2)
      .otherwise(std::vector<double>{0, 0})
      .when("`type = \"bushing\"`")
      .description(sentence);
}
const io::Key &kStiffness = pair_key("stiffness", "a stiffness", "N/m",
                                     "Stiffness along and across the first axis of `a`."),
              &kDamping = pair_key("damping", "a damping", "N s/m",
                                   "Damping coefficients along and across the first axis of `a`.");

const io::Key& torsion_key(const char* name, const char* quantity, const char* unit,
                           const char* sentence) {
  return io::key("spring", name)
      .number(io::not_negative(quantity, unit))
      .otherwise(0.0)
      .when("`type = \"bushing\"`")
      .description(sentence);
}
const io::Key &kTorsionStiffness = torsion_key("torsion_stiffness", "a stiffness", "N m/rad",
                                               "Torsional stiffness between the axes of `a` and "
                                               "`b`, rigid or ground; full turns are counted."),
              &kTorsionDamping = torsion_key("torsion_damping", "a damping", "N m s/rad",
                                             "Torsional damping coefficient between the axes of "
                                             "`a` and `b`, rigid bodies or the ground.");
const io::Key& kRestAngle =
    io::key("spring", "rest_angle")
        .number(io::any_number("an angle", "rad"))
        .otherwise(0.0)
        .when("`type = \"bushing\"`")
        .description(
            "Angle from the first axis of `a` to the first axis of `b` without torsional moment.");

void read(const Table& t, Spring& spring) {
  fem::BushingData data;
  data.stiffness = read_pair(t, kStiffness, Vec2(0, 0));
  data.damping = read_pair(t, kDamping, Vec2(0, 0));
  data.torsion_stiffness = t.number(kTorsionStiffness);
  data.torsion_damping = t.number(kTorsionDamping);
  data.rest_angle = t.number(kRestAngle);
  if (data.stiffness.isZero() && data.damping.isZero() && data.torsion_stiffness == 0 &&
      data.torsion_damping == 0)
    t.fail(
        "a bushing needs a positive `stiffness`, `damping`, `torsion_stiffness` or "
        "`torsion_damping`");
  spring.own = data;
}

std::unique_ptr<fem::ForceElement> make(const Spring& spring, const fem::MarkerLocation& a,
                                        const fem::MarkerLocation& b, double start_angle) {
  fem::BushingData data = std::any_cast<const fem::BushingData&>(spring.own);
  data.start_angle = start_angle;
  return fem::make_bushing(spring.name, a, b, data);
}

}  // namespace

extern const SpringRow kBushing;
const SpringRow kBushing = {.name = "bushing",
                            .sentence =
                                "Springs and dampers along both axes of a, and a torsion spring "
                                "and damper between a and b.",
                            .points = true,
                            .axes = true,
                            .read = read,
                            .make = make,
                            .needs_axis_b = false};

}  // namespace flexmorph::cases
