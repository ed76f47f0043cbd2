// Shows that a case whose numbers are formulas of constants, numbers with units and materials is
// the same case in SI units; that drives can use other drives; and that an at_least of 0 and a
// point mass of 0 mean none.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "cases/scene/materials/material.h"
#include "tests/cases/scene/breathing_scene.h"
#include "tests/support/errors.h"

namespace flexmorph::cases {
namespace {

TEST_F(Drives, NumbersMayHaveUnitsAndConstants) {
  const Changes changes = {
      "constants.h=\"5 mm\"",     "body.length=450 mm",      "body.width=10 cm",
      "body.thickness=2*h",       "body.density=2.7 g/cm^3", "body.youngs_modulus=100 N/mm^2",
      "body.elements=[\"9\", 1]", "time.end=1000 ms",        "body.flow.max_length=\"20*h\"",
      "constants.L0=\"90*h\""};
  const Scene given = read(changes), plain = read();
  const Body &a = given.bodies[0], &b = plain.bodies[0];
  EXPECT_EQ(a.length, b.length);
  EXPECT_EQ(a.width, b.width);
  EXPECT_EQ(a.thickness, b.thickness);
  EXPECT_EQ(a.density, b.density);
  EXPECT_EQ(a.youngs_modulus, b.youngs_modulus);
  EXPECT_EQ(a.elements, b.elements);
  EXPECT_EQ(given.time.end, plain.time.end);
  for (const double t : {0.1, 0.6})
    EXPECT_EQ(given.drives[0].motion(t).value, plain.drives[0].motion(t).value);
}

TEST_F(Drives, MayUseOtherDrives) {
  // A drive may be used before it is defined; `side` is the table of sin t, `turn` a formula.
  const Scene s = read({"drive.out.formula=\"L0 + swing*turn*side\"",
                        "drive.turn.table=", "drive.turn.formula=\"sin(2*pi*t)\""});
  for (const double t : {0.05, 0.41, 0.73}) {
    const double u = std::sin(2 * std::numbers::pi * t),
                 du = 2 * std::numbers::pi * std::cos(2 * std::numbers::pi * t),
                 ddu = -4 * std::numbers::pi * std::numbers::pi * u;
    const double v = std::sin(t), dv = std::cos(t), ddv = -v;
    const fem::Motion x = s.drives[0].motion(t);
    // The spline of 21 points has errors of the order h^6, h^5 and h^4.
    EXPECT_NEAR(x.value, 0.45 + 0.2 * u * v, 1e-9);
    EXPECT_NEAR(x.rate, 0.2 * (du * v + u * dv), 1e-7);
    EXPECT_NEAR(x.acceleration, 0.2 * (ddu * v + 2 * du * dv + u * ddv), 1e-5);
  }
  EXPECT_TRUE(says(complaint({"drive.out.formula=\"L0 + out\""}), "--set drive.out.formula",
                   {"'out'", "itself"}));
  EXPECT_TRUE(says(
      complaint({"drive.turn.table=", "drive.turn.formula=\"out\"", "drive.out.formula=\"turn\""}),
      "--set drive.out.formula", {"'out'", "'turn'", "each other"}));
  EXPECT_TRUE(says(complaint({"constants.turn=1", "drive.out.formula=\"L0*turn\""}),
                   "--set drive.out.formula", {"'turn'", "constant"}));
}

TEST_F(Drives, MaterialsGiveNumbersThatAreNotGiven) {
  const Scene s = read({"body.material=aluminium", "body.density=", "body.youngs_modulus="});
  EXPECT_EQ(s.bodies[0].density, 2700);
  EXPECT_EQ(s.bodies[0].youngs_modulus, 70e9);
  EXPECT_EQ(s.bodies[0].poisson_ratio, 0.3);
  const Scene other = read({"body.material=copper", "body.poisson_ratio="});
  EXPECT_EQ(other.bodies[0].youngs_modulus, 1e8);  // given
  EXPECT_EQ(other.bodies[0].poisson_ratio, 0.343);
  EXPECT_TRUE(says(complaint({"body.material=aluminum"}), "--set body.material",
                   {"'steel'", "'aluminium'"}));
}

// The density, the shear modulus E / (2 (1 + nu)) and the speed of sound sqrt(E / rho) of solids
// are within these bounds; a wrong unit of a row would be far outside.
TEST(Materials, ArePlausibleAndHaveSources) {
  EXPECT_GE(materials().size(), 10u);
  for (const Material& m : materials()) {
    const double sound = std::sqrt(m.youngs_modulus / m.density);
    EXPECT_TRUE(sound > 900 && sound < 5500) << m.name << " " << sound;
    EXPECT_TRUE(m.density > 900 && m.density < 9000) << m.name;
    EXPECT_TRUE(m.poisson_ratio > 0.2 && m.poisson_ratio < 0.45) << m.name;
    if (m.expansion) {
      EXPECT_TRUE(*m.expansion > 8e-6 && *m.expansion < 1e-4) << m.name;
    }
    EXPECT_GT(std::string(m.source).size(), 5u) << m.name;
    EXPECT_EQ(find_material(m.name), &m);
  }
  // EN 1993-1-1, 3.2.6, and EN 1999-1-1, 3.2.5.
  EXPECT_EQ(find_material("steel")->youngs_modulus, 210e9);
  EXPECT_EQ(*find_material("aluminium")->expansion, 23e-6);
  EXPECT_EQ(find_material("unobtainium"), nullptr);
}

TEST(NoLimits, AreZeros) {
  const auto limits = [](const Changes& changes) {
    return read("mbb", changes).designs[0].goal.limits.size();
  };
  const auto at_least = [](const std::string& value) {
    return "design.constraint=[{response='mass', at_least=" + value + "}]";
  };
  EXPECT_EQ(limits({"domain.density=1"}), 1u);
  EXPECT_EQ(limits({"domain.density=1", at_least("0")}), 1u);
  EXPECT_EQ(limits({"domain.density=1", at_least("0.5")}), 2u);
  EXPECT_EQ(
      limits({"domain.density=1", "design.constraint=[{response='mass', at_least=0, at_most=1}]"}),
      2u);
  EXPECT_NE(complaint_of_v01({"design.constraint=[{response='mass', at_least=-1}]"}), "");
}

TEST(NoMass, IsAPointMassOfZero) {
  const std::string mass = "point_mass=[{body=\"plate\", at=\"free_end\", mass=0}]";
  EXPECT_TRUE(read("rotating_plate_v01", {mass}).point_masses.empty());
  EXPECT_NE(complaint_of_v01({"point_mass=[{body=\"plate\", at=\"free_end\", mass=-1}]"}), "");
}

}  // namespace
}  // namespace flexmorph::cases
