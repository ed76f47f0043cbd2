#pragma once

#include <optional>
#include <string>
#include <vector>

#include "cases/accuracy/values.h"
#include "cases/study/orders.h"

/// The knobs of accuracy: what of a case can be set finer or coarser, or in another way.
namespace flexmorph::cases {

/// One setting of a knob.
struct Level {
  double h = 1;                        ///< relative to the case itself; falls from coarse to fine
  std::string name;                    ///< "16 x 16 elements", for people
  std::vector<std::string> overrides;  ///< KEY=VALUE; none: the case as it is
};

/// A row of the table of knobs. A new one is a row there, nothing else.
struct Knob {
  std::string name;
  std::string group;  ///< knobs of a group share a limit: that of the one named like the group
  Approach approach = Approach::power;
  double cost_exponent = 0;  ///< time ~ h^-cost_exponent, a first guess
  bool is_ladder = true;     ///< do the levels of the knob have a limit of their own?
  /// Why a scene does not have it in this part; empty: it has it.
  std::string (*absent)(const Scene& scene, Part part);
  /// Levels of the scene, coarse to fine; one is the scene's own where it is a level at all. Some
  /// may be refused when they are read.
  std::vector<Level> (*levels)(const Scene& scene, const io::CaseFile& file);
  std::optional<Theory> (*theory)(const Scene& scene, Part part, const std::string& quantity);
  bool is_setting = true;  ///< false: another model, which is never recommended
};

const std::vector<Knob>& knobs();
/// The rows of the table that are about designs.
std::vector<Knob> design_knobs();
std::vector<std::string> knob_names();
/// The row of that name. @throws Error (input).
const Knob& knob(const std::string& name);

}  // namespace flexmorph::cases
