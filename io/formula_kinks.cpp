// Where formulas of time jump, have corners or no values.
#include <algorithm>
#include <array>
#include <cmath>
#include <tuple>

#include "io/files.h"
#include "io/formula_operations.h"

namespace flexmorph::io {
namespace {

/// The last time before t.
double before(double t) { return std::nextafter(t, 0.0); }

/// The time of the largest change of an entry between a and b, and what is left of that change
/// between two neighbouring times: nothing where the function is continuous.
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

/// What counts as a jump of value and rate.
struct Least {
  double value, rate;

  Least(const Jet& largest, double end)
      : value(kJump * largest.value),
        // What moves by the last digit of its value until the end has a rate that is round-off.
        rate(std::max(kJump * largest.rate, 1e-15 * largest.value / end)) {}

  static constexpr double kJump = 1e-6;  // of the largest value; smooth functions leave 1e-9
};

Jet larger(const Jet& a, const Jet& b) {
  return {std::max(a.value, std::abs(b.value)), std::max(a.rate, std::abs(b.rate)),
          std::max(a.acceleration, std::abs(b.acceleration))};
}

Jet largest_of(const Formula& f, double end, int samples) {
  Jet out;
  for (int i = 0; i <= samples; ++i) out = larger(out, f(end * i / samples));
  return out;
}

void check_finite(const Formula& f, double t) {
  const Jet x = f(t);
  const std::pair<double, const char*> entries[] = {
      {x.value, "value"}, {x.rate, "rate"}, {x.acceleration, "acceleration"}};
  for (const auto& [number, what] : entries)
    if (!std::isfinite(number))
      refuse_formula(f.text(), std::string("its ") + what + " at t = " + to_text(t, 6) + " s" +
                                   (std::isnan(number) ? " is no real number" : " is infinite"));
}

/// The arguments that decide which branch a formula takes.
class Arguments {
 public:
  Arguments(const std::string& text, const Formula::Program& program)
      : text_(text), program_(program) {
    for (const Operation& o : program.operations)
      if (o.op == Op::choose) places_.push_back(o.a);
    std::sort(places_.begin(), places_.end());
    places_.erase(std::unique(places_.begin(), places_.end()), places_.end());
  }

  size_t size() const { return places_.size(); }
  std::vector<double> at(double t) const {
    const std::vector<double>& all = run(t);
    std::vector<double> out;
    for (const int place : places_) out.push_back(all[static_cast<size_t>(place)]);
    return out;
  }
  double at(double t, size_t which) const { return run(t)[static_cast<size_t>(places_[which])]; }

  /// The first time of the branch at b, where a has the other one.
  double change(size_t which, double a, double b) const {
    const bool at_b = at(b, which) >= 0;
    for (double mid = 0.5 * (a + b); mid > a && mid < b; mid = 0.5 * (a + b))
      ((at(mid, which) >= 0) == at_b ? b : a) = mid;
    return b;
  }

  /// Where the argument is nearest to zero between a and b, where it has one extreme.
  double nearest(size_t which, double a, double b) const {
    constexpr double kGolden = 0.3819660112501051;
    for (int k = 0; k < 60; ++k) {
      const double c = a + kGolden * (b - a), d = b - kGolden * (b - a);
      if (std::abs(at(c, which)) < std::abs(at(d, which)))
        b = d;
      else
        a = c;
    }
    return 0.5 * (a + b);
  }

 private:
  const std::vector<double>& run(double t) const {
    // A tenth of a second or two; some 60 of a formula for every kink.
    constexpr double kMostWork = 1e8;
    work_ += static_cast<double>(program_.operations.size());
    if (work_ > kMostWork) refuse_formula(text_, "it has too many kinks for how long it is");
    results_.resize(program_.operations.size());
    program_.run(t, results_.data());
    return results_;
  }

  const std::string& text_;
  const Formula::Program& program_;
  std::vector<int> places_;  // of the results
  mutable double work_ = 0;  // operations so far
  mutable std::vector<double> results_;
};

}  // namespace

void Formula::check(double end, int samples) const {
  std::vector<std::pair<double, double>> smooth;  // from one kink or sample to the next
  const std::vector<double> at_kinks = kinks(end);
  auto kink = at_kinks.begin();
  check_finite(*this, 0);
  for (int i = 0; i < samples; ++i) {
    double from = end * i / samples;
    const double to = end * (i + 1) / samples;
    for (; kink != at_kinks.end() && *kink <= to; from = *kink++) {
      check_finite(*this, *kink);
      if (before(*kink) > from) smooth.emplace_back(from, before(*kink));
    }
    check_finite(*this, to);
    smooth.emplace_back(from, to);
  }
  const Least least(largest_of(*this, end, samples), end);
  const std::tuple<double Jet::*, const char*, double> entries[] = {
      {&Jet::value, "value", least.value}, {&Jet::rate, "rate", least.rate}};
  for (const auto& [entry, what, allowed] : entries)
    for (const auto& [a, b] : smooth) {
      if (std::abs((*this)(b).*entry - (*this)(a).*entry) <= allowed) continue;
      const auto [t, jump] = jump_between(*this, entry, a, b);
      if (!(jump <= allowed))
        refuse_formula(text_, std::string("its ") + what + " jumps at t = " + to_text(t, 6) + " s");
    }
}

std::vector<double> Formula::kinks(double end) const {
  constexpr int kLooks = 2000;
  const Arguments arguments(text_, *program_);
  std::vector<double> out;
  if (arguments.size() == 0) return out;
  const auto time = [&](int i) { return end * i / kLooks; };
  std::vector<double> last, now = arguments.at(0), next = arguments.at(time(1));
  for (int i = 1; i <= kLooks; ++i) {
    last = std::move(now);
    now = std::move(next);
    next = arguments.at(time(std::min(i + 1, kLooks)));
    for (size_t k = 0; k < arguments.size(); ++k) {
      if ((last[k] >= 0) != (now[k] >= 0)) {
        out.push_back(arguments.change(k, time(i - 1), time(i)));
        continue;
      }
      const bool dips =
          std::abs(now[k]) < std::abs(last[k]) && std::abs(now[k]) < std::abs(next[k]);
      if (!dips || (now[k] >= 0) != (next[k] >= 0)) continue;
      const double t = arguments.nearest(k, time(i - 1), time(std::min(i + 1, kLooks)));
      if ((arguments.at(t, k) >= 0) == (now[k] >= 0)) continue;
      out.push_back(arguments.change(k, time(i - 1), t));
      out.push_back(arguments.change(k, t, time(i + 1)));
    }
  }
  std::sort(out.begin(), out.end());
  out.erase(std::unique(out.begin(), out.end()), out.end());
  return out;
}

std::optional<Formula::Jump> Formula::first_jump(double end) const {
  const std::vector<double> at_kinks = kinks(end);
  if (at_kinks.empty()) return {};
  const Least least(largest_of(*this, end, 1000), end);
  for (const double t : at_kinks) {
    const Jet left = (*this)(before(t)), right = (*this)(t);
    if (std::abs(right.value - left.value) > least.value)
      return Jump{t, false, left.value, right.value};
    if (std::abs(right.rate - left.rate) > least.rate) return Jump{t, true, left.rate, right.rate};
  }
  return {};
}

}  // namespace flexmorph::io
