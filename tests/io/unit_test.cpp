// Shows that units of case files have the values of the International System of Units, and that
// other texts are no units.
#include "io/case_files/unit.h"

#include <gtest/gtest.h>

#include <numbers>

namespace flexmorph::io {
namespace {

double si(double value, const std::string& unit) {
  const std::optional<Unit> found = read_unit(unit);
  EXPECT_TRUE(found) << unit;
  return found ? found->si(value) : 0;
}

// Decimal units give the double that is nearest to the decimal number.
TEST(Units, DecimalOnesAreExact) {
  EXPECT_EQ(si(12, "mm"), 0.012);
  EXPECT_EQ(si(0.1, "mm"), 1e-4);
  EXPECT_EQ(si(210, "GPa"), 210e9);
  EXPECT_EQ(si(2, "ms"), 0.002);
  EXPECT_EQ(si(5, "kg"), 5);
  EXPECT_EQ(si(7.85, "g/cm^3"), 7850);
  EXPECT_EQ(si(7.85, "kg/dm3"), 7850);
  EXPECT_EQ(si(3, "N/mm"), 3000);
  EXPECT_EQ(si(355, "N/mm^2"), 355e6);
  EXPECT_EQ(si(3, "\xc2\xb5m"), 3e-6);
  EXPECT_EQ(si(250, "g mm^2"), 250e-9);
  EXPECT_EQ(si(40, "W/(m K)"), 40);
  EXPECT_EQ(si(40, "kN\xc2\xb7mm"), 40);
  EXPECT_EQ(si(4, "mm\xc2\xb2"), 4e-6);
  EXPECT_EQ(si(12e-6, "1/K"), 12e-6);
  EXPECT_EQ(si(5, "m s^-2"), 5);
}

TEST(Units, OthersHaveTheirDefinedValues) {
  EXPECT_DOUBLE_EQ(si(30, "deg"), std::numbers::pi / 6);
  EXPECT_DOUBLE_EQ(si(30, "\xc2\xb0"), std::numbers::pi / 6);
  EXPECT_DOUBLE_EQ(si(3, "rpm"), 0.1 * std::numbers::pi);
  EXPECT_DOUBLE_EQ(si(90, "deg/s"), 0.5 * std::numbers::pi);
  EXPECT_DOUBLE_EQ(si(2, "rev"), 4 * std::numbers::pi);
  EXPECT_DOUBLE_EQ(si(1, "N m/deg"), 180 / std::numbers::pi);
  EXPECT_DOUBLE_EQ(si(36, "km/h"), 10);
  EXPECT_DOUBLE_EQ(si(2, "in"), 0.0508);
  EXPECT_DOUBLE_EQ(si(1, "yd"), 0.9144);
  EXPECT_DOUBLE_EQ(si(1, "mil"), 2.54e-5);
  EXPECT_NEAR(si(1, "psi"), 6894.757293168, 1e-8);  // NIST SP 811
  EXPECT_NEAR(si(1, "lbf"), 4.4482216152605, 1e-13);
}

TEST(Units, HaveDimensions) {
  const auto same = [](const char* a, const char* b) {
    return read_unit(a)->dimension == read_unit(b)->dimension;
  };
  EXPECT_TRUE(same("N", "kg m/s^2"));
  EXPECT_TRUE(same("Pa", "N/mm^2"));
  EXPECT_TRUE(same("J", "N m"));
  EXPECT_TRUE(same("rpm", "rad/s"));
  EXPECT_FALSE(same("Hz", "rad/s"));
  EXPECT_FALSE(same("mm", "kg"));
  for (const char* key : {"m", "rad", "N m/rad", "kg/m^3", "Pa", "kg m^2", "m/s^2", "N m s/rad"})
    EXPECT_TRUE(units_like(key).starts_with(key)) << units_like(key);
  EXPECT_NE(units_like("m").find("mm"), std::string::npos);
  EXPECT_EQ(units_like("m").find("kg"), std::string::npos);
  EXPECT_EQ(units_like("cells"), "cells");
}

TEST(Units, AreNotOtherTexts) {
  for (const char* text :
       {"",     " ",   "cells", "foo", "mm^",  "m^x",   "m^0", "(m",   "m)",
        "m//s", "/",   "m/",    "kkg", "Mrpm", "m + m", "2*h", "m^99", "((((((((((((m))))))))))))",
        "\xff", "degC"})
    EXPECT_FALSE(read_unit(text)) << text;
}

}  // namespace
}  // namespace flexmorph::io
