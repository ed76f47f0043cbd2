#include "optim/mmc/clean_up.h"

#include <algorithm>
#include <cmath>
#include <limits>

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
  Cleaner(BodyProblem& problem, LoadResponse& loads, double wanted)
      : problem_(problem),
        loads_(loads),
        wanted_(wanted),
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
    out.after = features().solid;
    out.compliance_after = compliance(parts_);
    return out;
  }

 private:
  std::vector<Region> regions() const {
    return regions_of(problem_, parts_, kOutlineTolerance * problem_.grid.dx());
  }
  Features features() const { return features_of(problem_, regions()); }
  std::vector<NarrowPlace> places() const {
    // The tolerance of outlines counts twice.
    const double limit = wanted_ + 2 * kOutlineTolerance * problem_.grid.dx();
    std::vector<NarrowPlace> out = narrow_places_of(problem_, regions(), limit);
    std::erase_if(out, [](const NarrowPlace& p) { return !p.solid; });
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
  bool limited() const { return problem_.goal.minimize == Goal::Minimize::compliance; }
  bool fits() { return !limited() || volume(parts_) <= problem_.goal.max_volume * (1 + 1e-9); }

  double compliance(const std::vector<Component>& parts) {
    return judged_compliance(problem_, loads_, ersatz_.sharp(fractions_of(problem_, parts)));
  }
  /// Compliance times volume of the sharp design; infinite when it has come apart.
  double merit(const std::vector<Component>& parts) {
    const VectorXd fractions = fractions_of(problem_, parts);
    if (!connectivity(problem_.grid, fractions, problem_.places).connected) return kInfinity;
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
        const auto less = [&](double c) { return std::min(c, thin + share * (c - thin)); };
        parts_[k].c1 = less(full[k].c1);
        parts_[k].c2 = less(full[k].c2);
        parts_[k].c3 = less(full[k].c3);
      }
    };
    double low = 0, high = 1;
    for (int step = 0; step < kHalvings; ++step) {
      const double middle = 0.5 * (low + high);
      thinned(middle);
      (fits() ? low : high) = middle;
    }
    thinned(low);
  }

  void repair(const std::vector<NarrowPlace>& narrow, CleanUp& out) {
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
    double lowest = merit(patched);
    int drop = -1;
    for (size_t k = 0; k < parts_.size(); ++k) {
      if (patch_[k] || !meets(parts_[k], place) || parts_.size() == 1) continue;
      std::vector<Component> without = parts_;
      without.erase(without.begin() + static_cast<std::ptrdiff_t>(k));
      const double merit_without = merit(without);
      if (merit_without > lowest) continue;
      lowest = merit_without;
      drop = static_cast<int>(k);
    }
    if (drop >= 0) {
      parts_.erase(parts_.begin() + drop);
      patch_.erase(patch_.begin() + drop);
      ++out.dropped;
      return;
    }
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
    c.angle = across.norm() > 0 ? std::atan2(across.x(), -across.y()) : 0;
    double half = 0.5 * kRoom * growth * wanted_;
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
  double wanted_;
  Ersatz ersatz_;
  UnionTdf tdf_;
  CellFactors factors_;
  std::vector<Component> parts_;
  std::vector<bool> patch_;
  std::vector<Vec2> patched_;
};

}  // namespace

double half_thickness_for(double min_feature) { return 0.5 * kRoom * min_feature; }

CleanUp clean_up(BodyProblem& problem, LoadResponse& loads, double wanted) {
  return Cleaner(problem, loads, wanted).go();
}

}  // namespace flexmorph::mmc
