#include "optim/mmc/length_scale/unloaded_components.h"

#include <algorithm>
#include <utility>

#include "optim/mmc/length_scale/crisp_union.h"

namespace flexmorph::mmc {
namespace {

/// Largest strain energy per area of an unloaded component, relative to the mean of the design.
constexpr double kUnloadedDensity = 0.2;

/// Returns a list of components without some of them and without their images.
std::vector<Component> without(const std::vector<Component>& all, const std::vector<bool>& gone) {
  std::vector<Component> out;
  for (size_t k = 0; k < all.size(); ++k)
    if (!gone[k % gone.size()]) out.push_back(all[k]);
  return out;
}

}  // namespace

std::vector<int> remove_unloaded_components(const BodyProblem& problem, ComplianceEvaluator& loads,
                                            Design& design, bool keeps_width,
                                            const std::function<bool()>& keep_running) {
  CrispUnion crisp(problem, loads);
  const std::vector<Component> all = design.components();
  const size_t own = all.size() / design.n_images();
  const VectorXd density = crisp.energy_density(all), fractions = crisp.fractions(all);
  std::vector<std::pair<double, size_t>>
      candidates;  // energy of the material that they cover alone, index
  for (size_t k = 0; k < own; ++k) {
    std::vector<bool> gone(own, false);
    gone[k] = true;
    const VectorXd alone = fractions - crisp.fractions(without(all, gone));
    const double energy = density.dot(alone);
    if (energy <= kUnloadedDensity * alone.sum()) candidates.emplace_back(energy, k);
  }
  std::sort(candidates.begin(), candidates.end());
  const Connectivity before = crisp.connectivity(all);
  int islands = before.islands;
  const Features first = keeps_width ? crisp.features(all) : Features{0, 0};
  const auto is_as_wide = [&](const std::vector<Component>& left) {
    if (!keeps_width) return true;
    const Features now = crisp.features(left);
    return now.solid >= std::min(first.solid, problem.widths.solid) &&
           now.gap >= std::min(first.gap, problem.widths.gap);
  };
  double compliance = crisp.compliance(all), objective = compliance * fractions.sum();
  std::vector<bool> gone(own, false);
  const auto goes = [&](const std::vector<Component>& left, bool many) {
    if (left.empty()) return false;
    constexpr double kNothing = 1e-6;
    const double without_them = crisp.compliance(left);
    if (many && !(without_them <= (1 + kNothing) * compliance)) return false;
    const double now = without_them * crisp.fractions(left).sum();
    if (!(now <= objective)) return false;
    const Connectivity held = crisp.connectivity(left);
    if ((!held.connected && before.connected) || held.islands > islands ||
        held.unused_supports.size() > before.unused_supports.size())
      return false;
    if (!is_as_wide(left)) return false;
    islands = held.islands;
    compliance = without_them;
    objective = now;
    return true;
  };
  // Several components are removed together, which takes one analysis, if the compliance does not
  // rise. Otherwise the two halves of the set are tried one after the other.
  const std::function<void(size_t, size_t)> remove = [&](size_t from, size_t to) {
    if (from == to || (keep_running && !keep_running())) return;
    const std::vector<bool> kept = gone;
    for (size_t c = from; c < to; ++c) gone[candidates[c].second] = true;
    if (goes(without(all, gone), to - from > 1)) return;
    gone = kept;
    if (to - from == 1) return;
    const size_t middle = from + (to - from) / 2;
    remove(from, middle);
    remove(middle, to);
  };
  remove(0, candidates.size());
  std::vector<int> removed;
  for (size_t k = 0; k < all.size(); ++k)
    if (gone[k % own]) removed.push_back(static_cast<int>(k));
  if (!removed.empty()) design = design.with(without(all, gone));
  return removed;
}

}  // namespace flexmorph::mmc
