#include "optim/mmc/clean_up.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <set>
#include <utility>

namespace flexmorph::mmc {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
/// Patches and thinned components are thicker than wanted by this factor: ends are round.
constexpr double kRoom = 1.06;
/// Half-length of a patch in its half-thicknesses, and its growth when one was not enough.
constexpr double kPatchLength = 1.4, kPatchGrowth = 1.25;
constexpr int kMostRounds = 40;
constexpr int kHalvings = 30;

class Cleaner {
 public:
  Cleaner(BodyProblem& problem, LoadResponse& loads, double wanted, double max_volume)
      : problem_(problem),
        loads_(loads),
        wanted_(wanted),
        max_volume_(max_volume),
        ersatz_(ersatz_of(problem)),
        tdf_(problem.grid, problem.stages.back()),
        parts_(problem.design.components()),
        patch_(parts_.size(), false) {}

  CleanUp go() {
    CleanUp out;
    out.wanted = wanted_;
    out.before = features().solid;
    out.compliance_before = compliance(parts_);
    const std::vector<Component> start = parts_;
    double thickest = out.before;
    std::vector<Component> best = start;
    for (Component& c : parts_)
      for (double* each : {&c.c1, &c.c2, &c.c3})
        *each = std::max(*each, half_thickness_for(wanted_));
    fit_volume();
    std::vector<NarrowPlace> narrow = places();
    while (true) {
      const double now = smallest(narrow);
      if (now > thickest && fits()) {
        thickest = now;
        best = parts_;
      }
      if ((narrow.empty() && fits()) || out.rounds == kMostRounds) break;
      ++out.rounds;
      repair(narrow, out);
      fit_volume();
      narrow = places();
    }
    problem_.design = problem_.design.with(best);
    parts_ = best;
    // Without narrow places the smallest feature is what it is.
    out.dropped = dropped_;
    out.after = features().solid;
    out.compliance_after = compliance(parts_);
    return out;
  }

 private:
  std::vector<Region> regions(const std::vector<Component>& parts) const {
    return regions_of(problem_, parts, kOutlineTolerance * problem_.grid.dx());
  }
  Features features() const { return features_of(problem_, regions(parts_)); }

  /// Narrow material, and narrow slits between pieces that should be one.
  std::vector<NarrowPlace> places() const {
    const std::vector<Region> pieces = regions(parts_);
    // The tolerance of outlines counts twice.
    const double limit = wanted_ + 2 * kOutlineTolerance * problem_.grid.dx();
    std::vector<NarrowPlace> out = narrow_places_of(problem_, pieces, limit);
    std::set<std::pair<size_t, size_t>> parted;  // a bridge is enough for two pieces
    std::erase_if(out, [&](const NarrowPlace& p) {
      if (p.solid) return false;
      // A contact is on an outline, up to rounding: a little further on is material.
      const auto piece_at = [&](const Vec2& contact) {
        const Vec2 inside = contact + 1e-6 * (contact - p.center);
        size_t k = 0;
        while (k < pieces.size() && !contains(pieces[k], inside)) ++k;
        return k;
      };
      const auto [one, other] = std::minmax({piece_at(p.a), piece_at(p.b)});
      return one == other || !parted.insert({one, other}).second;
    });
    return out;
  }
  static double smallest(const std::vector<NarrowPlace>& narrow) {
    return narrow.empty() ? kInfinity : narrow.front().width;
  }

  double volume(const std::vector<Component>& parts) {
    tdf_.evaluate(parts);
    ersatz_.factors(tdf_.density(), tdf_.eroded(), factors_);
    return factors_.mass.sum() / ersatz_.n_domain_cells();
  }
  bool fits() { return max_volume_ == kInfinity || volume(parts_) <= max_volume_ * (1 + 1e-9); }

  double compliance(const std::vector<Component>& parts) {
    return judged_compliance(problem_, loads_, ersatz_.sharp(fractions_of(problem_, parts)));
  }
  /// Compliance times volume of the sharp design; infinite when it has come apart. (Cells do not
  /// see slits; what a piece carries through one counts for nothing.)
  double merit(const std::vector<Component>& parts) {
    const Connectivity whole = connectivity_of(problem_, regions(parts));
    if (!whole.connected || whole.islands > islands_) return kInfinity;
    const VectorXd fractions = fractions_of(problem_, parts);
    return judged_compliance(problem_, loads_, ersatz_.sharp(fractions)) * fractions.sum();
  }

  /// Takes volume from what is thicker than needed.
  void fit_volume() {
    if (fits()) return;
    const double thin = half_thickness_for(wanted_);
    const std::vector<Component> full = parts_;
    const auto thinned = [&](double share) {
      for (size_t k = 0; k < full.size(); ++k) {
        if (patch_[k]) continue;
        const auto thinner = [&](double c) { return std::min(c, thin + share * (c - thin)); };
        parts_[k].c1 = thinner(full[k].c1);
        parts_[k].c2 = thinner(full[k].c2);
        parts_[k].c3 = thinner(full[k].c3);
      }
    };
    double low = 0, high = 1;
    for (int step = 0; step < kHalvings; ++step) {
      const double middle = 0.5 * (low + high);
      thinned(middle);
      (fits() ? low : high) = middle;
    }
    thinned(low);
    while (low == 0 && !fits() && drop_least()) continue;
  }

  /// Takes out the component whose loss costs least; patches stay, or they would come back.
  /// @return was there one?
  bool drop_least() {
    double lowest = kInfinity;
    size_t least = 0;
    for (size_t k = 0; k < parts_.size(); ++k) {
      if (patch_[k]) continue;
      const double without = merit(less(k));
      if (!(without < lowest)) continue;
      lowest = without;
      least = k;
    }
    if (lowest == kInfinity) return false;
    drop(least);
    return true;
  }

  std::vector<Component> less(size_t k) const {
    std::vector<Component> out = parts_;
    out.erase(out.begin() + static_cast<std::ptrdiff_t>(k));
    return out;
  }
  void drop(size_t k) {
    parts_.erase(parts_.begin() + static_cast<std::ptrdiff_t>(k));
    patch_.erase(patch_.begin() + static_cast<std::ptrdiff_t>(k));
    ++dropped_;
  }

  void repair(const std::vector<NarrowPlace>& narrow, CleanUp& out) {
    islands_ = connectivity_of(problem_, regions(parts_)).islands;
    std::vector<Vec2> done;
    for (const NarrowPlace& place : narrow) {
      const auto near = [&](const Vec2& p) { return (p - place.center).norm() < wanted_; };
      if (std::any_of(done.begin(), done.end(), near)) continue;
      done.push_back(place.center);
      const auto tries = std::count_if(patched_.begin(), patched_.end(), near);
      repair(place, static_cast<int>(tries), out);
    }
  }

  void repair(const NarrowPlace& place, int tries, CleanUp& out) {
    std::vector<Component> patched = parts_;
    patched.push_back(patch(place, std::pow(kPatchGrowth, tries)));
    double lowest = merit(patched);  // infinite while other slits are open: then nothing is dropped
    std::optional<size_t> out_of_the_way;
    for (size_t k = 0; k < parts_.size(); ++k) {
      if (patch_[k] || !meets(parts_[k], place) || parts_.size() == 1) continue;
      const double without = merit(less(k));
      if (!(without < lowest)) continue;
      lowest = without;
      out_of_the_way = k;
    }
    if (out_of_the_way) return drop(*out_of_the_way);
    parts_ = std::move(patched);
    patch_.push_back(true);
    patched_.push_back(place.center);
    ++out.patches;
  }

  bool meets(const Component& c, const NarrowPlace& place) const {
    return component_tdf(c, problem_.stages.back(), place.center.x(), place.center.y(), nullptr) >
           -0.25 * wanted_;
  }

  /// A short component along the material of a narrow place. Where the border is one of its flanks,
  /// the component lies on the border, half of it outside.
  Component patch(const NarrowPlace& place, double growth) const {
    const Vec2 across = place.b - place.a;
    Component c;
    c.center = place.center;
    double half = 0.5 * kRoom * growth * wanted_;
    if (!place.solid) {  // over the slit, from piece to piece
      c.angle = std::atan2(across.y(), across.x());
      c.c1 = c.c2 = c.c3 = half;
      c.half_length = 0.5 * place.width + kPatchLength * half;
      return c;
    }
    c.angle = across.norm() > 0 ? std::atan2(across.x(), -across.y()) : 0;
    for (const Vec2& contact : {place.a, place.b})
      if (on_border(contact)) {
        c.center = contact;
        half *= 2;
      }
    c.c1 = c.c2 = c.c3 = half;
    c.half_length = kPatchLength * half;
    return c;
  }

  bool on_border(const Vec2& p) const {
    const std::vector<Vec2> domain = domain_of(problem_);
    const double small = 1e-6 * problem_.grid.dx();
    for (size_t i = 0; i < domain.size(); ++i) {
      const Vec2 &a = domain[i], along = domain[(i + 1) % domain.size()] - a;
      const double t = std::clamp((p - a).dot(along) / along.squaredNorm(), 0.0, 1.0);
      if ((a + t * along - p).norm() < small) return true;
    }
    return false;
  }

  BodyProblem& problem_;
  LoadResponse& loads_;
  double wanted_, max_volume_;
  Ersatz ersatz_;
  UnionTdf tdf_;
  CellFactors factors_;
  std::vector<Component> parts_;
  std::vector<bool> patch_;
  std::vector<Vec2> patched_;
  int islands_ = 0;  // before the repairs of a round
  int dropped_ = 0;
};

}  // namespace

double half_thickness_for(double min_feature) { return 0.5 * kRoom * min_feature; }

CleanUp clean_up(BodyProblem& problem, LoadResponse& loads, double wanted,
                 std::optional<double> max_volume) {
  const double by_goal = allowed_volume(problem.goal).value_or(kInfinity);
  return Cleaner(problem, loads, wanted, max_volume.value_or(by_goal)).go();
}

}  // namespace flexmorph::mmc
