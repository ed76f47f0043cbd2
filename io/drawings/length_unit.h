#pragma once

#include <span>
#include <string>
#include <vector>

namespace flexmorph::io {

/// A unit that drawings are made in.
struct LengthUnit {
  const char* name;  ///< "mm"
  double metres;     ///< in one of them
  int dxf;           ///< its number in $INSUNITS of DXF files
};

constexpr LengthUnit kMetre{"m", 1, 6}, kMillimetre{"mm", 1e-3, 4}, kInch{"in", 0.0254, 1};
constexpr LengthUnit kLengthUnits[] = {kMetre,          kMillimetre,      kInch,
                                       {"cm", 1e-2, 5}, {"um", 1e-6, 13}, {"ft", 0.3048, 2}};

/// @return null where there is none of that name, or of that number in DXF files
inline const LengthUnit* find_length_unit(const std::string& name) {
  for (const LengthUnit& unit : kLengthUnits)
    if (name == unit.name) return &unit;
  return nullptr;
}
inline const LengthUnit* find_length_unit(int dxf) {
  for (const LengthUnit& unit : kLengthUnits)
    if (dxf == unit.dxf) return &unit;
  return nullptr;
}
inline std::vector<std::string> length_unit_names() {
  std::vector<std::string> out;
  for (const LengthUnit& unit : kLengthUnits) out.emplace_back(unit.name);
  return out;
}

}  // namespace flexmorph::io
