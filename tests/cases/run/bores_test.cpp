// Shows that bolts and pins in the bores of a static plate hold and load the right nodes, that
// nodal forces have the given resultants and moments, and that results on cells and on outlines
// agree.

#include <gtest/gtest.h>

#include <numbers>

#include "cases/assembly/build.h"
#include "cases/assembly/static_conditions.h"
#include "io/tables.h"
#include "tests/cases/program.h"
#include "tests/support/errors.h"

namespace flexmorph::test {
namespace {

// A plate of 80 mm x 50 mm, full of material, with bores of 5 mm and 8 mm radius.
const std::string kHead = R"(
[domain]
name = "plate"
size = [0.08, 0.05]
thickness = 0.004
youngs_modulus = 70e9

[[support]]
disc = [0.02, 0.025, 0.005]
fix = ["x", "y"]

[[load]]
name = "pin"
[[load.force]]
disc = [0.05, 0.025, 0.008]
force = [300.0, -400.0]
bearing = true

[[load]]
name = "torque"
[[load.force]]
disc = [0.0501, 0.0249, 0.0081]
moment = 12.0

[[load]]
name = "inside"
[[load.force]]
disc = [0.07, 0.01, 0.0041]
force = [0.0, -100.0]

[[design]]
cell = 0.001
components = [1, 1]
max_volume = 0.999
start = "all.csv"
[[design.void]]
disc = [0.02, 0.025, 0.005]
[[design.void]]
disc = [0.05, 0.025, 0.008]
[optimizer]
max_iterations = 0
[output]
plots = false
vtk = false
)";

struct Bores : ::testing::Test {
  Scratch scratch;
  Bores() {
    scratch.write("all.csv", "X0,Y0,half_length,angle,c1,c2,c3\n0.04,0.025,0.2,0,0.1,0.1,0.1\n");
  }
  /// Writes the case with one line replaced. @returns the path of its file
  std::string with(const std::string& old, const std::string& line) const {
    std::string text = kHead;
    text.replace(text.find(old), old.size(), line);
    return scratch.write("bores.toml", text);
  }
};

TEST_F(Bores, AreHeldAndLoadedAtTheirRims) {
  const cases::Scene scene = cases::read_scene(io::CaseFile(with("vtk", "vtk")));
  const mmc::BodyProblem problem = cases::build_problems(scene).front();
  const Grid& grid = problem.grid;
  const cases::StaticConditions found = cases::static_conditions(scene, grid, problem.outside);
  const auto location = [&](int node) {
    return grid.node_position(node / (grid.ny + 1), node % (grid.ny + 1));
  };
  const Vec2 bolt(0.02, 0.025), pin(0.05, 0.025), disc(0.07, 0.01);
  // There are two unknowns per node. The number of nodes on the rim lies between the bounds 28 and
  // 44 for a circle of radius 5 cells.
  EXPECT_GE(found.held.size(), 2 * 28u);
  EXPECT_LE(found.held.size(), 2 * 44u);
  for (const fem::HeldUnknown& held : found.held)
    EXPECT_NEAR((location(held.node) - bolt).norm(), 0.005, 0.001);
  ASSERT_EQ(found.loads.size(), 3u);
  const auto resultant = [&](const mmc::LoadCase& load) {
    Vec2 sum = Vec2::Zero();
    for (const fem::NodalForce& f : load.forces) sum += f.force;
    return sum;
  };
  const auto moment = [&](const mmc::LoadCase& load) {
    double sum = 0;
    for (const fem::NodalForce& f : load.forces) {
      const Vec2 arm = location(f.node) - pin;
      sum += arm.x() * f.force.y() - arm.y() * f.force.x();
    }
    return sum;
  };
  EXPECT_NEAR((resultant(found.loads[0]) - Vec2(300, -400)).norm(), 0, 1e-9);
  EXPECT_NEAR(moment(found.loads[0]), 0, 1e-9);
  EXPECT_NEAR(resultant(found.loads[1]).norm(), 0, 1e-9);
  EXPECT_NEAR(moment(found.loads[1]), 12, 1e-9);
  for (const size_t l : {0u, 1u})
    for (const fem::NodalForce& f : found.loads[l].forces)
      if (f.force.norm() > 0) {
        EXPECT_NEAR((location(f.node) - pin).norm(), 0.008, 0.001);
      }
  // A pin does not pull: its forces point outwards, and there are none on the side behind it.
  for (const fem::NodalForce& f : found.loads[0].forces)
    EXPECT_GE(f.force.dot(location(f.node) - pin), -1e-12);
  // A disc in the material loads all nodes within 4.1 cells of its centre, which is a node: 49
  // nodes.
  EXPECT_NEAR((resultant(found.loads[2]) - Vec2(0, -100)).norm(), 0, 1e-9);
  int within = 0;
  for (int i = -5; i <= 5; ++i)
    for (int j = -5; j <= 5; ++j) within += i * i + j * j <= 4.1 * 4.1;
  EXPECT_EQ(found.loads[2].forces.size(), static_cast<size_t>(within));
  for (const fem::NodalForce& f : found.loads[2].forces)
    EXPECT_LE((location(f.node) - disc).norm(), 0.0041);
}

// Rims are stairs of cells in one discretization and round in the other; both converge to one
// solution. Nodes of a stair lie up to one cell outside of the circle, therefore the difference is
// about proportional to the cell (measured: half the cell gives 0.44 to 0.47 of the difference).
TEST_F(Bores, HaveTheSameEnergiesOnCellsAndOnOutlines) {
  std::vector<double> last;
  for (const char* cell : {"0.001", "0.0005"}) {
    const std::string folder = scratch / cell;
    const Ended ended = flexmorph(
        scratch,
        {"run", with("cell = 0.001", std::string("cell = ") + cell), "-o", folder, "--quiet"});
    ASSERT_TRUE(is_done(ended, folder));
    const io::CsvTable table = io::read_csv(folder + "/loads/plate.csv");
    EXPECT_EQ(table.texts("source"), (Words{"outline", "outline", "outline"}));
    const std::vector<double> cells = table.numbers("compliance"),
                              outline = table.numbers("strain_energy");
    std::vector<double> off;
    for (size_t l = 0; l < cells.size(); ++l)
      off.push_back(std::abs(cells[l] / (2 * outline[l]) - 1));
    for (size_t l = 0; l < last.size(); ++l) EXPECT_LT(off[l], 0.7 * last[l]) << cell << " " << l;
    last = off;
  }
  for (const double off : last) EXPECT_LT(off, 0.05);
}

TEST_F(Bores, RefuseWhatTheyCannotCarry) {
  const auto refused = [&](const std::string& old, const std::string& line) {
    const Ended ended = flexmorph(scratch, {"check", with(old, line)});
    EXPECT_EQ(ended.code, 2) << line;
    EXPECT_EQ(lines_of(ended.err).size(), 1u) << ended.err;
    return ended.err;
  };
  const std::string force = "force = [300.0, -400.0]\n";
  EXPECT_TRUE(testing::mentions_all(refused(force, "moment = 1.0\n"),
                                    {"bores.toml:", "load.pin.force.bearing", "`force`", "[N]"}));
  EXPECT_TRUE(testing::mentions_all(
      refused("moment = 12.0", "moment = 0.0"),
      {"bores.toml:", "load.torque.force", "`force`", "[N]", "`moment`", "[N m]"}));
  EXPECT_TRUE(testing::mentions_all(
      refused("disc = [0.05, 0.025, 0.008]\nforce", "edge = \"right\"\nforce"),
      {"bores.toml:", "load.pin.force.bearing", "`disc`"}));
  EXPECT_TRUE(testing::mentions_all(
      refused("disc = [0.0501, 0.0249, 0.0081]", "point = [0.05, 0.01]"),
      {"bores.toml:", "load.torque.force.moment = 12.0", "`edge`", "`box`", "`disc`"}));
  EXPECT_TRUE(testing::mentions_all(
      refused("disc = [0.05, 0.025, 0.008]\nforce", "disc = [0.05, 0.025, 0.012]\nforce"),
      {"bores.toml:", "load.pin.force.bearing", "hole", "void", "5e-04 m"}));
  EXPECT_TRUE(testing::mentions_all(
      refused("disc = [0.07, 0.01, 0.0041]", "disc = [0.07, 0.01, 0.0]"),
      {"bores.toml:", "load.inside.force.disc = [0.07, 0.01, 0.0]", "positive", "radius"}));
  EXPECT_TRUE(testing::mentions_all(
      refused("disc = [0.07, 0.01, 0.0041]", "disc = [0.02, 0.025, 0.003]"),
      {"bores.toml:", "load.inside.force.disc = [0.02, 0.025, 0.003]", "material", "0.001 m"}));
  EXPECT_TRUE(testing::mentions_all(
      refused("disc = [0.0501, 0.0249, 0.0081]", "disc = [0.0604, 0.0104, 0.0004]"),
      {"bores.toml:", "load.torque.force.disc = [0.0604, 0.0104, 0.0004]", "material", "0.001 m"}));
}

}  // namespace
}  // namespace flexmorph::test
