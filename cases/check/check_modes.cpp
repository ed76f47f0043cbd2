#include "cases/check/check_modes.h"

#include <cmath>
#include <optional>

#include "cases/check/plausibility.h"
#include "cases/results/mode_table.h"
#include "io/files.h"

namespace flexmorph::cases {
namespace {

/// Largest numbers of unknowns for which a check computes natural frequencies, which then takes
/// well below a second. An equilibrium at rest that drives do not determine takes longer to find.
constexpr int kMaxUnknowns = 3000, kMaxSearched = 600;

/// A line of the section, and the lowest frequency that is not zero [Hz].
struct AtTime {
  std::string words;
  std::optional<double> lowest{};
  bool is_known = true;
};

AtTime frequencies_at(const PreparedCase& prepared, double time) {
  constexpr int kShown = 3, kRigid = 3;  // a free body in the plane has three rigid modes
  try {
    OperatingPoint point = operating_point(prepared, time, false);
    const ModeTable table = mode_table(prepared.scene(), time, point, kShown + kRigid);
    AtTime out{frequencies_text(table, kShown)};
    for (const fem::NaturalMode& mode : table.found.modes)
      if (!out.lowest && mode.frequency() > 0) out.lowest = mode.frequency();
    return out;
  } catch (const Error& error) {
    return {std::string("not available: ") + error.what(), {}, false};
  }
}

}  // namespace

std::string natural_frequencies_text(const PreparedCase& prepared) {
  const Scene& scene = prepared.scene();
  const fem::Workspace& model = prepared.mechanism().model;
  std::string out = "\nnatural frequencies\n";
  const std::string command = "flexmorph modes " + scene.name;
  const bool driven = scene.statics || drives_determine_motion(prepared, 0);
  if (model.n_dofs() > (driven ? kMaxUnknowns : kMaxSearched))
    return out +
           summary_row("not computed here", "the model has " + std::to_string(model.n_dofs()) +
                                                " unknowns; use: " + command);
  // The search for an equilibrium takes seconds where material slides without a restoring force.
  if (!driven && scene.has_eulerian_lines())
    return out + summary_row("not computed here", "material slides freely; use: " + command);
  if (scene.statics)
    return out + summary_row("at load factor 0", frequencies_at(prepared, 0).words);
  if (!driven && scene.drives.empty())
    return out + summary_row("at rest", frequencies_at(prepared, 0).words);
  std::optional<double> lowest;
  for (const double part : {0.0, 0.5, 1.0}) {
    const double time = part * scene.time.end;
    const AtTime at = frequencies_at(prepared, time);
    out += summary_row("at t = " + io::to_text(time, 4) + " s", at.words);
    if (!at.is_known) break;  // later times are followed from this one
    if (at.lowest && (!lowest || *at.lowest < *lowest)) lowest = at.lowest;
  }
  if (lowest && !scene.time.tolerance)
    out += summary_row(
        "", "time step * lowest frequency = " + io::to_text(scene.time.step * *lowest, 2));
  return out + summary_row("", "more: " + command + " --time T");
}

}  // namespace flexmorph::cases
