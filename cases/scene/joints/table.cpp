#include "cases/scene/joints/row.h"
#include "geometry/registry.h"

namespace flexmorph::cases {

extern const JointRow kWeld, kSleeve, kPin, kClamp, kSupport, kSymmetry, kLineDrive, kRevolute,
    kSlider, kAngleDrive, kDistance, kPointDrive, kGear, kPath;

namespace {

Registry<JointRow>& registry() {
  static Registry<JointRow> all(
      "joint", [](const JointRow& row) -> std::string { return row.name; },
      {&kWeld, &kSleeve, &kPin, &kClamp, &kSupport, &kSymmetry, &kLineDrive, &kRevolute, &kSlider,
       &kAngleDrive, &kDistance, &kPointDrive, &kGear, &kPath});
  return all;
}

}  // namespace

std::span<const JointRow* const> joint_rows() { return registry().rows(); }
const JointRow* find_joint(std::string_view name) { return registry().find(name); }
void register_joint(const JointRow& row) {
  if (!row.read || (!row.make && !row.held))
    throw Error::input("joint '" + std::string(row.name) +
                       "' lacks read(), or both of make() and held()");
  registry().add(row);
}

}  // namespace flexmorph::cases
