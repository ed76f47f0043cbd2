#include "optim/mmc/length_scale/idle_components.h"

#include <algorithm>
#include <utility>

#include "optim/mmc/length_scale/crisp_union.h"

namespace flexmorph::mmc {
namespace {

/// Strain energy per area of what carries nothing, in parts of the mean one.
constexpr double kIdleDensity = 0.2;

/// A list of components without some of them, each with its images.
std::vector<Component> without(const std::vector<Component>& all, const std::vector<bool>& gone) {
  std::vector<Component> out;
  for (size_t k = 0; k < all.size(); ++k)
    if (!gone[k % gone.size()]) out.push_back(all[k]);
  return out;
}

}  // namespace

std::vector<int> remove_idle(const BodyProblem& problem, ComplianceEvaluator& loads, Design& design,
                             bool keeps_width, const std::function<bool()>& go_on) {
  CrispUnion crisp(problem, loads);
  const std::vector<Component> all = design.components();
  const size_t own = all.size() / design.n_images();
  const VectorXd density = crisp.energy_density(all), fractions = crisp.fractions(all);
  std::vector<std::pair<double, size_t>> candidates;  // by the energy of what they cover alone
  for (size_t k = 0; k < own; ++k) {
    std::vector<bool> gone(own, false);
    gone[k] = true;
    const VectorXd alone = fractions - crisp.fractions(without(all, gone));
    const double energy = density.dot(alone);
    if (energy <= kIdleDensity * alone.sum()) candidates.emplace_back(energy, k);
  }
  std::sort(candidates.begin(), candidates.end());
  const Connectivity before = crisp.connectivity(all);
  int islands = before.islands;
  const double narrowest =
      keeps_width ? std::min(crisp.features(all).solid, problem.widths.solid) : 0;
  double merit = crisp.compliance(all) * fractions.sum();
  std::vector<bool> gone(own, false);
  for (const auto& [energy, k] : candidates) {
    if (go_on && !go_on()) break;
    gone[k] = true;
    const std::vector<Component> left = without(all, gone);
    bool goes = !left.empty();
    if (goes) {
      const double now = crisp.compliance(left) * crisp.fractions(left).sum();
      goes = now <= merit;
      if (goes) {
        const Connectivity held = crisp.connectivity(left);
        goes = (held.connected || !before.connected) && held.islands <= islands &&
               held.unused_supports.size() <= before.unused_supports.size() &&
               (narrowest == 0 || crisp.features(left).solid >= narrowest);
        if (goes) islands = held.islands;
      }
      if (goes) merit = now;
    }
    gone[k] = goes;
  }
  std::vector<int> removed;
  for (size_t k = 0; k < all.size(); ++k)
    if (gone[k % own]) removed.push_back(static_cast<int>(k));
  if (!removed.empty()) design = design.with(without(all, gone));
  return removed;
}

}  // namespace flexmorph::mmc
