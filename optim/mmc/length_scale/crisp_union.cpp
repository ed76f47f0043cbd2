#include "optim/mmc/length_scale/crisp_union.h"

#include <algorithm>

namespace flexmorph::mmc {
namespace {

/// Number of stored lists of components.
constexpr size_t kCachedUnions = 3;

bool same(const Component& a, const Component& b) { return a.parameters() == b.parameters(); }

/// Returns the components that are in only one of both lists.
std::vector<Component> only_in_one(const std::vector<Component>& a,
                                   const std::vector<Component>& b) {
  std::vector<Component> out;
  const auto add = [&](const std::vector<Component>& from, const std::vector<Component>& to) {
    for (const Component& c : from)
      if (std::none_of(to.begin(), to.end(), [&](const Component& o) { return same(c, o); }))
        out.push_back(c);
  };
  add(a, b);
  add(b, a);
  return out;
}

}  // namespace

CrispUnion::CrispUnion(const BodyProblem& problem, ComplianceEvaluator& loads)
    : problem_(problem), loads_(loads), ersatz_(ersatz_of(problem)) {}

CrispUnion::Known& CrispUnion::known(const std::vector<Component>& of) {
  for (Known& k : known_)
    if (std::equal(k.of.begin(), k.of.end(), of.begin(), of.end(), same)) return k;
  if (known_.size() == kCachedUnions) known_.pop_back();
  return known_.emplace_front(Known{of, {}, {}});
}

const std::vector<Region>& CrispUnion::regions(const std::vector<Component>& of) {
  Known& k = known(of);
  if (!k.regions) k.regions = regions_of(problem_, of, kOutlineTolerance * problem_.grid.dx());
  return *k.regions;
}

const VectorXd& CrispUnion::fractions(const std::vector<Component>& of) {
  Known& k = known(of);
  if (k.fractions) return *k.fractions;
  for (const Known& other : known_) {
    if (!other.fractions) continue;
    const std::vector<Component> changed = only_in_one(of, other.of);
    k.fractions = other.fractions;
    update_fractions(problem_, of, changed, *k.fractions);
    return *k.fractions;
  }
  k.fractions = fractions_of(problem_, of);
  return *k.fractions;
}

double CrispUnion::compliance(const std::vector<Component>& of) {
  return design_compliance(problem_, loads_, ersatz_.crisp(fractions(of)));
}

Connectivity CrispUnion::connectivity(const std::vector<Component>& of) {
  return connectivity_of(problem_, regions(of));
}

Features CrispUnion::features(const std::vector<Component>& of) {
  return features_of(problem_, regions(of));
}

VectorXd CrispUnion::energy_density(const std::vector<Component>& of) {
  const VectorXd& all = fractions(of);
  const CellScaleFactors crisp = ersatz_.crisp(all);
  ComplianceEvaluator::Value value;
  loads_.evaluate(crisp.stiffness, crisp.mass, value);
  const VectorXd energy = value.d_stiffness.cwiseAbs();
  return energy * (all.sum() / all.dot(energy));
}

}  // namespace flexmorph::mmc
