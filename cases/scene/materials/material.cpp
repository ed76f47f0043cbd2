#include "cases/scene/materials/material.h"

#include "io/files.h"

namespace flexmorph::cases {
namespace {

constexpr const char *kCopper =
                         "Dowling, Mechanical Behavior of Materials, table 5.2; density and "
                         "expansion: CRC Handbook of Chemistry and Physics",
                     *kPlastics =
                         "Dowling, Mechanical Behavior of Materials, table 5.2; density and "
                         "expansion: engineersedge.com, properties of plastics";

// The numbers were not compared with the text of the standards and handbooks that are named here.
// Therefore all places that print them say so.
const Material kMaterials[] = {
    {"steel", 7850, 210e9, 0.3, 12e-6, "EN 1993-1-1, 3.2.6; density: EN 1993-1-2, 3.2.2"},
    {"stainless_steel", 7900, 200e9, 0.3, 16e-6,
     "EN 1993-1-4, 2.1.3; density and expansion of 1.4301: EN 10088-1"},
    {"ductile_iron", 7100, 169e9, 0.275, 12.5e-6, "EN 1563, ferritic grades"},
    {"aluminium", 2700, 70e9, 0.3, 23e-6, "EN 1999-1-1, 3.2.5"},
    {"titanium", 4430, 110e9, 0.31, {}, "Ti-6Al-4V: MIL-HDBK-5J, 5.4.1"},
    {"magnesium", 1740, 44.7e9, 0.291, 24.8e-6, kCopper},
    {"copper", 8960, 130e9, 0.343, 16.5e-6, kCopper},
    {"brass",
     8530,
     101e9,
     0.35,
     {},
     "70Cu-30Zn: Dowling, Mechanical Behavior of Materials, table 5.2; density: Copper "
     "Development Association, C26000"},
    {"nylon_66", 1140, 2.7e9, 0.41, 81e-6, kPlastics},
    {"polycarbonate", 1190, 2.4e9, 0.38, 67.5e-6, kPlastics},
    {"acrylic", 1190, 2.7e9, 0.35, 63e-6, kPlastics},
    {"polyethylene",
     970,
     1.08e9,
     0.42,
     {},
     "high density: Dowling, Mechanical Behavior of Materials, table 5.2; density: "
     "engineersedge.com, properties of plastics"}};

}  // namespace

std::span<const Material> materials() { return kMaterials; }

const Material* find_material(const std::string& name) {
  for (const Material& each : kMaterials)
    if (name == each.name) return &each;
  return nullptr;
}

io::Glossary material_glossary() {
  io::Glossary out;
  for (const Material& m : kMaterials) {
    std::string words = "density " + io::to_text(m.density) + " kg/m^3, Young's modulus " +
                        io::to_text(m.youngs_modulus / 1e9) + " GPa, Poisson's ratio " +
                        io::to_text(m.poisson_ratio);
    if (m.expansion) words += ", thermal expansion " + io::to_text(*m.expansion) + " 1/K";
    out.emplace_back(m.name,
                     words + " (nominal, not checked against the source: " + m.source + ").");
  }
  return out;
}

const io::Key& material_key(const char* table) {
  return io::key(table, "material")
      .word("a material", material_glossary)
      .otherwise_as("none; its numbers are given")
      .description(
          "Material that gives density, Young's modulus, Poisson's ratio and expansion unless they "
          "are given.");
}

}  // namespace flexmorph::cases
