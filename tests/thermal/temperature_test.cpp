// Shows that profiles of temperature start at 0, end at their rise, have the right rates, and list
// every time at which the rate or the acceleration jumps.
#include "fem/thermal/temperature.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/support/differences.h"
#include "tests/support/errors.h"

namespace flexmorph::fem {
namespace {

using testing::error_of;
using testing::first_difference;
using testing::mentions;

const char* const kSmooth[] = {"quartic", "cosine", "quintic", "linear"};

TEST(Temperature, RisesFromNothingToAll) {
  for (const char* name : kSmooth) {
    const auto T = make_temperature({profile_of(name), 80, 0.3, 0.7});
    EXPECT_EQ(T(0.2999).value, 0);
    EXPECT_EQ(T(0.3).value, 0);
    EXPECT_NEAR(T(1).value, 80, 1e-12);
    EXPECT_EQ(T(1.01).value, 80);
    EXPECT_EQ(T(1.01).rate, 0);
    double last = 0;
    for (double t = 0.31; t < 1; t += 0.01) {
      const Motion at = T(t);
      EXPECT_GT(at.value, last) << name << " never falls";
      last = at.value;
      EXPECT_NEAR(at.rate, first_difference([&](double h) { return T(t + h).value; }, 1e-3),
                  1e-6 * 80);
      EXPECT_NEAR(at.acceleration, first_difference([&](double h) { return T(t + h).rate; }, 1e-3),
                  1e-5 * 80);
    }
  }
  // The values at half of the rise are calculated by hand.
  const auto half = [](Profile p) { return make_temperature({p, 1, 0, 1})(0.5).value; };
  EXPECT_NEAR(half(Profile::quartic), 6. / 4 - 1 + 3. / 16, 1e-15);
  EXPECT_NEAR(half(Profile::cosine), 0.5, 1e-15);
  EXPECT_NEAR(half(Profile::quintic), 0.5, 1e-15);
  EXPECT_NEAR(half(Profile::linear), 0.5, 1e-15);
}

TEST(Temperature, StepIsThereFromItsStart) {
  const auto T = make_temperature({Profile::step, 80, 0, 0});
  EXPECT_EQ(T(0).value, 80);
  EXPECT_EQ(T(-1e-9).value, 0);
  EXPECT_EQ(T(0).rate, 0);
}

// Values just before and just after a time show that every jump is a listed discontinuity, and that
// no listed discontinuity is without a jump.
TEST(Temperature, KinksAreWhereSomethingJumps) {
  for (const char* name : {"quartic", "cosine", "quintic", "linear", "step"}) {
    const TemperatureRise rise{profile_of(name), 80, 0.3, 0.7};
    const auto T = make_temperature(rise);
    const std::vector<double> list = discontinuities(rise);
    for (const double t : {0.3, 0.55, 1.0}) {
      const Motion before = T(t - 1e-7), after = T(t + 1e-7);
      const double jump = std::abs(after.value - before.value) +
                          std::abs(after.rate - before.rate) +
                          std::abs(after.acceleration - before.acceleration);
      const bool listed =
          std::any_of(list.begin(), list.end(), [&](double k) { return std::abs(k - t) < 1e-12; });
      EXPECT_EQ(jump > 1, listed) << name << " at " << t;
    }
  }
}

// Time steps end exactly at discontinuities, also where start + duration is rounded: at a
// discontinuity the values are those after it, and at the previous double those before it.
TEST(Temperature, IsAtAKinkWhatItIsBehindIt) {
  for (const double start : {0.0, 0.1, 0.3, 1.7}) {
    const TemperatureRise rise{Profile::cosine, 1, start, 0.7};
    const auto T = make_temperature(rise);
    const double jump = 4.9348022 / 0.49;  // π²/2 / settle²
    const double first = discontinuities(rise).front(), last = discontinuities(rise).back();
    EXPECT_EQ(T(last).acceleration, 0);
    EXPECT_NEAR(T(std::nextafter(last, 0)).acceleration, -jump, 1e-5);
    EXPECT_NEAR(T(first).acceleration, jump, 1e-5);
    EXPECT_EQ(T(std::nextafter(first, -1)).acceleration, 0);
    EXPECT_NEAR(T(start + 0.7).value, 1, 1e-12);
  }
}

TEST(Temperature, OnlyBendsCarryThermalForces) {
  for (const char* name : {"quartic", "cosine", "quintic"})
    EXPECT_TRUE(accelerates({profile_of(name), 80, 0, 1}));
  for (const char* name : {"linear", "step"})
    EXPECT_FALSE(accelerates({profile_of(name), 80, 0, 1}));
  EXPECT_FALSE(accelerates({Profile::quartic, 0, 0, 1}));
}

TEST(Temperature, RefusesNonsense) {
  const std::string unknown = error_of(Error::Kind::input, [] { profile_of("sudden"); });
  for (const char* name : {"'sudden'", "cosine", "linear", "quartic", "quintic", "step"})
    EXPECT_TRUE(mentions(unknown, name)) << unknown;
  EXPECT_TRUE(mentions(error_of(Error::Kind::input,
                                [] {
                                  make_temperature({Profile::cosine, 1, 0, 0});
                                }),
                       "settling"));
  EXPECT_TRUE(mentions(error_of(Error::Kind::input,
                                [] {
                                  make_temperature({Profile::cosine, std::nan(""), 0, 1});
                                }),
                       "finite"));
}

}  // namespace
}  // namespace flexmorph::fem
