#pragma once

#include <functional>
#include <optional>
#include <vector>

#include "optim/mmc/designed_parts.h"

namespace flexmorph::mmc {

/// Designs of bodies after a repair of those that want one.
struct Mended {
  std::vector<std::optional<CleanUp>> clean_ups;
  std::vector<Design> designs;
  bool reached = true, changed = false;
  double objective = 0;  ///< sum of the objectives of all crisp designs
  double violation = 0;  ///< largest crisp_violation() of limits

  bool better_than(const Mended& other) const {
    if (reached != other.reached) return reached;
    return violation == other.violation ? objective < other.objective : violation < other.violation;
  }
};

/// Repairs the designs (clean_up()). What a common budget of mass leaves goes to the bodies as they
/// have shared it so far.
/// @param gaps  part of the wanted widths of gaps below which they are closed
/// @param trims, go_on  see RepairWishes
Mended repaired(std::vector<Part>& parts, double gaps, bool trims,
                const std::function<bool()>& go_on);

/// Joins components that lie end to end, and puts bars where they are missed (renewed_parts.h), in
/// designs that are to be repaired. The designs are then shaped, and repaired.
/// @return what came and went, of each design
std::vector<CleanUp> renewed(std::vector<Part>& parts, const std::function<bool()>& go_on);

/// The designs as they are, and whether there is something to repair.
Mended looked_over(std::vector<Part>& parts);

/// The designs as they are, as repaired before.
Mended as_they_are(const std::vector<Part>& parts);

}  // namespace flexmorph::mmc
