#include "optim/mmc/under_repair.h"

#include <algorithm>
#include <limits>
#include <set>
#include <utility>

namespace flexmorph::mmc {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
/// Gaps wider than this are not bridged by cells [cells].
constexpr double kBridged = 3;
/// Full material in a gap that loads pass through would have so many times the energy density of
/// the material around: 10 to 500 times in bars that were cut, about once in idle slits.
constexpr double kConcentration = 3;
/// A cut that costs more than this part of the compliance is one through what carries: cells of a
/// rim cost a thousandth at most, bars 4 to 50 hundredths. Bars share what they carry: cuts of half
/// a hundredth each came to a fifth together.
constexpr double kCostOfCut = 2e-3;
/// Gaps of fewer cells are bridged all along, so that nothing need be concentrated in them: two
/// bars side by side were one to the cells, for a twenty-fifth of the compliance.
constexpr double kGlued = 1.5;
/// Half-thickness of a layer that parts cells: those that share a node may be 1.41 apart [cells].
constexpr double kLayer = 0.75;
/// Cells filled more than this are material that a cut leaves.
constexpr double kFilled = 0.9;
/// Lists of components that are remembered: that under repair, and what it is compared to.
constexpr size_t kKnown = 3;
/// Outlines and round-off take as much from a gap that is wanted.
constexpr double kWithin = 0.99;

bool same(const Component& a, const Component& b) { return a.parameters() == b.parameters(); }

/// Those of one list that the other one does not have, and the other way round.
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

UnderRepair::UnderRepair(const BodyProblem& problem, ComplianceEvaluator& loads,
                         const Widths& wanted, std::function<bool()> go_on)
    : parts(problem.design.components()),
      patch(parts.size(), false),
      problem_(problem),
      loads_(loads),
      go_on_(std::move(go_on)),
      wanted_(wanted),
      ersatz_(ersatz_of(problem)) {}

std::vector<Component> UnderRepair::less(size_t k) const {
  std::vector<Component> out = parts;
  out.erase(out.begin() + static_cast<std::ptrdiff_t>(k));
  return out;
}

void UnderRepair::drop(size_t k) {
  parts.erase(parts.begin() + static_cast<std::ptrdiff_t>(k));
  patch.erase(patch.begin() + static_cast<std::ptrdiff_t>(k));
}

UnderRepair::Known& UnderRepair::known(const std::vector<Component>& of) const {
  for (Known& k : known_)
    if (std::equal(k.of.begin(), k.of.end(), of.begin(), of.end(), same)) return k;
  if (known_.size() == kKnown) known_.pop_back();
  return known_.emplace_front(Known{of, {}, {}});
}

std::vector<Region> UnderRepair::regions(const std::vector<Component>& of) const {
  Known& k = known(of);
  if (!k.regions) k.regions = regions_of(problem_, of, kOutlineTolerance * problem_.grid.dx());
  return *k.regions;
}

VectorXd UnderRepair::fractions(const std::vector<Component>& of) const {
  Known& k = known(of);
  if (k.fractions) return *k.fractions;
  for (const Known& other : known_) {
    if (!other.fractions) continue;
    std::vector<Component> changed = only_in_one(of, other.of);
    k.fractions = other.fractions;
    update_fractions(problem_, of, changed, *k.fractions);
    return *k.fractions;
  }
  k.fractions = fractions_of(problem_, of);
  return *k.fractions;
}

double UnderRepair::volume(const std::vector<Component>& of) const {
  return fractions(of).sum() / ersatz_.n_domain_cells();
}

double UnderRepair::compliance(const std::vector<Component>& of) const {
  return design_compliance(problem_, loads_, ersatz_.sharp(fractions(of)));
}

double UnderRepair::merit(const std::vector<Component>& of, double below) const {
  const VectorXd all = fractions(of);
  const double out = design_compliance(problem_, loads_, ersatz_.sharp(all)) * all.sum();
  if (!(out < below)) return kInfinity;  // before the union is asked for
  const Connectivity whole = connectivity_of(problem_, regions(of));
  return whole.connected && whole.islands <= islands_ ? out : kInfinity;
}

void UnderRepair::count_islands() { islands_ = connectivity_of(problem_, regions(parts)).islands; }

double UnderRepair::least_merit_without(size_t k) const {
  const VectorXd own = fractions(parts) - fractions(less(k));
  const double all = fractions_.sum();
  return compliance_ * (1 + density_.dot(own) / all) * (all - own.sum());
}

std::vector<NarrowPlace> UnderRepair::places() const {
  const std::vector<Region> pieces = regions(parts);
  // The tolerance of outlines counts twice.
  const double tolerance = 2 * kOutlineTolerance * problem_.grid.dx();
  std::vector<NarrowPlace> out = narrow_places_of(problem_, pieces, wanted_.largest() + tolerance);
  std::set<std::pair<size_t, size_t>> parted;  // a bridge is enough for two pieces
  std::erase_if(out, [&](const NarrowPlace& p) {
    if (p.solid) return p.width >= wanted_.solid + tolerance;
    // A contact is on an outline, up to rounding: a little further on is material.
    const auto piece_at = [&](const Vec2& contact) {
      const Vec2 inside = contact + 1e-6 * (contact - p.center);
      size_t k = 0;
      while (k < pieces.size() && !contains(pieces[k], inside)) ++k;
      return k;
    };
    const auto [one, other] = std::minmax({piece_at(p.a), piece_at(p.b)});
    if (one == other || ends_at_held(p)) return p.width >= kWithin * wanted_.gap;
    return !parted.insert({one, other}).second;
  });
  return out;
}

bool UnderRepair::ends_at_held(const NarrowPlace& p) const {
  return std::any_of(problem_.held.begin(), problem_.held.end(), [&](const Segment& line) {
    return distance(line, p.a) < 1e-6 * problem_.grid.dx();
  });
}

double UnderRepair::smallest(const std::vector<NarrowPlace>& narrow) const {
  double out = kInfinity;
  for (const NarrowPlace& p : narrow) {
    const bool wide = !p.solid && p.width >= kWithin * wanted_.gap;  // a slit, or torn
    out = std::min(out, wide ? 1 + p.width : p.width / (p.solid ? wanted_.solid : wanted_.gap));
  }
  return out;
}

std::vector<NarrowPlace> UnderRepair::torn_gaps() const {
  if (!(wanted_.gap > 0)) return {};
  std::vector<NarrowPlace> out =
      narrow_places_of(problem_, regions(parts), kBridged * problem_.grid.dx());
  const double whole = compliance(parts);
  std::erase_if(out, [&](const NarrowPlace& p) {
    if (p.solid) return true;
    if (is_cut_from_held(p, whole)) return false;
    if (p.width > kGlued * problem_.grid.dx() && !looks_torn(p)) return true;
    return compliance_cut_at(p) < (1 + kCostOfCut) * whole;
  });
  return out;
}

std::vector<NarrowPlace> UnderRepair::cuts_from_held() const {
  if (problem_.held.empty() || !(wanted_.gap > 0)) return {};
  std::vector<NarrowPlace> out =
      narrow_places_of(problem_, regions(parts), kBridged * problem_.grid.dx());
  const double whole = compliance(parts);
  std::erase_if(out, [&](const NarrowPlace& p) { return p.solid || !is_cut_from_held(p, whole); });
  return out;
}

bool UnderRepair::is_cut_from_held(const NarrowPlace& p, double whole) const {
  return ends_at_held(p) && whole > (1 + kCostOfCut) * compliance_filled_at(p);
}

/// Those with a center within a feature's width of the gap, or within that of two cells.
std::vector<int> UnderRepair::cells_around(const NarrowPlace& p) const {
  const Grid& g = problem_.grid;
  const double reach = 0.75 * std::max({wanted_.largest(), p.width, 2 * g.dx()});
  std::vector<int> out;
  for (int i = 0; i < g.nx; ++i)
    for (int j = 0; j < g.ny; ++j)
      if ((g.cell_center(i, j) - p.center).norm() < reach) out.push_back(g.cell(i, j));
  return out;
}

/// Those around that are not full and have their center between the contacts, in a layer thick
/// enough to part all cells on its one side from those on the other.
std::vector<int> UnderRepair::cells_between(const NarrowPlace& p) const {
  const Grid& g = problem_.grid;
  const Vec2 across = (p.b - p.a).normalized();
  const double half = std::max(0.5 * p.width, kLayer * g.dx());
  std::vector<int> out = cells_around(p);
  std::erase_if(out, [&](int cell) {
    const Vec2 from = g.cell_center(cell / g.ny, cell % g.ny) - p.center;
    return fractions_[cell] >= kFilled || std::abs(from.dot(across)) > half;
  });
  return out;
}

bool UnderRepair::looks_torn(const NarrowPlace& p) const {
  double inside = 0, around = 0, area = 0;
  for (const int cell : cells_between(p)) inside = std::max(inside, density_[cell]);
  for (const int cell : cells_around(p)) {
    if (fractions_[cell] < kFilled) continue;
    around += density_[cell];
    area += 1;
  }
  // A slanted bar of two cells may fill none.
  return area == 0 || inside * area > kConcentration * around;
}

/// With the partly filled cells of the gap as void.
double UnderRepair::compliance_cut_at(const NarrowPlace& p) const {
  VectorXd cut = fractions_;
  for (const int cell : cells_between(p)) cut[cell] = 0;
  return design_compliance(problem_, loads_, ersatz_.sharp(cut));
}

/// With full material from contact to contact.
double UnderRepair::compliance_filled_at(const NarrowPlace& p) const {
  const Grid& g = problem_.grid;
  const Vec2 across = (p.b - p.a).normalized(), along(-across.y(), across.x());
  VectorXd filled = fractions_;
  for (const int cell : cells_around(p)) {
    const Vec2 from = g.cell_center(cell / g.ny, cell % g.ny) - p.center;
    if (std::abs(from.dot(across)) <= 0.5 * p.width + kLayer * g.dx() &&
        std::abs(from.dot(along)) <= 0.5 * std::max(wanted_.solid, g.dx()))
      filled[cell] = 1;
  }
  return design_compliance(problem_, loads_, ersatz_.sharp(filled));
}

std::vector<VectorXd> UnderRepair::displacements(int most) const {
  const CellFactors sharp = ersatz_.sharp(fractions(parts));
  std::vector<VectorXd> out;
  const int every = (loads_.n_loads() + most - 1) / most;
  for (int l = loads_.n_loads() - 1; l >= 0; l -= every)
    out.push_back(loads_.displacement(sharp.stiffness, sharp.mass, l));
  return out;
}

void UnderRepair::look_at_energy() {
  fractions_ = fractions(parts);
  const CellFactors sharp = ersatz_.sharp(fractions_);
  ComplianceEvaluator::Value value;
  loads_.evaluate(sharp.stiffness, sharp.mass, value);
  compliance_ = design_compliance(problem_, loads_, sharp);
  density_ = value.d_stiffness.cwiseAbs();
  density_ *= fractions_.sum() / fractions_.dot(density_);
}

}  // namespace flexmorph::mmc
