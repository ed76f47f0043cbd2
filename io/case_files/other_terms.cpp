#include "io/case_files/other_terms.h"

#include <algorithm>
#include <array>
#include <string_view>

namespace flexmorph::io {
namespace {

struct Term {
  std::string_view word;
  // The first of these words that is known is the answer; the second one may be empty.
  std::array<std::string_view, 2> here;
};

bool ends_with_degrees(const std::string& key) {
  return key.ends_with("_deg") || key.ends_with("_degree") || key.ends_with("_degrees") ||
         key == "degrees";
}

}  // namespace

std::string word_for_term(const std::string& word, std::span<const std::string> known) {
  static constexpr std::array kTerms = {
      Term{"prismatic", {"slider"}},
      Term{"translational", {"slider"}},
      Term{"translation", {"slider"}},
      Term{"cylindrical", {"slider"}},
      Term{"fixed", {"weld", "clamp"}},
      Term{"rigid", {"weld"}},
      Term{"welded", {"weld"}},
      Term{"bonded", {"weld"}},
      Term{"hinge", {"revolute"}},
      Term{"rotational", {"revolute"}},
      Term{"pinned", {"pin", "revolute"}},
      Term{"encastre", {"clamp"}},
      Term{"roller", {"support"}},
      Term{"motor", {"angle_drive"}},
      Term{"actuator", {"point_drive", "angle_drive"}},
      Term{"contact", {"stop"}},
      Term{"bumper", {"stop"}},
      Term{"spring", {"linear"}},
      Term{"damper", {"linear"}},
      Term{"e", {"youngs_modulus"}},
      Term{"E", {"youngs_modulus"}},
      Term{"elastic_modulus", {"youngs_modulus"}},
      Term{"young", {"youngs_modulus"}},
      Term{"nu", {"poisson_ratio"}},
      Term{"poissons_ratio", {"poisson_ratio"}},
      Term{"rho", {"density"}},
      Term{"moment_of_inertia", {"inertia"}},
      Term{"mass_moment_of_inertia", {"inertia"}},
      Term{"centre_of_mass", {"center"}},
      Term{"center_of_mass", {"center"}},
      Term{"dt", {"step"}},
      Term{"time_step", {"step"}},
      Term{"timestep", {"step"}},
      Term{"volfrac", {"max_volume"}},
      Term{"volume_fraction", {"max_volume"}},
      Term{"min_size", {"min_feature"}},
      Term{"minimum_member_size", {"min_feature"}},
      Term{"filter_radius", {"min_feature"}},
      Term{"newmark", {"generalized_alpha"}},
      Term{"hht", {"generalized_alpha"}},
  };
  for (const Term& term : kTerms)
    if (term.word == word)
      for (const std::string_view here : term.here)
        if (!here.empty() && std::find(known.begin(), known.end(), here) != known.end())
          return std::string(here);
  return "";
}

std::string answer_to_key(const std::string& key) {
  if (ends_with_degrees(key))
    return "angles are in radians, or in degrees as a text such as \"30 deg\"";
  if (key == "friction" || key == "friction_coefficient") return "there is no friction";
  if (key == "contact") return "there is no contact between bodies; [[spring]] has end stops";
  if (key == "material" || key == "materials")
    return "each body has its own youngs_modulus, poisson_ratio and density";
  if (key == "unit" || key == "units")
    return "numbers are in SI units; a number in another unit is a text such as \"12 mm\"";
  if (key == "frequency" || key == "eigenfrequency" || key == "natural_frequency")
    return "natural frequencies are neither prescribed nor optimized";
  if (key == "stress" || key == "stress_limit" || key == "max_stress")
    return "there is no constraint on stress; the verification reports the largest one";
  if (key == "control" || key == "controller") return "there is no feedback control";
  return "";
}

}  // namespace flexmorph::io
