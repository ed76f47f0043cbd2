#include <cmath>
#include <numbers>

#include "cases/scene/elements/row.h"
#include "fem/elements/ancf_plate.h"

/// Complete example of an element: a plate whose elements are shorter towards both ends.
namespace flexmorph::cases {
namespace {

std::unique_ptr<fem::Element> make(const Body& body, double, const std::array<int, 2>& count) {
  std::vector<fem::MaterialLine> m, n;
  for (int i = 0; i <= count[0]; ++i)
    m.push_back({0.5 * body.length * (1 - std::cos(std::numbers::pi * i / count[0])), {}});
  for (int j = 0; j <= count[1]; ++j) n.push_back({body.low() + body.width * j / count[1], {}});
  return std::make_unique<fem::AncfPlate>(body.dim(), fem::AncfPlate::ShapeSet::h16, std::move(m),
                                          std::move(n));
}

}  // namespace

extern const ElementRow kAncfPlate, kGradedPlate;
const ElementRow kGradedPlate = [] {
  ElementRow row = kAncfPlate;  // is read, drawn and counted as kAncfPlate
  row.name = "graded_plate";
  row.sentence = "A plate with shorter elements at both ends.";
  row.make = make;
  return row;
}();

}  // namespace flexmorph::cases
