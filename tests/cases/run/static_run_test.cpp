// Shows that load cases of static plates are correct: a bar under tension against its closed form,
// and loads and supports at locations without material.

#include <gtest/gtest.h>

#include <filesystem>

#include "io/tables.h"
#include "tests/cases/program.h"
#include "tests/cases/run_json.h"
#include "tests/support/errors.h"

namespace flexmorph::test {
namespace {

/// A bar of 1 m x 0.1 m x 0.01 m is the lower half of a domain whose upper half is void. With
/// Poisson's ratio 0 it is under uniform tension.
constexpr const char* kBar = R"(title = "A bar at rest"
[domain]
name = "bar"
size = [1.0, 0.2]
thickness = 0.01
youngs_modulus = 2.0e11
poisson_ratio = 0.0

[[support]]
edge = "left"
fix = ["x", "y"]

[[load]]
name = "pull"
[[load.force]]
edge = "right"
force = [1000.0, 0.0]

[[load]]
name = "press"
weight = 3.0
[[load.force]]
edge = "right"
force = [-2000.0, 0.0]

[[design]]
cell = 0.025
components = [1, 1]
max_volume = 0.9
solid = [{box = [0.0, 0.0, 1.0, 0.1]}]
void = [{box = [0.0, 0.1, 1.0, 0.2]}]

[optimizer]
max_iterations = 0
)";
constexpr double kModulus = 2e11, kSection = 1e-3;  // [Pa], [m²]

// Reference: strain energy F² L / (2 E A), displacement F L / (E A), stress F / A. Half of the
// loaded edge lies at the void, therefore the whole force acts on the other half.
TEST(StaticRun, ABarIsStretchedAsItsClosedFormSays) {
  const Scratch scratch;
  const std::string folder = scratch / "out";
  const Ended ended = run(scratch, scratch.write("bar.toml", kBar), folder);
  EXPECT_EQ(ended.code, 0) << ended.err;
  const json result = run_json(folder)["results"][0];
  ASSERT_EQ(result["load_cases"].size(), 2u);
  const io::CsvTable table = io::read_csv(folder + "/loads/bar.csv");
  for (const size_t l : {0u, 1u}) {
    const json& load = result["load_cases"][l];
    const double force = l == 0 ? 1000 : 2000, energy = force * force / (2 * kModulus * kSection),
                 displacement = force / (kModulus * kSection), stress = force / kSection;
    EXPECT_EQ(load["load"], l == 0 ? "pull" : "press");
    EXPECT_EQ(load["weight"].get<double>(), l == 0 ? 1 : 3);
    EXPECT_EQ(load["active"].get<bool>(), l == 1);
    EXPECT_EQ(load["source"], "outline");
    EXPECT_NEAR(load["strain_energy"].get<double>(), energy, 1e-6 * energy);
    EXPECT_NEAR(load["largest_displacement"].get<double>(), displacement, 1e-6 * displacement);
    EXPECT_NEAR(load["largest_stress"].get<double>(), stress, 1e-6 * stress);
    // The stiffness of the void next to the bar is a millionth of that of the bar.
    EXPECT_NEAR(load["compliance"].get<double>(), 2 * energy, 1e-5 * energy);
    for (const char* column : {"strain_energy", "largest_displacement", "largest_stress"})
      EXPECT_EQ(table.numbers(column)[l], load[column].get<double>()) << column;
  }
}

// A bar that ends in the middle of the domain carries no load: there are no numbers of the outline,
// and the table contains those of the cells.
TEST(StaticRun, NumbersOfCellsAreSaidToBe) {
  const Scratch scratch;
  const std::string folder = scratch / "out";
  const Ended ended =
      run(scratch, scratch.write("bar.toml", kBar), folder,
          {"design.solid=[{box=[0.0, 0.0, 0.5, 0.1]}]",
           "design.start='" +
               scratch.write("none.csv",
                             "X0,Y0,half_length,angle,c1,c2,c3\n0.2,0.05,0.2,0,0.03,0.03,0.03\n") +
               "'"});
  EXPECT_EQ(ended.code, 5) << ended.err;
  EXPECT_TRUE(testing::mentions_all(ended.err, {"not usable", "'bar'", "connects", "support"}));
  EXPECT_TRUE(testing::mentions_all(ended.err, {"100 % of load 'pull'", "void"}));
  const json found = run_json(folder);
  for (const json& load : found["results"][0]["load_cases"]) {
    EXPECT_EQ(load["source"], "cells");
    EXPECT_EQ(load["strain_energy"].get<double>(), 0.5 * load["compliance"].get<double>());
    EXPECT_GT(load["largest_stress"].get<double>(), 0);
  }
}

// A bar in the lower half of the domain carries only the force of the lower half of the edge.
TEST(StaticRun, PartOfALoadOnVoidIsNamed) {
  const Scratch scratch;
  const std::string start = scratch.write(
      "lower.csv", "X0,Y0,half_length,angle,c1,c2,c3\n0.5,0.05,0.7,0,0.05,0.05,0.05\n");
  const Words changes = {"design.solid=", "design.void=", "design.start='" + start + "'"};
  const std::string path = scratch.write("bar.toml", kBar);
  Ended ended = run(scratch, path, scratch / "out", changes);
  EXPECT_EQ(ended.code, 5) << ended.err;
  EXPECT_TRUE(testing::mentions_all(ended.err, {"% of load 'pull'", "void"}));
  // If the load acts only on the material, it is carried completely.
  Words on_bar = changes;
  for (const char* load : {"0", "1"}) {
    const std::string location = "load." + std::string(load) + ".force.0.";
    on_bar.insert(on_bar.end(), {location + "edge=", location + "box=[1.0, 0.0, 1.0, 0.1]"});
  }
  ended = run(scratch, path, scratch / "on_bar", on_bar);
  EXPECT_EQ(ended.code, 0) << ended.err;
  EXPECT_EQ(ended.err.find("% of load"), std::string::npos) << ended.err;
}

// A location without a node that can have material, in a void region or outside of a polygon, is
// refused before the run.
TEST(StaticRun, LocationsInTheVoidAreRefused) {
  const Scratch scratch;
  const std::string path = scratch.write("bar.toml", kBar), folder = scratch / "out";
  for (const std::string& location : Words{"point=[0.5, 0.18]", "box=[0.3, 0.15, 0.6, 0.2]"}) {
    for (const std::string& where : Words{"load.0.force.0.", "support.0."}) {
      const Ended ended = run(scratch, path, folder, {where + "edge=", where + location});
      EXPECT_EQ(ended.code, 2) << ended.err;
      EXPECT_TRUE(testing::mentions_all(ended.err, {"material", "0.025 m"},
                                        "flexmorph: --set " + where + location + ": "));
      EXPECT_FALSE(std::filesystem::exists(folder));
    }
  }
}

}  // namespace
}  // namespace flexmorph::test
