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
/// Units of length that have a name in case files.
constexpr LengthUnit kLengthUnits[] = {kMetre,
                                       kMillimetre,
                                       kInch,
                                       {"cm", 1e-2, 5},
                                       {"um", 1e-6, 13},
                                       {"ft", 0.3048, 2},
                                       {"dm", 0.1, 14},
                                       {"km", 1e3, 7},
                                       {"nm", 1e-9, 12},
                                       {"yd", 0.9144, 10},
                                       {"mil", 2.54e-5, 9}};
/// All other units of $INSUNITS, by their names in the reference of DXF. The US survey foot is
/// 1200/3937 m; the parsec is 648000/pi astronomical units (IAU 2012 B2, 2015 B2).
constexpr LengthUnit kOtherDxfUnits[] = {{"mile", 1609.344, 3},
                                         {"microinch", 2.54e-8, 8},
                                         {"angstrom", 1e-10, 11},
                                         {"decametre", 10, 15},
                                         {"hectometre", 100, 16},
                                         {"gigametre", 1e9, 17},
                                         {"astronomical unit", 149597870700, 18},
                                         {"light year", 9460730472580800, 19},
                                         {"parsec", 3.0856775814913673e16, 20},
                                         {"US survey foot", 1200.0 / 3937, 21},
                                         {"US survey inch", 100.0 / 3937, 22},
                                         {"US survey yard", 3600.0 / 3937, 23},
                                         {"US survey mile", 6336000.0 / 3937, 24}};

/// Returns the unit of a name in case files; null if there is none.
inline const LengthUnit* find_length_unit(const std::string& name) {
  for (const LengthUnit& unit : kLengthUnits)
    if (name == unit.name) return &unit;
  return nullptr;
}
/// Returns the unit of a number in $INSUNITS; null if there is none.
inline const LengthUnit* find_length_unit(int dxf) {
  for (const LengthUnit& unit : kLengthUnits)
    if (dxf == unit.dxf) return &unit;
  for (const LengthUnit& unit : kOtherDxfUnits)
    if (dxf == unit.dxf) return &unit;
  return nullptr;
}
/// Returns the names of all units that case files can name.
inline std::vector<std::string> length_unit_names() {
  std::vector<std::string> out;
  for (const LengthUnit& unit : kLengthUnits) out.emplace_back(unit.name);
  return out;
}

}  // namespace flexmorph::io
