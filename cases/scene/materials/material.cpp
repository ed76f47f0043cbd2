#include "cases/scene/materials/material.h"

#include "io/files.h"

namespace flexmorph::cases {
namespace {

constexpr const char* kPlastics =
    "Dowling, Mechanical Behavior of Materials, table 5.2; density and expansion: "
    "engineersedge.com, properties of plastics";

// The numbers were compared with texts that reproduce the tables of these sources: Eurocode
// software, data sheets of manufacturers, lecture notes. Single parts differ from them by a few
// percent, with the alloy and its treatment.
const Material kMaterials[] = {
    {"steel", 7850, 210e9, 0.3, 12e-6, "structural steel: EN 1993-1-1, 3.2.6"},
    {"stainless_steel", 7900, 200e9, 0.3, 16e-6,
     "1.4301 (304): EN 10088-1; Poisson's ratio: EN 1993-1-1, 3.2.6"},
    {"ductile_iron",
     7100,
     169e9,
     0.28,
     {},
     "EN-GJS-400-18: EN 1563 (1997); Poisson's ratio: data sheet of a foundry"},
    {"aluminium", 2700, 70e9, 0.3, 23e-6, "EN 1999-1-1, 3.2.5"},
    {"titanium", 4420, 114e9, 0.31, 8.6e-6, "Ti-6Al-4V (grade 5): data sheets of manufacturers"},
    {"magnesium", 1738, 44.7e9, 0.291, 24.8e-6,
     "pure: matmake.com, after Cardarelli, Materials Handbook"},
    {"copper", 8920, 130e9, 0.343, 16.8e-6,
     "Dowling, Mechanical Behavior of Materials, table 5.2; density and expansion: Copper "
     "Development Association, Introduction to Copper, table 5"},
    {"brass", 8530, 101e9, 0.35, 19.9e-6,
     "70Cu-30Zn: Dowling, Mechanical Behavior of Materials, table 5.2; density and expansion: "
     "data sheets of C26000"},
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
    out.emplace_back(m.name, words + " (nominal; source: " + m.source + ").");
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
