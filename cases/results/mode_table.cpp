#include "cases/results/mode_table.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "geometry/text.h"
#include "io/files.h"

namespace flexmorph::cases {
namespace {

std::string frequency_text(const fem::NaturalMode& mode) {
  return mode.is_rigid() ? "0" : formatted("%.5g", mode.frequency());
}

std::string damping_text(const fem::NaturalMode& mode) {
  if (mode.is_rigid()) return "";
  return formatted("%.3g", damping_of(mode));
}

std::string modes_text(int n) { return std::to_string(n) + (n == 1 ? " mode" : " modes"); }

}  // namespace

double damping_of(const fem::NaturalMode& mode) {
  constexpr double kRoundOff = 1e-6;  // of the computed eigenvalues
  const double ratio = mode.damping_ratio();
  return std::abs(ratio) < kRoundOff ? 0 : ratio;
}

ModeTable mode_table(const Scene& scene, double time, OperatingPoint& point, int count) {
  ModeTable out;
  out.time = time;
  out.state = point.words;
  for (const fem::Body& body : point.model.bodies()) out.bodies.push_back(body.name);
  out.found = fem::natural_modes(point.model, point.x, point.turning, count);
  if (!scene.designs.empty() && !scene.domain)
    out.notes.emplace_back("Designed bodies consist of full material here.");
  if (scene.has_eulerian_lines())
    out.notes.emplace_back("Meshes at free material lines are those of the start of the motion.");
  return out;
}

std::string moving_bodies(const ModeTable& table, const fem::NaturalMode& mode, size_t most) {
  constexpr double kNoticed = 0.005;
  std::vector<size_t> order(table.bodies.size());
  std::iota(order.begin(), order.end(), size_t{0});
  std::stable_sort(order.begin(), order.end(), [&](size_t a, size_t b) {
    return mode.kinetic_share[a] > mode.kinetic_share[b];
  });
  std::string out;
  size_t named = 0;
  for (const size_t b : order) {
    if (mode.kinetic_share[b] < kNoticed) break;
    if (named++ == most) return out + ", ...";
    out += (out.empty() ? "" : ", ") + table.bodies[b] + " " +
           formatted("%.0f %%", 100 * mode.kinetic_share[b]);
  }
  return out;
}

std::vector<std::vector<std::string>> mode_rows(const ModeTable& table) {
  constexpr size_t kMaxNamed = 3;
  std::vector<std::vector<std::string>> rows = {{"mode", "frequency [Hz]"}};
  if (table.found.is_complex) rows[0].emplace_back("damping ratio");
  rows[0].emplace_back("kinetic energy");
  for (size_t k = 0; k < table.found.modes.size(); ++k) {
    const fem::NaturalMode& mode = table.found.modes[k];
    std::vector<std::string>& row = rows.emplace_back();
    row = {std::to_string(k + 1), frequency_text(mode)};
    if (table.found.is_complex) row.push_back(damping_text(mode));
    row.push_back(moving_bodies(table, mode, kMaxNamed));
  }
  return rows;
}

std::vector<std::string> mode_remarks(const ModeTable& table) {
  const fem::NaturalModes& found = table.found;
  const int all = static_cast<int>(found.modes.size()), rigid = found.n_rigid();
  std::vector<std::string> out;
  out.push_back(
      std::to_string(found.degrees_of_freedom) +
      (found.degrees_of_freedom == 1 ? " degree of freedom with the drives held"
                                     : " degrees of freedom with the drives "
                                       "held") +
      (rigid == 0
           ? std::string()
           : ", " + std::string(rigid == all && all < found.degrees_of_freedom ? "at least " : "") +
                 modes_text(rigid) + " of frequency 0 (nothing restores it)"));
  const auto growing = std::count_if(found.modes.begin(), found.modes.end(),
                                     [](const fem::NaturalMode& m) { return m.grows(); });
  if (growing > 0)
    out.push_back("warning: " + modes_text(static_cast<int>(growing)) +
                  (growing == 1 ? " grows" : " grow") +
                  " in time (negative damping ratio): the equilibrium is unstable");
  for (const std::string& note : table.notes) out.push_back(note);
  return out;
}

std::string frequencies_text(const ModeTable& table, int most) {
  const int rigid = table.found.n_rigid();
  std::string out = rigid == 0 ? "" : modes_text(rigid) + " of frequency 0";
  int named = 0;
  for (const fem::NaturalMode& mode : table.found.modes) {
    if (mode.is_rigid() || named == most) continue;
    ++named;
    out += (out.empty() ? "" : ", ") + formatted("%.4g", mode.frequency());
    if (mode.grows()) out += " (unstable)";
  }
  if (out.empty()) return "drives determine all motions";
  return named == 0 ? out : out + " Hz";
}

}  // namespace flexmorph::cases
