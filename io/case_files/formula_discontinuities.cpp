// Times at which formulas jump, have discontinuous derivatives, or have no values.
#include <algorithm>
#include <cmath>
#include <set>
#include <tuple>

#include "io/case_files/formula_graph.h"
#include "io/files.h"

namespace flexmorph::io {
namespace {

/// Returns the last double before t.
double before(double t) { return std::nextafter(t, 0.0); }

/// Returns the time of the largest change of an entry between a and b, and the part of the change
/// that remains between two neighbouring times. The latter is nearly zero if the function is
/// continuous.
std::pair<double, double> jump_between(const Formula& f, double Jet::*entry, double a, double b) {
  double at_a = f(a).*entry, at_b = f(b).*entry;
  for (int k = 0; k < 60 && b - a > 1e-12 * std::max(1.0, b); ++k) {
    const double mid = 0.5 * (a + b), at_mid = f(mid).*entry;
    const bool left = !(std::abs(at_b - at_mid) > std::abs(at_mid - at_a));
    (left ? b : a) = mid;
    (left ? at_b : at_a) = at_mid;
  }
  return {0.5 * (a + b), std::abs(at_b - at_a)};
}

/// Returns the smallest changes of value and rate between 0 and `end` that count as jumps.
Jet least_jump(const Formula& f, double end, int samples) {
  constexpr double kJump = 1e-6;  // of the largest value; smooth functions change by 1e-9
  Jet largest;
  for (int i = 0; i <= samples; ++i) {
    const Jet x = f(end * i / samples);
    largest.value = std::max(largest.value, std::abs(x.value));
    largest.rate = std::max(largest.rate, std::abs(x.rate));
  }
  // If a value changes only by its last digit until the end, its rate is round-off.
  return {kJump * largest.value, std::max(kJump * largest.rate, 1e-15 * largest.value / end)};
}

void check_finite(const Formula& f, double t) {
  const Jet x = f(t);
  const std::pair<double, const char*> entries[] = {
      {x.value, "value"}, {x.rate, "rate"}, {x.acceleration, "acceleration"}};
  for (const auto& [number, what] : entries)
    if (!std::isfinite(number))
      refuse_formula(f.text(), std::string("its ") + what + " at t = " + to_text(t, 6) + " s" +
                                   (std::isnan(number) ? " is not a real number" : " is infinite"));
}

/// Returns the first time at which an argument has the sign that it has at b; at a the sign is
/// opposite.
template <class Argument>
double change(const Argument& argument, double a, double b) {
  const bool at_b = argument(b) >= 0;
  for (double mid = 0.5 * (a + b); mid > a && mid < b; mid = 0.5 * (a + b))
    ((argument(mid) >= 0) == at_b ? b : a) = mid;
  return b;
}

/// Returns the time at which an argument with one extremum between a and b is nearest to zero.
template <class Argument>
double nearest(const Argument& argument, double a, double b) {
  constexpr double kGolden = 0.3819660112501051;
  for (int k = 0; k < 60; ++k) {
    const double c = a + kGolden * (b - a), d = b - kGolden * (b - a);
    if (std::abs(argument(c)) < std::abs(argument(d)))
      b = d;
    else
      a = c;
  }
  return 0.5 * (a + b);
}

}  // namespace

void Formula::check(double end, int samples) const {
  const std::vector<double> at_discontinuities = discontinuities(end);
  std::vector<double> times = at_discontinuities;
  for (int i = 0; i <= samples; ++i) times.push_back(end * i / samples);
  std::sort(times.begin(), times.end());
  for (const double t : times) check_finite(*this, t);
  const Jet least = least_jump(*this, end, samples);
  const std::tuple<double Jet::*, const char*, double> entries[] = {
      {&Jet::value, "value", least.value}, {&Jet::rate, "rate", least.rate}};
  for (const auto& [entry, what, allowed] : entries)
    for (size_t i = 1; i < times.size(); ++i) {
      const bool is_discontinuity =
          std::binary_search(at_discontinuities.begin(), at_discontinuities.end(), times[i]);
      const double a = times[i - 1], b = is_discontinuity ? before(times[i]) : times[i];
      if (b <= a || std::abs((*this)(b).*entry - (*this)(a).*entry) <= allowed) continue;
      const auto [t, jump] = jump_between(*this, entry, a, b);
      if (!(jump <= allowed))
        refuse_formula(text_, std::string("its ") + what + " jumps at t = " + to_text(t, 6) + " s");
    }
}

std::vector<double> Formula::discontinuities(double end) const {
  constexpr int kSteps = 2000;
  constexpr double kMaxWork = 1e8;  // operations: 0.1 to 0.2 seconds
  std::set<size_t> arguments;       // indices of results that decide which branch the formula takes
  for (const Operation& o : program_->operations)
    if (o.op == Op::choose) arguments.insert(static_cast<size_t>(o.a));
  std::vector<double> out;
  if (arguments.empty()) return out;
  double work = 0;
  const auto results = [&](double t) {
    std::vector<double> x(program_->operations.size());
    work += static_cast<double>(x.size());  // about 60 times for every discontinuity
    if (work > kMaxWork) refuse_formula(text_, "it is too long for its number of discontinuities");
    program_->run(t, x.data());
    return x;
  };
  const auto time = [&](int i) { return end * std::min(i, kSteps) / kSteps; };
  std::vector<double> last, now = results(0), next = results(time(1));
  for (int i = 1; i <= kSteps; ++i) {
    last = std::exchange(now, std::exchange(next, results(time(i + 1))));
    for (const size_t k : arguments) {
      const auto argument = [&](double t) { return results(t)[k]; };
      if ((last[k] >= 0) != (now[k] >= 0)) {
        out.push_back(change(argument, time(i - 1), time(i)));
        continue;
      }
      const bool dips =
          std::abs(now[k]) < std::abs(last[k]) && std::abs(now[k]) < std::abs(next[k]);
      if (!dips || (now[k] >= 0) != (next[k] >= 0)) continue;
      const double t = nearest(argument, time(i - 1), time(i + 1));
      if ((argument(t) >= 0) == (now[k] >= 0)) continue;
      out.push_back(change(argument, time(i - 1), t));
      out.push_back(change(argument, t, time(i + 1)));
    }
  }
  std::sort(out.begin(), out.end());
  out.erase(std::unique(out.begin(), out.end()), out.end());
  return out;
}

std::optional<Formula::Jump> Formula::first_jump(double end) const {
  const std::vector<double> at_discontinuities = discontinuities(end);
  if (at_discontinuities.empty()) return {};
  const Jet least = least_jump(*this, end, 1000);
  for (const double t : at_discontinuities) {
    const Jet left = (*this)(before(t)), right = (*this)(t);
    if (std::abs(right.value - left.value) > least.value)
      return Jump{t, false, left.value, right.value};
    if (std::abs(right.rate - left.rate) > least.rate) return Jump{t, true, left.rate, right.rate};
  }
  return {};
}

}  // namespace flexmorph::io
