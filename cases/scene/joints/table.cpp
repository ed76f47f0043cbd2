#include <array>

#include "cases/scene/joints/row.h"

namespace flexmorph::cases {

extern const JointRow kWeld, kSleeve, kPin, kClamp, kSupport, kSymmetry, kLineDrive, kRevolute,
    kSlider, kAngleDrive, kDistance, kPointDrive, kGear, kPath;

std::span<const JointRow* const> joint_rows() {
  static const std::array kRows = {&kWeld,     &kSleeve,     &kPin,      &kClamp,  &kSupport,
                                   &kSymmetry, &kLineDrive,  &kRevolute, &kSlider, &kAngleDrive,
                                   &kDistance, &kPointDrive, &kGear,     &kPath};
  return kRows;
}

}  // namespace flexmorph::cases
