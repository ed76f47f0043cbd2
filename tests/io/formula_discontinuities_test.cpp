// Shows that the discontinuities of formulas are found, that the value and the derivatives there
// are those after them, and that unsuitable formulas are refused.
#include <gtest/gtest.h>

#include <cmath>

#include "geometry/base.h"
#include "io/case_files/formula.h"
#include "tests/io/scratch.h"

namespace flexmorph::io {
namespace {

std::string discontinuity(const std::string& text) {
  try {
    const Formula formula(text);
    formula.check(1);
  } catch (const Error& e) {
    EXPECT_EQ(e.kind(), Error::Kind::input);
    return e.what();
  }
  return "";
}

// The expected times are calculated by hand; each is the first double at or after the
// discontinuity, within the round-off of the arguments.
TEST(Formula, DiscontinuitiesAreFoundToRoundOff) {
  const double golden = (std::sqrt(5.0) - 1) / 2;
  const std::vector<std::pair<std::string, std::vector<double>>> all = {
      {"3*t + sin(t)", {}},
      {"abs(t - 1/3)", {1.0 / 3}},
      {"min(t, 1 - t^2)", {golden}},
      {"max(sin(pi*t), cos(pi*t))", {0.25}},
      {"step(0.7 - t) + abs(t - 0.2)", {0.2, 0.7}},
      {"smoothstep((t - 0.1)/0.5)", {0.1, 0.6}},
      {"piecewise(0, 0.25, t, 0.75, t^2)", {0.25, 0.75}},
      {"abs(min(t - 0.5, 0.25))", {0.5, 0.75}},
      // Two within a two-thousandth of the interval: 0.30012 -+ 1e-5.
      {"max((t - 0.30012)^2, 1e-10)", {0.30011, 0.30013}},
  };
  for (const auto& [text, times] : all) {
    const std::vector<double> found = Formula(text).discontinuities(1);
    ASSERT_EQ(found.size(), times.size()) << text;
    // The last pair is a difference of squares of 1e-10 with a slope of 2e-5.
    const double near = text.starts_with("max((") ? 1e-13 : 4e-16;
    for (size_t i = 0; i < times.size(); ++i) EXPECT_NEAR(found[i], times[i], near) << text;
  }
}

// Derivatives are one-sided: at a discontinuity those after it, at the previous double those before
// it.
TEST(Formula, IsAtAKinkWhatItIsBehindIt) {
  const Formula down("abs(1/2 - t)*t");  // t/2 - t^2, then t^2 - t/2
  const double discontinuity = down.discontinuities(1).at(0);
  EXPECT_NEAR(down(discontinuity).rate, 0.5, 1e-15);
  EXPECT_EQ(down(discontinuity).acceleration, 2);
  EXPECT_NEAR(down(std::nextafter(discontinuity, 0)).rate, -0.5, 1e-15);
  EXPECT_EQ(down(std::nextafter(discontinuity, 0)).acceleration, -2);
  const Formula pieces("piecewise(t, 0.3, 5, 0.6, t^2)");
  EXPECT_EQ(pieces.discontinuities(1), (std::vector<double>{0.3, 0.6}));
  EXPECT_EQ(pieces(0.3).value, 5);
  EXPECT_EQ(pieces(std::nextafter(0.3, 0)).rate, 1);
}

TEST(Formula, JumpsAtDiscontinuitiesAreTold) {
  EXPECT_FALSE(Formula("t*abs(t - 0.5)*(t - 0.5)").first_jump(1));
  EXPECT_FALSE(Formula("smoothstep(t/0.4)").first_jump(1));  // only its acceleration jumps
  const auto corner = Formula("3*abs(t - 0.5)").first_jump(1);
  ASSERT_TRUE(corner && corner->of_rate);
  EXPECT_EQ(corner->time, 0.5);
  EXPECT_EQ(corner->before, -3);
  EXPECT_EQ(corner->after, 3);
  const auto step = Formula("piecewise(1, 0.25, 2 + t)").first_jump(1);
  ASSERT_TRUE(step && !step->of_rate);
  EXPECT_EQ(step->time, 0.25);
  EXPECT_EQ(step->after, 2.25);
}

// A path starts from rest: in 1e-5 s it moves by less than the last digit of its position, and its
// computed rate is round-off. A corner in such a short time must still be found.
TEST(Formula, IsCheckedOverShortTimes) {
  const Formula path("0.5*cos(pi - (-2*pi*(t - 1/2)^3 + 3/2*pi*t - pi/4))");
  for (const double end : {1e-9, 1e-7, 1e-5, 1e-3, 1.0}) EXPECT_NO_THROW(path.check(end)) << end;
  EXPECT_TRUE(Formula("abs(t - 1/300000)").first_jump(1e-5));
  EXPECT_TRUE(Formula("1 + abs(t - 1/300000)").first_jump(1e-5));
}

// Hundreds of discontinuities are found; thousands in a long formula are refused before they take
// seconds.
TEST(Formula, ManyDiscontinuitiesAreFoundOrRefused) {
  EXPECT_EQ(Formula("abs(sin(pi*(500*t + 0.25)))").discontinuities(1).size(), 500u);
  std::string text = "0";
  for (int i = 0; i < 200; ++i) text += " + abs(sin(" + std::to_string(90000 + 7 * i) + "*t))";
  EXPECT_TRUE(says(discontinuity(text), "formula '" + text + "': ", {"long", "discontinuities"}));
}

TEST(Formula, FunctionsWithDiscontinuitiesAreReadOrRefused) {
  const std::vector<std::pair<std::string, std::vector<std::string>>> wrong = {
      {"min(t)", {"'min'", "1 argument"}},
      {"piecewise(1, 2)", {"'piecewise'", "2 arguments"}},
      {"piecewise(1, t, 2)", {"t1", "constants"}},
      {"piecewise(1, 0.5, 2, 0.4, 3)", {"t1", "increase"}},
      {"step", {"'step'", "parentheses"}},
      {"step(t - 1)/(t - 0.75)", {"value", "t = 0.75 s", "real"}},
      {"step(t - 0.5)*tan(4*t)", {"jump", "t = 1.1781 s"}},
  };
  for (const auto& [text, parts] : wrong) {
    std::string said;
    try {
      Formula(text).check(1.5);
    } catch (const Error& e) {
      said = e.what();
    }
    EXPECT_TRUE(says(said, "formula '" + text + "': ", parts));
  }
  EXPECT_EQ(Formula("max(2, 3)*min(4, 5) + abs(-1)")(0).value, 13);
  EXPECT_EQ(Formula("step(0)")(0.5).value, 1);
}

}  // namespace
}  // namespace flexmorph::io
