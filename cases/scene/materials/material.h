#pragma once

#include <optional>
#include <span>
#include <string>

#include "io/case_files/key.h"

/// Materials that a case can name instead of giving their numbers.
namespace flexmorph::cases {

/// Nominal numbers of a material.
struct Material {
  const char* name;       ///< Name in case files.
  double density;         ///< Density [kg/m^3].
  double youngs_modulus;  ///< Young's modulus [Pa].
  double poisson_ratio;   ///< Poisson's ratio [-].
  std::optional<double>
      expansion;       ///< Coefficient of thermal expansion [1/K], if the source has it.
  const char* source;  ///< Publications that contain the numbers.
};

/// Returns all materials that a case can name.
std::span<const Material> materials();
/// Returns the material of a name, or null.
const Material* find_material(const std::string& name);
/// Returns the names of all materials, each with its numbers and its source.
io::Glossary material_glossary();

/// Declares the key `material` of a table.
const io::Key& material_key(const char* table);

}  // namespace flexmorph::cases
