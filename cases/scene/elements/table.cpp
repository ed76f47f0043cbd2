#include "cases/scene/elements/row.h"
#include "geometry/registry.h"

namespace flexmorph::cases {

extern const ElementRow kAncfPlate, kAleAncfPlate, kAncfBeam;

namespace {

Registry<ElementRow>& registry() {
  static Registry<ElementRow> all("element",
                                  [](const ElementRow& row) -> std::string { return row.name; },
                                  {&kAncfPlate, &kAleAncfPlate, &kAncfBeam});
  return all;
}

}  // namespace

std::span<const ElementRow* const> element_rows() { return registry().rows(); }
const ElementRow* find_element(std::string_view name) { return registry().find(name); }
void register_element(const ElementRow& row) {
  if (!row.read || !row.read_weld || !row.make || !row.operations)
    throw Error::input("element '" + std::string(row.name) +
                       "' lacks one of read(), read_weld(), make() and operations()");
  registry().add(row);
}

}  // namespace flexmorph::cases
