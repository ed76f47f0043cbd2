#include <array>

#include "cases/scene/elements/row.h"

namespace flexmorph::cases {

extern const ElementRow kAncfPlate, kAleAncfPlate, kAncfBeam;

std::span<const ElementRow* const> element_rows() {
  static const std::array kRows = {&kAncfPlate, &kAleAncfPlate, &kAncfBeam};
  return kRows;
}

}  // namespace flexmorph::cases
