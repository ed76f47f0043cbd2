#include "optim/mmc/clean_up.h"

#include <algorithm>
#include <boost/math/tools/toms748_solve.hpp>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numeric>
#include <optional>
#include <span>
#include <utility>

#include "geometry/part_mesh.h"
#include "optim/mmc/idle_parts.h"
#include "optim/mmc/under_repair.h"

namespace flexmorph::mmc {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
/// Patches and thinned components are thicker than wanted by this factor: ends are round.
constexpr double kRoom = 1.06;
/// Half-length of a patch in its half-thicknesses, and its growth when one was not enough.
constexpr double kPatchLength = 1.4, kPatchGrowth = 1.25;
constexpr int kMostRounds = 20;
/// A repair that makes the compliance so many times what it was is none: the design is no design
/// yet, but a lattice on its way.
constexpr double kDearest = 1.25;
/// Volume that is left over is offered to all components so many times.
constexpr int kPasses = 4;
/// Thicknesses that fit a volume are found to this part of the range they are looked for in.
constexpr double kFound = 1e-6;
/// The sharp volume may be off what is allowed by this part.
constexpr double kVolumeTolerance = 2e-4;
/// Outlines and round-off take as much from a width that is wanted.
constexpr double kWithin = 0.99;

/// What a design is before (or after) it is mended.
void measure(const UnderRepair& design, Features& features, int& pieces, double& compliance,
             double& volume) {
  const std::vector<Region> united = design.regions(design.parts);
  features = features_of(design.problem(), united);
  pieces = static_cast<int>(united.size());
  compliance = design.compliance(design.parts);
  volume = design.volume(design.parts);
}

int torn_gaps_of(UnderRepair& design) {
  design.look_at_energy();
  return static_cast<int>(design.torn_gaps().size());
}

/// What is to be repaired; gaps that only cells bridge when all else is done.
std::vector<NarrowPlace> places_of(UnderRepair& design) {
  std::vector<NarrowPlace> out = design.places();
  if (!out.empty()) return out;
  design.look_at_energy();
  return design.torn_gaps();
}

class Cleaner {
 public:
  Cleaner(BodyProblem& problem, ComplianceEvaluator& loads, const Widths& wanted, double max_volume,
          const std::function<bool()>& go_on)
      : problem_(problem),
        wanted_(wanted),
        max_volume_(max_volume),
        design_(problem, loads, wanted, go_on) {}

  CleanUp go(bool trims) {
    CleanUp out;
    out.wanted = wanted_;
    measure(design_, out.before, out.pieces_before, out.compliance_before, out.volume_before);
    dearest_ = kDearest * out.compliance_before;
    design_.look_at_energy();
    if (const std::vector<NarrowPlace> cuts = design_.cuts_from_held(); !cuts.empty()) {
      ++out.rounds;
      repair(cuts, out);
    }
    out.idle = drop_idle(design_);
    for (Component& c : parts_)
      for (double* each : {&c.c1, &c.c2, &c.c3})
        *each = std::max(*each, half_thickness_for(wanted_.solid));
    fit_volume();
    const std::optional<std::vector<Component>> widest = widened(out);
    if (widest && design_.goes_on()) {
      parts_ = *widest;
      if (trims) out.stubs = cut_stubs(design_);
      give_back(design_.smallest(design_.places()));
      out.dropped = dropped_;
      problem_.design = problem_.design.with(parts_);
    } else {
      parts_ = problem_.design.components();
      out.idle = out.patches = 0;
      out.given_up = true;
    }
    measure(design_, out.after, out.pieces_after, out.compliance_after, out.volume_after);
    out.torn = torn_gaps_of(design_);
    return out;
  }

 private:
  /// Repairs the components, round after round. Nothing when no state on the way fits and can be
  /// afforded, else the widest one.
  std::optional<std::vector<Component>> widened(CleanUp& out) {
    std::optional<std::vector<Component>> best;
    double widest = -1;
    std::vector<NarrowPlace> narrow = places_of(design_);
    while (affordable() && design_.goes_on()) {
      const double now = design_.smallest(narrow);
      if (now > widest && fits()) {
        widest = now;
        best = parts_;
      }
      if ((narrow.empty() && fits()) || out.rounds == kMostRounds) break;
      ++out.rounds;
      repair(narrow, out);
      fit_volume();
      narrow = places_of(design_);
    }
    return best;
  }

  bool affordable() const { return design_.compliance(parts_) <= dearest_; }
  bool fits() const {
    return max_volume_ == kInfinity ||
           design_.volume(parts_) <= max_volume_ * (1 + kVolumeTolerance);
  }

  /// Gives volume that is left over to all components in equal parts; where that narrows a place,
  /// to one after the other, those first that are strained most.
  /// @param narrowest  as design_.smallest() says now
  void give_back(double narrowest) {
    if (max_volume_ == kInfinity || !leaves_volume()) return;
    std::vector<size_t> all(parts_.size());
    std::iota(all.begin(), all.end(), size_t{0});
    thicken(all, narrowest);
    if (!leaves_volume()) return;
    design_.look_at_energy();
    const VectorXd fractions = design_.fractions(parts_);
    std::vector<double> strain;
    for (const size_t k : all) {
      const VectorXd own = fractions - design_.fractions(design_.less(k));
      strain.push_back(own.sum() > 0 ? design_.density().dot(own) / own.sum() : 0);
    }
    std::stable_sort(all.begin(), all.end(),
                     [&](size_t a, size_t b) { return strain[a] > strain[b]; });
    for (int pass = 0; pass < kPasses; ++pass)
      for (const size_t k : all)
        if (leaves_volume() && design_.goes_on()) thicken({&k, 1}, narrowest);
  }
  bool leaves_volume() const {
    return design_.volume(parts_) < max_volume_ * (1 - kVolumeTolerance);
  }
  /// Some components, by one factor: up to the volume that is allowed.
  void thicken(std::span<const size_t> which, double narrowest) {
    const std::vector<Component> thin = parts_;
    const auto grow = [&](double factor) {
      for (const size_t k : which) {
        parts_[k].c1 = factor * thin[k].c1;
        parts_[k].c2 = factor * thin[k].c2;
        parts_[k].c3 = factor * thin[k].c3;
      }
    };
    constexpr double kMost = 1.25;
    const double most = largest_that_fits(1, kMost, max_volume_, grow).value_or(1);
    grow(most);
    if (design_.smallest(design_.places()) < narrowest) parts_ = thin;
  }

  /// Takes volume from what is thicker than needed.
  void fit_volume() {
    if (fits()) return;
    const double thin = half_thickness_for(wanted_.solid);
    const std::vector<Component> full = parts_;
    const auto thinned = [&](double share) {
      for (size_t k = 0; k < full.size(); ++k) {
        if (design_.patch[k]) continue;
        const auto thinner = [&](double c) { return std::min(c, thin + share * (c - thin)); };
        parts_[k].c1 = thinner(full[k].c1);
        parts_[k].c2 = thinner(full[k].c2);
        parts_[k].c3 = thinner(full[k].c3);
      }
    };
    const std::optional<double> share =
        largest_that_fits(0, 1, max_volume_ * (1 + kVolumeTolerance), thinned);
    thinned(share.value_or(0));
    if (share) return;
    while (!fits() && affordable() && drop_least()) continue;
  }

  /// The largest number between two by which components take no more than a volume; nothing when
  /// the least takes more.
  /// @param set  makes them so
  template <typename Setter>
  std::optional<double> largest_that_fits(double least, double most, double allowed,
                                          const Setter& set) {
    const auto beyond = [&](double x) {
      set(x);
      return design_.volume(parts_) - allowed;
    };
    const double at_least = beyond(least), at_most = beyond(most);
    if (at_least > 0) return {};
    if (at_most <= 0) return most;
    if (at_least == 0) return least;
    std::uintmax_t tries = 30;
    const auto close = [&](double a, double b) { return b - a <= kFound * (most - least); };
    return boost::math::tools::toms748_solve(beyond, least, most, at_least, at_most, close, tries)
        .first;
  }

  /// Takes out the component whose loss costs least; patches stay, or they would come back.
  /// @return was there one?
  bool drop_least() {
    double lowest = kInfinity;
    size_t least = 0;
    for (size_t k = 0; k < parts_.size(); ++k) {
      if (design_.patch[k]) continue;
      const double without = design_.merit(design_.less(k), lowest);
      if (!(without < lowest)) continue;
      lowest = without;
      least = k;
    }
    if (lowest == kInfinity) return false;
    drop(least);
    return true;
  }

  void drop(size_t k) {
    design_.drop(k);
    ++dropped_;
  }

  void repair(const std::vector<NarrowPlace>& narrow, CleanUp& out) {
    design_.count_islands();
    design_.look_at_energy();
    std::vector<Vec2> done;
    for (const NarrowPlace& place : narrow) {
      const auto near = [&](const Vec2& p) {
        return (p - place.center).norm() < wanted_.largest();
      };
      if (std::any_of(done.begin(), done.end(), near)) continue;
      done.push_back(place.center);
      const auto tries = std::count_if(patched_.begin(), patched_.end(), near);
      repair(place, static_cast<int>(tries), out);
    }
  }

  void repair(const NarrowPlace& place, int tries, CleanUp& out) {
    std::vector<Component> patched = parts_;
    patched.push_back(patch(place, std::pow(kPatchGrowth, tries)));
    double lowest =
        design_.merit(patched);  // infinite while other slits are open: then nothing is dropped
    std::optional<size_t> out_of_the_way;
    for (size_t k = 0; k < parts_.size(); ++k) {
      if (design_.patch[k] || !meets(parts_[k], place) || parts_.size() == 1) continue;
      if (design_.least_merit_without(k) >= lowest) continue;
      const double without = design_.merit(design_.less(k), lowest);
      if (!(without < lowest)) continue;
      lowest = without;
      out_of_the_way = k;
    }
    if (out_of_the_way) return drop(*out_of_the_way);
    parts_ = std::move(patched);
    design_.patch.push_back(true);
    patched_.push_back(place.center);
    ++out.patches;
  }

  bool meets(const Component& c, const NarrowPlace& place) const {
    return component_tdf(c, problem_.stages.back(), place.center.x(), place.center.y(), nullptr) >
           -0.25 * wanted_.largest();
  }

  /// A short component along the material of a narrow place. Where the border is one of its flanks,
  /// the component lies on the border, half of it outside.
  Component patch(const NarrowPlace& place, double growth) const {
    const Vec2 across = place.b - place.a;
    Component c;
    c.center = place.center;
    double half = 0.5 * kRoom * growth * wanted_.largest();
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
    const double small = 1e-6 * problem_.grid.dx();
    for (const std::vector<Vec2>& ring : rings_of(domain_of(problem_)))
      for (size_t i = 0; i < ring.size(); ++i)
        if (distance({ring[i], ring[(i + 1) % ring.size()]}, p) < small) return true;
    return false;
  }

  BodyProblem& problem_;
  Widths wanted_;
  double max_volume_;
  UnderRepair design_;
  std::vector<Component>& parts_ = design_.parts;
  std::vector<Vec2> patched_;  // where repairs have put parts
  int dropped_ = 0;
  double dearest_ = kInfinity;  // compliance
};

}  // namespace

double half_thickness_for(double min_feature) { return 0.5 * kRoom * min_feature; }

double CleanUp::part_reached() const {
  const auto part = [](double found, double asked) {
    return asked > 0 ? found / asked : kInfinity;
  };
  return std::min(part(after.solid, wanted.solid), part(after.gap, wanted.gap));
}

void CleanUp::add(const CleanUp& later) {
  rounds += later.rounds;
  patches += later.patches;
  dropped += later.dropped;
  idle += later.idle;
  stubs += later.stubs;
  joined += later.joined;
  born += later.born;
}

void CleanUp::end_as(const CleanUp& other) {
  after = other.after;
  pieces_after = other.pieces_after;
  compliance_after = other.compliance_after;
  volume_after = other.volume_after;
  torn = other.torn;
  given_up = other.given_up;
}

bool CleanUp::reached() const {
  return pieces_after == 1 && torn == 0 && part_reached() >= kWithin;
}

CleanUp look_over(const BodyProblem& problem, ComplianceEvaluator& loads, const Widths& wanted) {
  UnderRepair design(problem, loads, wanted);
  CleanUp out;
  out.wanted = wanted;
  measure(design, out.before, out.pieces_before, out.compliance_before, out.volume_before);
  out.after = out.before;
  out.pieces_after = out.pieces_before;
  out.compliance_after = out.compliance_before;
  out.volume_after = out.volume_before;
  out.rounds = static_cast<int>(places_of(design).size());
  out.torn = torn_gaps_of(design);
  return out;
}

CleanUp clean_up(BodyProblem& problem, ComplianceEvaluator& loads, const Widths& wanted,
                 const RepairWishes& wishes) {
  const double by_goal = allowed_volume(problem.goal).value_or(kInfinity);
  return Cleaner(problem, loads, wanted, wishes.max_volume.value_or(by_goal), wishes.go_on)
      .go(wishes.trims);
}

}  // namespace flexmorph::mmc
