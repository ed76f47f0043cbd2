#include "fem/dynamics/integrators/step_control.h"

#include <algorithm>
#include <cmath>

#include "geometry/base.h"
#include "geometry/text.h"

namespace flexmorph::fem {
namespace {

constexpr double kSafety = 0.95;
// Exponents of the error and of its change; an exponent 1/3 of the error alone would give the
// allowed error in the next step.
constexpr double kIntegral = 0.28, kProportional = 0.1;
constexpr double kGrowth = 1.5, kShrink = 0.2;  // limits of one change of the step size
constexpr double kDeadLow = 0.9,
                 kDeadHigh = 1.2;  // small changes, which do not justify a factorization
// Number of Newton iterations from which a step does not grow, and from which it shrinks; number of
// steps during which a step as long as a failed one is not tried again.
constexpr int kMany = 7, kTooMany = 10, kAvoid = 20;
// Lower limit of the error relative to that of the previous step, because an error estimate that
// crosses zero does not predict the error of the next step.
constexpr double kMemory = 0.5;

}  // namespace

StepControl::StepControl(const AdaptiveStep& settings, double span)
    : allowed_(std::pow(settings.tolerance, 1.5)),
      largest_(settings.largest > 0 ? std::min(settings.largest, span) : span / 50),
      smallest_(settings.smallest > 0 ? settings.smallest : 1e-10 * span) {
  if (!(settings.tolerance > 0 && settings.tolerance < 1) || !(span > 0) ||
      !(settings.largest >= 0 && settings.smallest >= 0 && settings.first >= 0))
    throw Error::input(
        "adaptive step: the tolerance must lie between 0 and 1, and step sizes must not be "
        "negative");
  if (smallest_ > largest_)
    throw Error::input("adaptive step: the smallest step is longer than the largest");
}

void StepControl::begin(double h) {
  request_ = std::clamp(h, smallest_, largest_);
  last_ = 0;
}

double StepControl::next(double left) const {
  if (left <= 1.001 * request_) return left;
  return left < 2 * request_ ? 0.5 * left : request_;
}

void StepControl::accepted(double h, double error, int iterations) {
  double ratio = std::max(error / allowed_, 1e-6);
  if (h < (1 - 1e-9) * request_) {
    // The step was shortened to end at an event time: it only shows whether request_ is too long.
    request_ = std::min(request_, kSafety * h * std::pow(ratio, -1.0 / 3));
    shrunk_ = false;
    return;
  }
  ratio = std::max(ratio, kMemory * last_);
  double change = kSafety * std::pow(ratio, -kIntegral);
  if (last_ > 0) change *= std::pow(last_ / ratio, kProportional);
  change = std::clamp(change, kShrink, shrunk_ || iterations >= kMany ? 1 : kGrowth);
  if (iterations >= kTooMany) change = std::min(change, 0.7);
  if (failed_ > 0 && ++since_failed_ > kAvoid) failed_ = 0;
  if (failed_ > 0) change = std::min(change, std::max(1.0, 0.7 * failed_ / h));
  if (change > kDeadLow && change < kDeadHigh) change = 1;
  // Predicted error of the next step, for the proportional term.
  const double next = std::clamp(h * change, smallest_, largest_);
  last_ = ratio * std::pow(next / h, 3);
  request_ = next;
  shrunk_ = false;
}

void StepControl::shorten(double h, double t, const char* why) {
  shrunk_ = true;
  last_ = 0;
  request_ = h;
  if (h >= smallest_) return;
  throw Error::numerical(formatted(
      "adaptive step: at t = %.6g s %s; the next step of %.2e s would be too short", t, why, h));
}

void StepControl::rejected(double h, double error, double t) {
  const double change = 0.9 * std::pow(error / allowed_, -1.0 / 3);
  // The step also shrinks if the error is not a number.
  shorten(h * (change > kShrink ? std::min(change, 0.85) : kShrink), t,
          "the local error remains larger than allowed by the tolerance");
}

void StepControl::failed(double h, double t) {
  failed_ = h;
  since_failed_ = 0;
  shorten(0.5 * h, t, "Newton's method does not converge");
}

}  // namespace flexmorph::fem
