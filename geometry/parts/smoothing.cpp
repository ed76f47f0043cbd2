#include "geometry/parts/smoothing.h"

#include <Eigen/Sparse>
#include <algorithm>
#include <cassert>
#include <cmath>
#include <numbers>
#include <tuple>
#include <utility>

#include "geometry/parts/simplified.h"

namespace flexmorph {
namespace {

using Ring = std::vector<Vec2>;

constexpr double kPi = std::numbers::pi;
/// Samples per feature, length of the wave that is halved, and largest shift, both in features.
constexpr double kSamples = 12, kWave = 5, kShift = 0.12;
/// Angles between which the weight falls from 1 [rad], and its smallest value: with it, waves of
/// 1.5 features are halved everywhere.
constexpr double kStraight = kPi / 9, kCorner = kPi / 4, kEverywhere = 0.0081;
/// Points that are closer to fixed rings than this fraction of a feature are on them.
constexpr double kOnOutline = 1e-6;

double cross(const Vec2& a, const Vec2& b) { return a.x() * b.y() - a.y() * b.x(); }

/// Straight sides, with a test for points on them.
class Sides {
 public:
  Sides(std::vector<Segment> sides, double near) : near_(near), sides_(std::move(sides)) {}

  bool has(const Vec2& p) const {
    return std::any_of(sides_.begin(), sides_.end(), [&](const Segment& s) {
      const bool beside = (p.array() < s.a.array().min(s.b.array()) - near_).any() ||
                          (p.array() > s.a.array().max(s.b.array()) + near_).any();
      return !beside && distance(s, p) < near_;
    });
  }

 private:
  double near_;
  std::vector<Segment> sides_;
};

/// A polyline parametrized by its length, with samples at equal distances.
class Chain {
 public:
  /// Samples a polyline.
  /// @param closed  true if it ends where it begins
  Chain(Ring points, bool closed, double spacing) : points_(std::move(points)), closed_(closed) {
    for (std::size_t k = 0; k < points_.size(); ++k)
      at_.push_back(k == 0 ? 0.0 : at_[k - 1] + (points_[k] - points_[k - 1]).norm());
    n_ = static_cast<int>(std::lround(at_.back() / spacing));
    step_ = at_.back() / std::max(n_, 1);
    std::size_t side = 0;
    for (int i = 0; i < n_samples(); ++i) {
      const double s = i * step_;
      while (side + 2 < at_.size() && at_[side + 1] < s) ++side;
      const double length = at_[side + 1] - at_[side];
      const double t = length > 0 ? std::min((s - at_[side]) / length, 1.0) : 0.0;
      samples_.emplace_back(points_[side] + t * (points_[side + 1] - points_[side]));
    }
  }

  int n_samples() const { return closed_ ? n_ : n_ + 1; }
  Vec2 sample(int i) const {
    const int n = n_samples();
    return samples_[index(closed_ ? ((i % n) + n) % n : std::clamp(i, 0, n - 1))];
  }

  /// Returns the shifts of the samples by the filter, limited to the length `most` [m].
  std::vector<Vec2> shifts(int per_feature, double wave, double most) const {
    const int n = n_samples();
    const double stiffness = std::pow(wave / (2 * kPi * step_), 4);
    std::vector<double> weights;
    for (int i = 0; i < n; ++i)
      weights.push_back(bends(i) ? stiffness * weight(i, per_feature) : 0);
    std::vector<Eigen::Triplet<double>> entries;
    for (int i = 0; i < n; ++i) entries.emplace_back(i, i, 1.0);
    for (int i = 0; i < n; ++i) {
      const double w = weights[index(i)];
      if (!(w > 0)) continue;
      const int at[3] = {(i + n - 1) % n, i, (i + 1) % n};
      constexpr double kBend[3] = {1, -2, 1};
      for (int r = 0; r < 3; ++r)
        for (int c = 0; c < 3; ++c)
          if (bends(at[r]) && bends(at[c]))
            entries.emplace_back(at[r], at[c], w * kBend[r] * kBend[c]);
    }
    MatrixXd right(n, 2);
    for (int i = 0; i < n; ++i) right.row(i) = pull(i, weights).transpose();
    Eigen::SparseMatrix<double> matrix(n, n);
    matrix.setFromTriplets(entries.begin(), entries.end());
    const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> factor(matrix);
    const MatrixXd shift = factor.solve(right);
    std::vector<Vec2> out;
    for (int i = 0; i < n; ++i) {
      Vec2 d = shift.row(i).transpose();
      if (const double length = d.norm(); length > most) d *= most / length;
      out.push_back(d);
    }
    return out;
  }

  /// Returns the polyline with the moved samples; where samples do not move, it keeps its points.
  Ring moved(const std::vector<Vec2>& shifts, double small) const {
    Ring out;
    int next = 0;
    const auto stays = [&](int i) { return shifts[index(i % n_samples())].norm() <= small; };
    const std::size_t last = points_.size() - (closed_ ? 1 : 0);
    for (std::size_t k = 0; k < last; ++k) {
      const bool ends = !closed_ && (k == 0 || k + 1 == last);
      const int i = std::clamp(static_cast<int>(at_[k] / step_), 0, n_ - 1);
      if (ends || (stays(i) && stays(i + 1))) out.push_back(points_[k]);
      if (k + 1 == points_.size()) break;
      for (; next < n_samples() && next * step_ < at_[k + 1]; ++next)
        if (!stays(next)) out.emplace_back(samples_[index(next)] + shifts[index(next)]);
    }
    if (closed_) out.push_back(out.front());
    return out;
  }

 private:
  static std::size_t index(int i) { return static_cast<std::size_t>(i); }
  /// Returns true unless the sample is one of the two ends of an open chain, which do not move.
  bool bends(int i) const { return closed_ || (i > 0 && i + 1 < n_samples()); }
  /// Returns the direction of the outline before (after) sample i, between the samples at distances
  /// of m and 2 m; at the ends of an open chain the direction of the first or last samples.
  Vec2 before(int i, int m) const {
    if (closed_) return sample(i - m) - sample(i - 2 * m);
    const int to = std::max(i - m, 1);
    return sample(to) - sample(std::max(to - m, 0));
  }
  Vec2 after(int i, int m) const {
    if (closed_) return sample(i + 2 * m) - sample(i + m);
    const int from = std::min(i + m, n_samples() - 2);
    return sample(std::min(from + m, n_samples() - 1)) - sample(from);
  }
  double weight(int i, int m) const {
    const Vec2 a = before(i, m), b = after(i, m);
    const double turn = std::abs(std::atan2(cross(a, b), a.dot(b)));
    return std::clamp((kCorner - turn) / (kCorner - kStraight), kEverywhere, 1.0);
  }
  /// Returns minus the gradient of half the weighted bending sum by the position of a sample.
  Vec2 pull(int i, const std::vector<double>& weights) const {
    Vec2 out(0, 0);
    if (!bends(i)) return out;
    const int n = n_samples();
    // in the bending terms of the next sample, this one, and the previous one
    constexpr double kBend[3] = {1, -2, 1};
    for (int k = 0; k < 3; ++k) {
      const int at = (i + 1 - k + n) % n;
      out -= weights[index(at)] * kBend[k] * (sample(at - 1) - 2 * sample(at) + sample(at + 1));
    }
    return out;
  }
  Ring points_;
  bool closed_;
  std::vector<double> at_;  ///< Length from the first point to a point [m].
  int n_ = 0;
  double step_ = 0;
  std::vector<Vec2> samples_;
};

/// Smooths rings between fixed vertices.
class Smoothing {
 public:
  Smoothing(std::span<const Ring> fixed, std::span<const Segment> mirrors,
            std::span<const Vec2> kept, double feature, double tolerance)
      : fixed_(sides_of(fixed), kOnOutline * feature),
        mirrors_({mirrors.begin(), mirrors.end()}, kOnOutline * feature),
        kept_(kept),
        feature_(feature),
        tolerance_(tolerance) {}

  Ring of(const Ring& ring) const {
    const std::size_t n = ring.size();
    assert(n > 0);
    std::vector<std::size_t> stay;
    for (std::size_t k = 0; k < n; ++k)
      if (fixed_.has(ring[k])) stay.push_back(k);
    Ring out;
    if (stay.empty()) {
      out = ring;
      const auto earlier = [&](const Vec2& a, const Vec2& b) {
        return std::tuple(!mirrors_.has(a), a.x(), a.y()) <
               std::tuple(!mirrors_.has(b), b.x(), b.y());
      };
      std::rotate(out.begin(), std::min_element(out.begin(), out.end(), earlier), out.end());
      out.push_back(out.front());
      out = chain(std::move(out), true);
      out.pop_back();
    }
    for (std::size_t s = 0; s < stay.size(); ++s) {
      std::size_t to = stay[(s + 1) % stay.size()];
      if (to <= stay[s]) to += n;
      Ring points;
      for (std::size_t k = stay[s]; k <= to; ++k) points.push_back(ring[k % n]);
      points = chain(std::move(points), false);
      out.insert(out.end(), points.begin(), points.end() - 1);
    }
    return out;
  }

 private:
  Ring chain(Ring points, bool closed) const {
    constexpr int kMinPoints = 5;
    constexpr double kPositionTolerance = 0.01, kSideTolerance = 0.2;  // fractions of the tolerance
    if (!closed && points.size() == 2) return points;
    const Chain chain(points, closed, feature_ / kSamples);
    if (chain.n_samples() < kMinPoints) return points;
    const int per_feature = static_cast<int>(kSamples);
    std::vector<Vec2> shifts = chain.shifts(per_feature, kWave * feature_, kShift * feature_);
    for (std::size_t i = 0; i < shifts.size() && !kept_.empty(); ++i)
      shifts[i] *= range(chain.sample(static_cast<int>(i)));
    return simplified_line(chain.moved(shifts, kPositionTolerance * tolerance_),
                           kSideTolerance * tolerance_);
  }

  /// Returns the factor by which the shift of a point is reduced near points that must not move.
  double range(const Vec2& p) const {
    double out = 1;
    for (const Vec2& k : kept_)
      out = std::min(out, std::clamp((p - k).norm() / feature_ - 1, 0.0, 1.0));
    return out;
  }

  Sides fixed_, mirrors_;
  std::span<const Vec2> kept_;
  double feature_, tolerance_;
};

bool is_simple(const Region& region) {
  try {
    region_of(rings_of(region));
    return true;
  } catch (const Error&) {
    return false;
  }
}

}  // namespace

std::vector<Region> smoothed(std::span<const Region> regions,
                             std::span<const std::vector<Vec2>> fixed,
                             std::span<const Segment> mirrors, std::span<const Vec2> kept,
                             double feature, double tolerance, bool check) {
  std::vector<Region> out;
  const Smoothing smoothing(fixed, mirrors, kept, feature, tolerance);
  for (const Region& region : regions) {
    if (!(feature > 0)) {
      out.push_back(region);
      continue;
    }
    Region smooth{smoothing.of(region.outer), {}};
    for (const Ring& hole : region.holes) smooth.holes.push_back(smoothing.of(hole));
    if (check && !is_simple(smooth))
      out.push_back(region);
    else
      out.push_back(std::move(smooth));
  }
  return out;
}

}  // namespace flexmorph
