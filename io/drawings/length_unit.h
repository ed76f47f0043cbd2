#pragma once

#include <span>
#include <string>
#include <vector>

namespace flexmorph::io {

/// A unit of length in drawings.
struct LengthUnit {
  const char* name;  ///< Name, such as "mm".
  double metres;     ///< Length of one unit [m].
  int dxf;           ///< Number of the unit in $INSUNITS of DXF files.
};

/// Units that the code refers to.
constexpr LengthUnit kMetre{"m", 1, 6}, kMillimetre{"mm", 1e-3, 4}, kInch{"in", 0.0254, 1};
/// All units that drawings may have.
constexpr LengthUnit kLengthUnits[] = {kMetre,          kMillimetre,      kInch,
                                       {"cm", 1e-2, 5}, {"um", 1e-6, 13}, {"ft", 0.3048, 2}};

/// Returns the unit of a name, or of a number in DXF files; null if there is none.
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
/// Returns the names of all units.
inline std::vector<std::string> length_unit_names() {
  std::vector<std::string> out;
  for (const LengthUnit& unit : kLengthUnits) out.emplace_back(unit.name);
  return out;
}

}  // namespace flexmorph::io
