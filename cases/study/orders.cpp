#include "cases/study/orders.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "io/files.h"

namespace flexmorph::cases {
namespace {

constexpr double kUndefined = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinite = std::numeric_limits<double>::infinity();
constexpr double kMinOrder = 0.05, kMaxOrder = 20;
constexpr double kLowOrder = 0.3;  // lowest order in the bound of a series that is not converged
// Ratios of neighbouring slopes (gradient_of()): below kFalls they decrease, above kGrows they
// increase.
constexpr double kFalls = 0.9, kGrows = 1.5;

/// Returns (h₁ᵖ - h₂ᵖ)/(h₂ᵖ - h₃ᵖ), which increases with p.
double ratio_at(double p, double h1, double h2, double h3) {
  const double a = std::pow(h1 / h2, p), b = std::pow(h3 / h2, p);
  return (a - 1) / (1 - b);
}

/// Returns the indices of the triples with an order, from the finest triple on.
std::vector<size_t> finest_orders(const std::vector<double>& orders) {
  std::vector<size_t> out;
  for (size_t i = orders.size(); i-- > 0;)
    if (std::isfinite(orders[i])) out.push_back(i);
  return out;
}

std::string share(double difference, double scale) { return io::to_text(difference / scale, 2); }

/// Returns the absolute differences of neighbouring values, divided by the logarithm of the ratio
/// of h, coarse to fine.
std::vector<double> gradient_of(std::span<const LevelValue> levels) {
  std::vector<double> out;
  for (size_t i = 0; i + 1 < levels.size(); ++i)
    out.push_back(std::abs(levels[i + 1].value - levels[i].value) /
                  std::log(levels[i].h / levels[i + 1].h));
  return out;
}

double range_of_last(std::span<const LevelValue> levels, size_t count) {
  const auto last = levels.last(std::min(count, levels.size()));
  const auto [low, high] = std::minmax_element(
      last.begin(), last.end(),
      [](const LevelValue& a, const LevelValue& b) { return a.value < b.value; });
  return high->value - low->value;
}

/// Returns the uncertainty of the limit of levels without an order, with respect to the finest
/// level.
double reach(std::span<const LevelValue> levels, double scale) {
  const size_t n = levels.size();
  if (n < 3) return kInfinite;
  const double last = levels[n - 1].value - levels[n - 2].value;
  const double before = levels[n - 2].value - levels[n - 3].value;
  const std::vector<double> slopes = gradient_of(levels);
  const double slope = slopes[n - 2], slope_before = slopes[n - 3];
  const bool stagnates = std::max(std::abs(last), std::abs(before)) <= kFloor * scale;
  if (!stagnates && slope > kGrows * *std::max_element(slopes.begin(), slopes.end() - 1))
    return kInfinite;
  if (last * before < 0 && slope <= slope_before) return kSwing * range_of_last(levels, 3);
  if (last * before < 0 || (!stagnates && slope > kGrows * slope_before))
    return kSwing * range_of_last(levels, 4);
  if (!stagnates && slope >= kFalls * slope_before)
    return std::max(slope, slope_before) * std::log(kMaxExtrapolation);
  // Remainder for convergence with first order, or with a lower order that was observed.
  const double ratio = levels[n - 2].h / levels[n - 1].h;
  const double seen = order_of(levels[n - 3], levels[n - 2], levels[n - 1], 0);
  const double order = std::isfinite(seen) ? std::clamp(seen, kLowOrder, 1.0) : 1;
  return std::max(std::abs(last), std::abs(last) / (std::pow(ratio, order) - 1));
}

/// Sets the limit of levels without an order: the value of the finest level, with its uncertainty.
void bound(std::span<const LevelValue> levels, double scale, ExtrapolatedLimit& out) {
  out.value = levels.back().value;
  out.uncertainty = reach(levels, scale);
  out.sentence += std::isfinite(out.uncertainty)
                      ? "; the value of the finest level is used, its uncertainty is " +
                            share(out.uncertainty, scale)
                      : "; the differences between levels grow, so the error has no bound";
}

/// Sets the limit of a series that converges faster than any power.
void verify_fast(std::span<const LevelValue> levels, double scale, ExtrapolatedLimit& out) {
  const size_t n = levels.size();
  out.order = kUndefined;
  out.value = levels[n - 1].value;
  const double last = std::abs(levels[n - 1].value - levels[n - 2].value);
  double largest = 0;
  for (size_t i = 0; i + 1 < n; ++i)
    largest = std::max(largest, std::abs(levels[i].value - levels[n - 1].value));
  out.converged = last <= std::max(0.5 * largest, kFloor * scale);
  out.uncertainty = out.converged ? last : kInfinite;
  out.sentence = out.converged
                     ? "the value of the finest level is used as limit, the last change is " +
                           share(last, scale)
                     : "the last change, " + share(last, scale) +
                           ", is more than half of the largest difference from the finest level";
}

/// Sets the limit of a series that converges by a power law, if its orders agree.
void verify_orders(std::span<const LevelValue> levels, const std::optional<Theory>& theory,
                   double scale, ExtrapolatedLimit& out) {
  const std::vector<size_t> finest = finest_orders(out.orders);
  out.order = finest.empty() ? kUndefined : out.orders[finest[0]];
  if (finest.size() < 2 || finest[0] != finest[1] + 1) {
    out.sentence = finest.empty() ? "no three neighbouring levels have an order"
                                  : "the order " + io::to_text(out.order, 3) +
                                        " of three levels is not confirmed by coarser levels";
    return bound(levels, scale, out);
  }
  const double a = out.orders[finest[1]], b = out.order;
  if (std::abs(a - b) > kOrderSpread) {
    out.sentence = "the orders of the two finest triples of levels disagree: " + io::to_text(a, 3) +
                   " and " + io::to_text(b, 3);
    return bound(levels, scale, out);
  }
  const bool known = theory && theory->has_order();
  if (known && std::abs(b - theory->order) > kTheorySpread) {
    out.sentence = "the order " + io::to_text(b, 3) + " differs from theory";
    return bound(levels, scale, out);
  }
  if (!known && b < 0.5) {
    out.sentence = "the order " + io::to_text(b, 3) + " is too low to extrapolate";
    return bound(levels, scale, out);
  }
  // Extrapolate from the finest triple with an order, because differences of finer levels are below
  // the floor.
  const std::span<const LevelValue> fine = levels.subspan(finest[0], 3);
  const std::span<const LevelValue> before = levels.subspan(finest[1], 3);
  out.converged = true;
  out.value = extrapolated(fine[1], fine[2], b);
  const double other = extrapolated(before[1], before[2], a);
  out.uncertainty = std::min(std::abs(out.value - other), std::abs(out.value - fine[2].value));
  out.sentence = "order " + io::to_text(b, 3) +
                 (known ? " (theory " + io::to_text(theory->order) + " for " + theory->source + ")"
                        : " (two triples of levels agree; there is no theoretical order)");
}

}  // namespace

bool ExtrapolatedLimit::bounded() const {
  return std::isfinite(value) && std::isfinite(uncertainty);
}

double order_of(const LevelValue& coarse, const LevelValue& middle, const LevelValue& fine,
                double floor) {
  const double d1 = coarse.value - middle.value, d2 = middle.value - fine.value;
  if (!(std::abs(d1) > floor && std::abs(d2) > floor) || d1 * d2 < 0) return kUndefined;
  const double wanted = d1 / d2;
  double low = kMinOrder, high = kMaxOrder;
  const auto ratio = [&](double p) { return ratio_at(p, coarse.h, middle.h, fine.h); };
  if (!(ratio(low) < wanted && wanted < ratio(high))) return kUndefined;
  for (int i = 0; i < 100; ++i) {
    const double middle_order = 0.5 * (low + high);
    (ratio(middle_order) < wanted ? low : high) = middle_order;
  }
  return 0.5 * (low + high);
}

double extrapolated(const LevelValue& coarse, const LevelValue& fine, double order) {
  const double factor = 1 / (std::pow(coarse.h / fine.h, order) - 1);
  return fine.value + (fine.value - coarse.value) * factor;
}

ExtrapolatedLimit limit_of(std::span<const LevelValue> levels, Approach approach,
                           const std::optional<Theory>& theory, double scale) {
  ExtrapolatedLimit out;
  out.order = out.value = kUndefined;
  out.uncertainty = kInfinite;
  const size_t n = levels.size();
  if (n == 0) {
    out.sentence = "no level was measured";
    return out;
  }
  out.value = levels[n - 1].value;
  double largest = 0;
  for (size_t i = 0; i + 1 < n; ++i)
    largest = std::max(largest, std::abs(levels[i + 1].value - levels[i].value));
  for (size_t i = 0; i + 2 < n; ++i)
    out.orders.push_back(order_of(levels[i], levels[i + 1], levels[i + 2], kFloor * scale));
  if (n < 3) {
    out.sentence = "there are fewer than three levels";
  } else if (largest <= kFloor * scale) {
    out.converged = true;
    out.uncertainty = largest;
    out.sentence = "the values of the levels differ by at most " + share(largest, scale);
  } else if (approach == Approach::fast) {
    verify_fast(levels, scale, out);
  } else if (theory && theory->has_no_limit()) {
    out.sentence = "no limit: " + theory->source;
  } else {
    verify_orders(levels, theory, scale, out);
    if (!out.converged && theory)
      out.sentence +=
          "; " +
          (theory->has_order() ? "theory: order " + io::to_text(theory->order) + " for " : "") +
          theory->source;
  }
  return out;
}

}  // namespace flexmorph::cases
