// Shows that formulas can use other functions of time by their names: values, exact derivatives by
// the chain rule, and discontinuities are those of the whole; cycles are refused with the names.
#include <gtest/gtest.h>

#include <cmath>

#include "geometry/base.h"
#include "io/case_files/formula.h"
#include "tests/io/scratch.h"

namespace flexmorph::io {
namespace {

using Constants = std::map<std::string, double>;

/// Returns the function exp(t) as a table would be given.
std::shared_ptr<const NamedFunctions::Function> exponential() {
  return std::make_shared<const NamedFunctions::Function>([](double t) {
    return Jet{std::exp(t), std::exp(t), std::exp(t)};
  });
}

void expect_equal(const Formula& f, const Formula& whole, double tolerance) {
  for (const double t : {0.0, 0.1, 0.37, 0.9}) {
    const Jet a = f(t), b = whole(t);
    EXPECT_NEAR(a.value, b.value, tolerance * (1 + std::abs(b.value))) << t;
    EXPECT_NEAR(a.rate, b.rate, tolerance * (1 + std::abs(b.rate))) << t;
    EXPECT_NEAR(a.acceleration, b.acceleration, tolerance * (1 + std::abs(b.acceleration))) << t;
  }
}

TEST(NamedFunctions, FormulasBecomeOneFormula) {
  NamedFunctions others;
  others.formulas = {{"angle", "a*sin(3*t)"}, {"twice", "2*angle + t"}};
  const Constants constants = {{"a", 0.4}};
  expect_equal(Formula("cos(twice)*angle^2", constants, others),
               Formula("cos(2*(0.4*sin(3*t)) + t)*(0.4*sin(3*t))^2"), 1e-14);
}

TEST(NamedFunctions, OfTablesFollowTheChainRule) {
  NamedFunctions others;
  others.functions["growth"] = exponential();
  expect_equal(Formula("sin(growth)*t + growth^3", {}, others), Formula("sin(exp(t))*t + exp(t)^3"),
               1e-13);
  others.formulas["more"] = "growth - 1";
  expect_equal(Formula("more*growth", {}, others), Formula("(exp(t) - 1)*exp(t)"), 1e-13);
  // The program keeps the function, also after the names are gone.
  const Formula kept = [] {
    NamedFunctions local;
    local.functions["growth"] = exponential();
    return Formula("2*growth", {}, local);
  }();
  EXPECT_EQ(kept(1).acceleration, 2 * std::exp(1.0));
}

TEST(NamedFunctions, KeepTheirDiscontinuities) {
  NamedFunctions others;
  others.formulas["ramp"] = "max(0, t - 0.25)";
  const Formula f("1 + ramp", {}, others);
  const std::vector<double> at = f.discontinuities(1);
  ASSERT_EQ(at.size(), 1u);
  EXPECT_NEAR(at[0], 0.25, 1e-15);
  EXPECT_TRUE(f.first_jump(1)->of_rate);
}

// Thirty formulas, each twice the one before, have 2^30 operations if they are written out.
TEST(NamedFunctions, ThatRepeatStaySmall) {
  NamedFunctions others;
  others.formulas["f0"] = "t^2";
  for (int k = 1; k < 30; ++k) {
    const std::string before = "f" + std::to_string(k - 1);
    others.formulas["f" + std::to_string(k)] = before + "/2 + " + before + "/2";
  }
  EXPECT_NEAR(Formula("f29", {}, others)(3).value, 9, 1e-12);
}

TEST(NamedFunctions, AreRefusedInCyclesAndWithErrors) {
  const auto complaint = [](const std::string& text, const NamedFunctions& others,
                            const Constants& constants = {}) -> std::string {
    try {
      const Formula formula(text, constants, others);
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), Error::Kind::input);
      return error.what();
    }
    return "";
  };
  NamedFunctions others;
  others.formulas = {
      {"a", "b + 1"}, {"b", "2*c"}, {"c", "a"}, {"self", "self + 1"}, {"bad", "1 +"}};
  EXPECT_TRUE(says(complaint("b + 1", others), "formula 'b + 1': ", {"'a'", "'b'", "'c'"}));
  EXPECT_TRUE(says(complaint("self + 1", others), "formula 'self + 1': ", {"'self'", "itself"}));
  EXPECT_TRUE(says(complaint("2*bad", others), "formula '2*bad': ", {"'bad'", "1 +"}));
  EXPECT_TRUE(says(complaint("2*bad", others, {{"bad", 1}}), "", {"'bad'", "constant"}));
  EXPECT_TRUE(says(complaint("none", others), "", {"'none'", "drives"}));
}

TEST(ConstantValue, HasNoTime) {
  EXPECT_DOUBLE_EQ(constant_value("2*h + sin(pi/6)", {{"h", 0.25}}), 1);
  for (const char* text : {"t", "2*t + 1", "x", "1/0", ""})
    EXPECT_THROW(constant_value(text, {}), Error) << text;
}

}  // namespace
}  // namespace flexmorph::io
