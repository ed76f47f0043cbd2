#include "cases/check/check_figures.h"

#include <cmath>
#include <numbers>

#include "cases/check/check_cost.h"
#include "cases/results/figures.h"
#include "io/files.h"

namespace flexmorph::cases {
namespace {

using io::to_text;

std::string bending_text(const BendingFigures& f) {
  std::string out;
  const std::string what = "bending of " + f.body;
  std::string words = "a strip of length / depth " + to_text(f.slenderness(), 3);
  if (f.frequencies[0] > 0)
    words = "lowest " + to_text(f.frequencies[0], 3) + " and " + to_text(f.frequencies[1], 3) +
            " Hz, " + to_string(f.support) + ", " + words;
  else
    words += ", " + to_string(f.support);
  out = summary_row(what, words);
  words.clear();
  const auto add = [&](const std::string& more) { words += (words.empty() ? "" : "; ") + more; };
  if (f.step_frequency > 0) add("time step times frequency " + to_text(f.step_frequency, 2));
  if (f.sag) add("hangs by " + to_text(*f.sag, 2) + " of its length under gravity");
  if (f.bend) add("bends by " + to_text(*f.bend, 2) + " of its length under its loads, if linear");
  return words.empty() ? out : out + summary_row("", words);
}

std::string of_all(double bytes, double all) {
  return bytes_text(bytes) + (std::isfinite(all) ? " of " + bytes_text(all) : "");
}

std::string room_text(const Scene& scene, const Mechanism* mechanism, const Machine& machine) {
  const Extent extent = extent_of(scene);
  const bool most = extent.iterations > 0 || extent.step_key == "static.max_steps",
             least = scene.time.tolerance.has_value();
  const std::string bound = most ? "at most about " : least ? "at least about " : "about ";
  return summary_row("expected", "memory about " + of_all(extent.memory_bytes(), machine.memory) +
                                     ", time " + bound +
                                     duration_text(expected_seconds(scene, mechanism)) +
                                     ", files " + (most ? "at most about " : "about ") +
                                     of_all(extent.disk_bytes(), machine.disk) + " free");
}

}  // namespace

std::string summary_row(const std::string& what, const std::string& words) {
  constexpr size_t kColumn = 22;
  const size_t gap = what.size() < kColumn ? kColumn - what.size() : 1;
  return "  " + what + std::string(gap, ' ') + words + "\n";
}

std::string figures_text(const Scene& scene, const Mechanism* mechanism, const Machine& machine) {
  std::string out = "\nfigures\n";
  for (const BendingFigures& f : bending_figures(scene)) out += bending_text(f);
  for (const TurnFigures& turn : turn_figures(scene))
    out +=
        summary_row(turn.what, "turns by up to " + to_text(turn.angle, 4) + " rad, " +
                                   to_text(turn.angle * 180 / std::numbers::pi, 4) + " degrees, " +
                                   to_text(turn.angle / (2 * std::numbers::pi), 3) + " turns");
  out += room_text(scene, mechanism, machine);
  const std::vector<std::string> odd = odd_remarks(scene);
  if (!odd.empty()) out += "\nout of the ordinary\n";
  for (const std::string& each : odd) out += "  " + each + "\n";
  return out;
}

}  // namespace flexmorph::cases
