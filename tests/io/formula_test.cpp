// Shows that formulas of time have the values of functions written in C++ and the derivatives of
// differences and of derivatives by hand, and that invalid text is refused with its position.
#include "io/case_files/formula.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>

#include "geometry/base.h"
#include "tests/io/scratch.h"

namespace flexmorph::io {
namespace {

using Constants = std::map<std::string, double>;

std::string complaint(const std::string& text, const Constants& constants = {}) {
  try {
    const Formula formula(text, constants);
    formula.check(1);
  } catch (const Error& e) {
    EXPECT_EQ(e.kind(), Error::Kind::input);
    return e.what();
  }
  return "";
}

/// A formula, the character that its refusal names (0 if any), and parts of the message.
struct Wrong {
  std::string text;
  int character;
  std::vector<std::string> parts;
};
void expect_refusal(const Wrong& wrong) {
  const std::string at = "character " + std::to_string(wrong.character) + ": ";
  EXPECT_TRUE(says(complaint(wrong.text),
                   "formula '" + wrong.text + "': " + (wrong.character > 0 ? at : ""),
                   wrong.parts));
}

/// Returns the length of a bar that guides a platform, Sun et al. (2018), (36), (37): the bar is
/// from (x0, 0) to a point at x_c from the middle of the platform.
std::string bar_length(const std::string& x0, const std::string& x_c) {
  const std::string theta = "(-2*pi*(t - 1/2)^3 + 3/2*pi*t - pi/4)";
  const std::string x = "(0.5*cos(pi - " + theta + ") + " + x_c + " - " + x0 + ")";
  const std::string y = "(0.5*sin(pi - " + theta + ") + 0.4)";
  return "sqrt(" + x + "^2 + " + y + "^2) - 0.1";
}

double bar_length(double x0, double x_c, double t) {
  const double theta = -2 * std::numbers::pi * std::pow(t - 0.5, 3) + 1.5 * std::numbers::pi * t -
                       std::numbers::pi / 4;
  return std::hypot(0.5 * std::cos(std::numbers::pi - theta) + x_c - x0,
                    0.5 * std::sin(std::numbers::pi - theta) + 0.4) -
         0.1;
}

struct Sample {
  std::string text;
  std::function<double(double)> same;
};

const std::vector<Sample>& samples() {
  static const std::vector<Sample> kSamples = {
      {"3", [](double) { return 3.0; }},
      {"-t^2", [](double t) { return -t * t; }},
      {"2 - 1 - t/4/2", [](double t) { return 1 - t / 8; }},
      {"0.5 + 0.1*sin(2*pi*t)^2",
       [](double t) { return 0.5 + 0.1 * std::pow(sin(2 * std::numbers::pi * t), 2); }},
      {"1.5e-1*t^3 - .5*t + 2E+1", [](double t) { return 0.15 * t * t * t - 0.5 * t + 20; }},
      {"tan(t)*cos(3*t)", [](double t) { return std::tan(t) * std::cos(3 * t); }},
      {"asin(0.9*t) + acos(t/2)", [](double t) { return std::asin(0.9 * t) + std::acos(t / 2); }},
      {"atan(t) + atan2(t - 2, 1 - t)",
       [](double t) { return std::atan(t) + std::atan2(t - 2, 1 - t); }},
      {"sinh(t)/cosh(t) - tanh(2*t)",
       [](double t) { return std::sinh(t) / std::cosh(t) - std::tanh(2 * t); }},
      {"exp(-3*t)*log(1 + t)", [](double t) { return std::exp(-3 * t) * std::log(1 + t); }},
      {"(1 + t)^(2*t)", [](double t) { return std::pow(1 + t, 2 * t); }},
      {"(1 + t)^2.7 + 2^t", [](double t) { return std::pow(1 + t, 2.7) + std::exp2(t); }},
      {"1/(1 + t)^3 + (2 + t)^(-3/2)",
       [](double t) { return std::pow(1 + t, -3) + std::pow(2 + t, -1.5); }},
      {"abs(t - 2)^3", [](double t) { return std::pow(2 - t, 3); }},
      {"sqrt((t - 3)^2)", [](double t) { return 3 - t; }},
      {"abs(t - 0.6)*t^2", [](double t) { return std::abs(t - 0.6) * t * t; }},
      {"min(t^2, 0.3*t + 0.13)", [](double t) { return std::min(t * t, 0.3 * t + 0.13); }},
      {"max(sin(5*t), cos(5*t))", [](double t) { return std::max(sin(5 * t), cos(5 * t)); }},
      {"exp(t)*step(t - 0.4) - step(0.9 - t)",
       [](double t) { return (t < 0.4 ? 0 : std::exp(t)) - (t > 0.9 ? 0 : 1); }},
      {"smoothstep((t - 0.2)/0.5)",
       [](double t) {
         const double u = std::clamp((t - 0.2) / 0.5, 0.0, 1.0);
         return u * u * (3 - 2 * u);
       }},
      {"piecewise(t, 0.4, t^3, 2*L, sin(t))",
       [](double t) { return t < 0.4   ? t
                             : t < 0.9 ? t * t * t
                                       : std::sin(t); }},
      {"L + a_1*t", [](double t) { return 0.45 + 0.2 * t; }},
      {bar_length("(-0.4)", "(-0.15)"), [](double t) { return bar_length(-0.4, -0.15, t); }},
      {bar_length("0.4", "0.15"), [](double t) { return bar_length(0.4, 0.15, t); }},
  };
  return kSamples;
}

class EveryFormula : public ::testing::TestWithParam<size_t> {
 protected:
  const Sample& sample = samples()[GetParam()];
  const Formula formula{sample.text, {{"L", 0.45}, {"a_1", 0.2}}};
};

// The tolerance is round-off of a value of order 1 after a few operations.
TEST_P(EveryFormula, HasTheValueOfTheSameFunction) {
  for (const double t : {0.05, 0.31, 0.5, 0.77, 1.0})
    EXPECT_NEAR(formula(t).value, sample.same(t), 2e-14 * (1 + std::abs(sample.same(t))))
        << sample.text << " at " << t;
}

// Differences of fourth order with h = 1e-3 have the error h^4 f^(5) / 30, at most 1e-8 for
// functions whose fifth derivative is below 3e5 (the path of the platform: (2 pi)^5 times a few).
TEST_P(EveryFormula, HasTheDerivativesOfItsDifferences) {
  const double h = 1e-3;
  const auto slope = [&](double t, double Jet::*entry) {
    const auto f = [&](double at) { return formula(at).*entry; };
    return (8 * (f(t + h) - f(t - h)) - (f(t + 2 * h) - f(t - 2 * h))) / (12 * h);
  };
  for (const double t : {0.05, 0.31, 0.5, 0.77, 0.98}) {
    const Jet x = formula(t);
    EXPECT_NEAR(x.rate, slope(t, &Jet::value), 2e-8 * (1 + std::abs(x.rate))) << sample.text;
    EXPECT_NEAR(x.acceleration, slope(t, &Jet::rate), 2e-8 * (1 + std::abs(x.acceleration)))
        << sample.text;
  }
}
INSTANTIATE_TEST_SUITE_P(Table, EveryFormula, ::testing::Range<size_t>(0, samples().size()));

// At the start of the platform's path, theta''(0) = 6 pi gives the acceleration 0.5 * 6 pi (P
// (36)).
TEST(Formula, DerivativesOfThePlatformByHand) {
  const Formula y("0.5*sin(pi - (-2*pi*(t - 1/2)^3 + 3/2*pi*t - pi/4)) + 0.4");
  const Jet start = y(0);
  EXPECT_NEAR(start.value, 0.4, 1e-15);
  EXPECT_NEAR(start.rate, 0, 1e-14);
  EXPECT_NEAR(start.acceleration, 3 * std::numbers::pi, 1e-13);
}

TEST(Formula, LongestBarOfThePlatform) {
  double longest = 0;
  for (const Formula& length :
       {Formula(bar_length("(-0.4)", "(-0.15)")), Formula(bar_length("0.4", "0.15"))})
    for (int i = 0; i <= 1000; ++i) longest = std::max(longest, length(1e-3 * i).value);
  EXPECT_NEAR(longest, 0.8717, 5e-5);  // length of the built platform
}

// f, f' and f" by hand, for all functions and for operations whose derivatives have special rules.
TEST(Formula, DerivativesAreThoseOfTables) {
  struct Row {
    std::string text;
    std::function<Jet(double)> by_hand;
  };
  const std::vector<Row> rows = {{"sin(2*t)",
                                  [](double t) {
                                    return Jet{sin(2 * t), 2 * cos(2 * t), -4 * sin(2 * t)};
                                  }},
                                 {"cos(2*t)",
                                  [](double t) {
                                    return Jet{cos(2 * t), -2 * sin(2 * t), -4 * cos(2 * t)};
                                  }},
                                 {"tan(t)",
                                  [](double t) {
                                    const double secant2 = 1 / (cos(t) * cos(t));
                                    return Jet{tan(t), secant2, 2 * tan(t) * secant2};
                                  }},
                                 {"asin(t)",
                                  [](double t) {
                                    const double d = 1 / sqrt(1 - t * t);
                                    return Jet{asin(t), d, t * d * d * d};
                                  }},
                                 {"acos(t)",
                                  [](double t) {
                                    const double d = 1 / sqrt(1 - t * t);
                                    return Jet{acos(t), -d, -t * d * d * d};
                                  }},
                                 {"atan(t)",
                                  [](double t) {
                                    const double d = 1 / (1 + t * t);
                                    return Jet{atan(t), d, -2 * t * d * d};
                                  }},
                                 {"atan2(t, 2)",
                                  [](double t) {
                                    const double d = 1 / (4 + t * t);
                                    return Jet{atan(t / 2), 2 * d, -4 * t * d * d};
                                  }},
                                 {"sinh(3*t)",
                                  [](double t) {
                                    return Jet{sinh(3 * t), 3 * cosh(3 * t), 9 * sinh(3 * t)};
                                  }},
                                 {"cosh(3*t)",
                                  [](double t) {
                                    return Jet{cosh(3 * t), 3 * sinh(3 * t), 9 * cosh(3 * t)};
                                  }},
                                 {"tanh(t)",
                                  [](double t) {
                                    const double d = 1 / (cosh(t) * cosh(t));
                                    return Jet{tanh(t), d, -2 * tanh(t) * d};
                                  }},
                                 {"exp(-t)",
                                  [](double t) {
                                    return Jet{exp(-t), -exp(-t), exp(-t)};
                                  }},
                                 {"log(t)",
                                  [](double t) {
                                    return Jet{log(t), 1 / t, -1 / (t * t)};
                                  }},
                                 {"sqrt(t)",
                                  [](double t) {
                                    return Jet{sqrt(t), 0.5 / sqrt(t), -0.25 / (t * sqrt(t))};
                                  }},
                                 {"1/t",
                                  [](double t) {
                                    return Jet{1 / t, -1 / (t * t), 2 / (t * t * t)};
                                  }},
                                 {"t^7",
                                  [](double t) {
                                    return Jet{pow(t, 7), 7 * pow(t, 6), 42 * pow(t, 5)};
                                  }},
                                 {"t^-3",
                                  [](double t) {
                                    return Jet{pow(t, -3), -3 * pow(t, -4), 12 * pow(t, -5)};
                                  }},
                                 {"t^1.3",
                                  [](double t) {
                                    return Jet{pow(t, 1.3), 1.3 * pow(t, 0.3), 0.39 * pow(t, -0.7)};
                                  }},
                                 {"3^t",
                                  [](double t) {
                                    const double k = std::log(3.0), f = pow(3, t);
                                    return Jet{f, k * f, k * k * f};
                                  }},
                                 {"t^t",
                                  [](double t) {
                                    const double f = pow(t, t), s = 1 + log(t);
                                    return Jet{f, f * s, f * (s * s + 1 / t)};
                                  }},
                                 {"t*exp(t)", [](double t) {
                                    return Jet{t * exp(t), (1 + t) * exp(t), (2 + t) * exp(t)};
                                  }}};
  for (const auto& [text, by_hand] : rows) {
    const Formula f(text);
    for (const double t : {0.1, 0.4, 0.9}) {
      const Jet x = f(t), y = by_hand(t);
      // The tolerance is round-off of a few operations; log(t) is small near 1.
      EXPECT_NEAR(x.value, y.value, 1e-14 * (1 + std::abs(y.value))) << text << " at " << t;
      EXPECT_NEAR(x.rate, y.rate, 1e-14 * (1 + std::abs(y.rate))) << text << " at " << t;
      EXPECT_NEAR(x.acceleration, y.acceleration, 1e-14 * (1 + std::abs(y.acceleration)))
          << text << " at " << t;
    }
  }
}

// Taylor test: |f(t + h) - f - h f' - h² f"/2| decreases as h³ over two decades.
TEST_P(EveryFormula, HasATaylorSeries) {
  const double t = 0.77;
  const Jet x = formula(t);
  const auto remainder = [&](double h) {
    return std::abs(formula(t + h).value - x.value - h * x.rate - h * h / 2 * x.acceleration);
  };
  const double third = remainder(1e-2) / 1e-6;
  for (const double h : {1e-3, 1e-4})
    EXPECT_LT(remainder(h), 2 * third * h * h * h + 1e-14 * (1 + std::abs(x.value)))
        << sample.text << ", h = " << h;
}

TEST(Formula, SignsBelongToTheNextOperand) {
  const double t = 0.7;
  const std::vector<std::pair<std::string, double>> all = {
      {"t^-2*3", 3 / (t * t)}, {"t^-1/2", 0.5 / t},         {"2^-t + 1", std::exp2(-t) + 1},
      {"2*-t + 1", 1 - 2 * t}, {"1 - 2*-t + 1", 2 + 2 * t}, {"t/-2*3", -1.5 * t},
      {"-t^2", -t * t},        {"2*-t^2", -2 * t * t},      {"-t^-2", -1 / (t * t)},
      {"(-t)^2", t * t},       {"2 - -t", 2 + t},           {"-2^2*t", -4 * t},
      {"8/4/2*t", t},          {"8 - 4 - 2 + t", 2 + t},    {"+t - +1", t - 1}};
  for (const auto& [text, value] : all)
    EXPECT_NEAR(Formula(text)(t).value, value, 1e-15 * (1 + std::abs(value))) << text;
}

// A factor may have no derivative where the product has one.
TEST(Formula, PowersOfOneBaseAreOnePower) {
  for (const char* text : {"sqrt(t)*t^2", "sqrt(t)*cos(t)*t^2", "t^2*(cos(t)*sqrt(t))",
                           "t^3*sqrt(t)/t*cos(t)", "(t^0.5)^5*cos(t)"}) {
    const Jet start = Formula(text)(0);
    EXPECT_EQ(start.value, 0) << text;
    EXPECT_EQ(start.rate, 0) << text;
    EXPECT_EQ(start.acceleration, 0) << text;
  }
  EXPECT_EQ(Formula("sqrt(t - 2)^2")(0.5).value, -1.5);
  EXPECT_EQ(Formula("t/t")(0).value, 1);
  EXPECT_EQ(Formula("a*log(t)", {{"a", 0}})(0).value, 0);
}

// The derivatives of a formula of a formula follow from the inner derivatives by the chain rule.
TEST(Formula, CompositionsKeepTheirDerivatives) {
  const std::string inner = bar_length("0.4", "0.15");
  const Formula f(inner), g("sin(3*(" + inner + "))/(1 + (" + inner + ")^2)");
  const Formula outer("sin(3*t)/(1 + t^2)");
  for (const double t : {0.0, 0.2, 0.5, 0.9}) {
    const Jet x = f(t), y = outer(x.value), z = g(t);
    EXPECT_NEAR(z.value, y.value, 1e-14);
    EXPECT_NEAR(z.rate, y.rate * x.rate, 1e-13);
    EXPECT_NEAR(z.acceleration, y.acceleration * x.rate * x.rate + y.rate * x.acceleration, 1e-11);
  }
  // Common parts are computed once: far fewer operations than all parts together.
  EXPECT_LT(g.n_operations(), f.n_operations() + 3 * outer.n_operations());
}

TEST(Formula, IsReadInAnyLocale) {
  const CommaLocale comma;
  EXPECT_EQ(Formula("1234.5*t")(2).value, 2469);
  expect_refusal({"t + 1,5", 6, {"operator", "\",\""}});
}

TEST(Formula, SaysWhatIsWrongAndWhere) {
  const std::vector<Wrong> wrong = {
      {"", 1, {"'('", "end"}},
      {"0.5 + 0.1*sin(2*pi*x)", 20, {"'x'", "unknown"}},
      {"sinn(t)", 1, {"function", "'sinn'"}},
      {"2*zeta(t)", 3, {"function", "'zeta'"}},
      {"1 + I*t", 5, {"'I'", "unknown"}},
      {"Pi*t", 1, {"'Pi'", "unknown"}},
      {"sin*t", 1, {"'sin'", "parentheses"}},
      {"2*sqrt( )", 7, {"parentheses", "empty"}},
      {"sin(t, t)", 1, {"'sin'", "2 arguments"}},
      {"sin(t", 6, {"')'", "end"}},
      {"t + ", 5, {"'('", "end"}},
      {"2t", 2, {"operator", "\"t\""}},
      {"1 + t)", 6, {"operator", "\")\""}},
      {"10^2 + t**2", 10, {"'('", "\"*\""}},
      {"t^2^3", 4, {"a^b^c", "parentheses"}},
      {"t^-2^3", 5, {"a^b^c", "parentheses"}},
      {"t^1e-3^2", 7, {"a^b^c", "parentheses"}},
      {"2*(1 + t^sin(t^2)^2)", 18, {"a^b^c", "parentheses"}},
      {"{t, 1}", 1, {"'{'"}},
      {"2·t", 2, {"letters"}},
      {"t < 1", 3, {"'<'"}},
      {"1.2.3*t", 1, {"'1.2.3'", "number"}},
      {"1e999*t", 1, {"'1e999'", "number"}},
      {"1/0", 0, {"division", "zero"}},
      {"0^t", 0, {"power of 0", "exponent"}},
      {"log(-1)", 0, {"real"}},
      {"sqrt(t - 0.5)", 0, {"value", "t = 0 s", "real"}},
      {"1/(t - 0.5)", 0, {"value", "t = 0.5 s", "infinite"}},
      {"t^1.5", 0, {"acceleration", "t = 0 s", "infinite"}},
      {"exp(1000*t)", 0, {"infinite"}},
      {"1/(t - 1/3)", 0, {"jump", "t = 0.333333 s"}},
      {"1/(t - 1/3)^2", 0, {"jump", "t = 0.333333 s"}},
      {"atan2(sin(7*t), cos(7*t))", 0, {"value", "jump", "t = 0.448799 s"}},
      {"t*tan(2*t)", 0, {"jump", "t = 0.785398 s"}},
      {"9^(9^9)", 2, {"exponent", "1e6"}},
      {std::string(200, '(') + "t" + std::string(200, ')'), 101, {"100", "parentheses"}},
  };
  for (const Wrong& each : wrong) expect_refusal(each);
  EXPECT_TRUE(contains(complaint(std::string(20'000, ' ') + "t"), "10000"));
  // Fast, but smooth functions are accepted.
  for (const char* text : {"sqrt(t)*t^2", "sin(2000*t)", "tanh(1e4*(t - 1/3))",
                           "exp(-1e6*(t - 1/3)^2)", "1e-30*sin(t)", "1e8 + t^3", "abs(t - 1/3)^3",
                           "abs(t - 1/3)", "abs(t - 0.25)", "step(t - 1/3)"})
    EXPECT_EQ(complaint(text), "");
}

// Formulas that would exhaust the stack, and powers beyond the range of doubles, are refused.
TEST(Formula, RefusesWhatHasNoEnd) {
  const std::vector<Wrong> wrong = {
      {std::string(8000, '-') + "t", 11, {"10 signs"}},
      {"t - + - + - + - + - + - + 1", 0, {"10 signs"}},
      {"((3)^(999999))^(999999)", 5, {"number", "large"}},
      {"((2*t)^(1000))^(1000)", 0, {"value", "t = 0.501 s", "infinite"}},
      {"(2*t + 2)^(999999)", 0, {"value", "t = 0 s", "infinite"}},
      {"(t^2)^(999*999999)", 6, {"exponent", "1e6"}}};
  for (const Wrong& each : wrong) expect_refusal(each);
  EXPECT_EQ(Formula("1 - -t")(2).value, 3);
  EXPECT_EQ(Formula("(2*t)^10")(1).value, 1024);
  EXPECT_EQ(Formula("((3)^(4))^(5)*t")(1).value, std::pow(3.0, 20));
}

TEST(Formula, ConstantsHaveNamesOfTheirOwn) {
  for (const char* name : {"t", "pi", "I", "Euler", "sin", "atan2", "", "2a", "_a", "a-b", "é"})
    EXPECT_NE(Formula::refusal_of_name(name), "") << name;
  for (const char* name : {"a", "L1", "long_name", "e", "T"})
    EXPECT_EQ(Formula::refusal_of_name(name), "") << name;
  EXPECT_TRUE(says(complaint("t", {{"sin", 1}}), "constant 'sin': ", {"function"}));
  EXPECT_TRUE(says(complaint("t", {{"a", std::nan("")}}), "constant 'a': ", {"finite"}));
  EXPECT_EQ(Formula("e*t", {{"e", 0.1}})(1).value, 0.1);  // exactly this double
}

}  // namespace
}  // namespace flexmorph::io
