// Shows that both rotating plates have the data of Sun et al. (2018), section 4.2, that defaults
// are those of the method, and that every bad input is refused with one message that gives location
// and reason.
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <iterator>
#include <numbers>
#include <set>

#include "cases/assembly/build.h"
#include "cases/scene/joints/row.h"
#include "tests/cases/scenes.h"
#include "tests/support/errors.h"

namespace flexmorph::cases {
namespace {

class ShippedCase : public ::testing::TestWithParam<std::string> {};

TEST_P(ShippedCase, HasTheDataOfThePaper) {
  const bool slow = GetParam() == "rotating_plate_v01";
  const Scene s = read_scene(io::CaseFile(shipped(GetParam()), Changes{}));
  EXPECT_EQ(s.name, GetParam());
  EXPECT_EQ(s.time.end, 1);
  EXPECT_EQ(s.time.step, 1e-3);
  EXPECT_EQ(s.time.start, Start::automatic);
  EXPECT_FALSE(s.gravity);
  ASSERT_EQ(s.hubs.size(), 1u);
  EXPECT_EQ(s.hubs[0].angular_velocity, 2 * std::numbers::pi);

  ASSERT_EQ(s.bodies.size(), 1u);
  const Body& plate = s.bodies[0];
  EXPECT_EQ(plate.length, 0.5);
  EXPECT_EQ(plate.width, 0.1);
  EXPECT_EQ(plate.thickness, 0.01);
  EXPECT_EQ(plate.density, 2700);
  EXPECT_EQ(plate.youngs_modulus, 1e8);
  EXPECT_EQ(plate.poisson_ratio, 0.3);
  EXPECT_EQ(plate.elements, (std::array{10, 2}));
  EXPECT_EQ(plate.terms, (std::vector<std::string>{"inertia", "membrane"}));
  ASSERT_TRUE(plate.flow);
  EXPECT_EQ(plate.flow->speed, slow ? 0.1 : 0.5);
  EXPECT_EQ(plate.flow->max_length, 0.1);
  EXPECT_DOUBLE_EQ(plate.flow->min_length, 0.03);
  EXPECT_DOUBLE_EQ(plate.longest(s.time.end), slow ? 0.6 : 1.0);
  EXPECT_EQ(s.point_masses.at(0).mass, 0.5);
  EXPECT_EQ(s.joints.at(0).mode, fem::WeldMode::edge);

  ASSERT_TRUE(s.esl);
  EXPECT_EQ(s.esl->count(s.time.end), slow ? 20 : 100);
  EXPECT_EQ(s.esl->settings.loads, mmc::LoadDefinition::inertia);
  EXPECT_EQ(s.esl->settings.support, mmc::Support::moving_root);
  ASSERT_EQ(s.designs.size(), 1u);
  const BodyDesign& d = s.designs[0];
  EXPECT_EQ(d.grid.nx, slow ? 240 : 400);
  EXPECT_EQ(d.grid.ny, 40);
  EXPECT_EQ(d.grid.y0, -0.05);
  EXPECT_EQ(2 * d.components[0] * d.components[1], slow ? 96 : 160);
  EXPECT_EQ(mmc::allowed_volume(d.goal), 0.5);
  EXPECT_EQ(d.min_thickness, 0.005);
  EXPECT_DOUBLE_EQ(d.tdf.band, d.band.back() * 0.0025);
  EXPECT_DOUBLE_EQ(d.tdf.sharpness, 1500);
  EXPECT_EQ(d.tdf.min_half_thickness, mmc::half_thickness_for(2 * 0.005));
  EXPECT_EQ(d.widths.solid, 2 * 0.005);
  EXPECT_EQ(d.widths.gap, 2 * 0.0025);
  EXPECT_DOUBLE_EQ(d.erosion, (slow ? 0.25 : 0.375) * d.widths.solid);
  // There are two columns of solid cells under the tip mass.
  ASSERT_EQ(d.solid.size(), 1u);
  EXPECT_NEAR(area({d.solid[0], {}}), 0.005 * 0.1, 1e-16);
  EXPECT_EQ(s.optimizer.name, "mma");
  EXPECT_EQ(s.optimizer.max_iterations, 300);
}
INSTANTIATE_TEST_SUITE_P(Cases, ShippedCase,
                         ::testing::Values("rotating_plate_v01", "rotating_plate_v05"));

TEST(SceneReader, OptionalPartsAreAbsentUntilListed) {
  const Scene s = read_scene(io::CaseFile(FLEXMORPH_SHORT_CASE));
  EXPECT_FALSE(s.verify);
  EXPECT_TRUE(s.expect.empty());
  EXPECT_TRUE(s.designs[0].empty.empty());
  const Scene more =
      read("rotating_plate_v01",
           {"gravity=[0, -9.81]", "verify={mesh=[40, 8]}", "time.start=hub_at_rest",
            "optimizer.options.asyinit=0.1", "design.band=[3, 2, 1.5]",
            "expect.compliance={value=2.0, relative=0.1}", "expect.volume={at_most=0.5001}"});
  EXPECT_EQ(*more.gravity, Vec2(0, -9.81));
  EXPECT_EQ(more.verify->mesh, (std::array{40, 8}));
  EXPECT_EQ(more.verify->step, more.time.step);
  EXPECT_DOUBLE_EQ(more.time.spin_up, 0.2);
  EXPECT_EQ(more.optimizer.options.at("asyinit"), 0.1);
  EXPECT_EQ(more.optimizer.rest.rows, 15);
  EXPECT_DOUBLE_EQ(more.designs[0].at_band(0).band, 3 * 0.0025);
  EXPECT_DOUBLE_EQ(more.designs[0].tdf.band, 1.5 * 0.0025);
  EXPECT_TRUE(more.expect.at("compliance").holds(1.81));
  EXPECT_FALSE(more.expect.at("compliance").holds(1.79));
  EXPECT_FALSE(more.expect.at("compliance").holds(std::nan("")));
  EXPECT_TRUE(more.expect.at("volume").holds(0.5));
  EXPECT_FALSE(more.expect.at("volume").holds(0.51));
}

// By default the initial components fill about the allowed volume.
TEST(SceneReader, DefaultComponentsFillTheVolume) {
  std::string text;
  {
    std::ifstream in(shipped("rotating_plate_v01"));
    for (std::string line; std::getline(in, line);)
      if (!line.starts_with("half_length")) text += line + "\n";
  }
  const std::string path = ::testing::TempDir() + "flexmorph_default_components.toml";
  std::ofstream(path) << text;
  const Scene s = read_scene(io::CaseFile(path, Changes{"design.min_thickness=1e-4"}));
  std::remove(path.c_str());
  const BodyDesign& d = s.designs[0];
  const double box = 0.025 * 0.05;
  EXPECT_DOUBLE_EQ(d.half_length, 0.5 * std::hypot(0.025, 0.05));
  // Each box contains two bars of 2 L x 2 c; the area of their crossing is counted two times.
  EXPECT_NEAR(2 * 4 * d.half_length * d.half_thickness / box, 0.5, 1e-12);
}

/// Returns the names of the rows and expects that each has a sentence.
template <class Rows>
std::set<std::string> described(const Rows& rows) {
  std::set<std::string> names;
  for (const auto* row : rows) {
    EXPECT_TRUE(names.insert(row->name).second) << row->name << " twice";
    EXPECT_TRUE(std::string(row->sentence).ends_with(".")) << row->name;
  }
  return names;
}

TEST(SceneReader, KnowsTheRowsOfItsTablesAndNoOthers) {
  EXPECT_EQ(described(spring_rows()), (std::set<std::string>{"linear", "torsion", "bushing", "stop",
                                                             "distance_stop", "angle_stop"}));
  EXPECT_EQ(described(load_rows()).size(), 7u);
  const std::string message = complaint_of_v01({"joint.type=hinge"});
  for (const std::string& name : described(joint_rows()))
    EXPECT_NE(message.find("'" + name + "'"), std::string::npos) << name;
  const std::string terms = complaint_of_v01({"body.terms=[\"hinge\"]"});
  const auto known = described(fem::term_rows());
  for (const std::string& name : fem::term_names(fem::TermDomain::plane)) {
    EXPECT_NE(terms.find("'" + name + "'"), std::string::npos) << name;
    EXPECT_TRUE(known.contains(name));
  }
}

// For an error in the file the message contains line, key and value.
TEST(SceneReader, ErrorsInTheFileNameLineKeyAndValue) {
  std::string text;
  int line = 0, found = 0;
  {
    std::ifstream in(shipped("rotating_plate_v05"));
    for (std::string each; std::getline(in, each);) {
      ++line;
      if (each.starts_with("thickness")) each = "thickness = -0.002", found = line;
      text += each + "\n";
    }
  }
  const std::string path = ::testing::TempDir() + "flexmorph_negative_thickness.toml";
  std::ofstream(path) << text;
  std::string message;
  try {
    read_scene(io::CaseFile(path));
  } catch (const Error& e) {
    message = e.what();
  }
  std::remove(path.c_str());
  EXPECT_TRUE(
      testing::mentions_all(message, {"positive", "[m]"},
                            path + ":" + std::to_string(found) + ":13: body.thickness = -0.002: "));
}

// A cell of a motion with an exact gradient consists of equally many cells of every design in each
// direction, square or not.
TEST(SceneReader, MergesAsManyCellsOfAllDesigns) {
  EXPECT_EQ(read("motion_platform", {"cycle.correct=first_order", "cycle.cell=0.00501"}).cycle.cell,
            0.00501);
  const Changes changes = {"cycle.cell=0.0166667", "cycle.correct=first_order",
                           "design.1.cells=[30, 12]"};
  std::string message;
  try {
    read_scene(io::CaseFile(FLEXMORPH_TWO_PLATES, changes));
  } catch (const Error& error) {
    message = error.what();
  }
  EXPECT_TRUE(
      testing::mentions_all(message, {"'light'", "0.0166667 m"}, "--set cycle.cell=0.0166667: "));
}

// If another body has free lines, the times of its mesh changes depend on the design, and there is
// no exact gradient.
TEST(SceneReader, RefusesGradientsWhereLinesAreFree) {
  std::string text;
  {
    std::ifstream in(FLEXMORPH_TWO_PLATES);
    text.assign(std::istreambuf_iterator<char>(in), {});
  }
  const std::string elements = "elements = [6, 1]";
  text.replace(text.rfind(elements), elements.size(),
               "elements = [6, 1]\n[[body.line]]\nindex = 3\nfree = true\nat = 0.25");
  const size_t weld = text.rfind("type = \"weld\"");
  text.replace(weld, text.find("[[point_mass]]") - weld,
               "type = \"sleeve\"\nbody = \"light\"\nedge = \"line 3\"\n"
               "mode = \"direction\"\nposition = [2.25, 0.0]\n\n");
  const size_t second = text.rfind("[[design]]"), after = text.find("[optimizer]");
  text.erase(second, after - second);
  const std::string path = ::testing::TempDir() + "flexmorph_free_line.toml";
  std::ofstream(path) << text;
  for (const char* change : {"cycle.correct=first_order", "certificate.checkpoints=0"}) {
    std::string message;
    try {
      const Changes changes = {change, "design.0.coupling=none", "time.start=rigid"};
      read_scene(io::CaseFile(path, changes));
    } catch (const Error& error) {
      message = error.what();
      EXPECT_EQ(error.kind(), Error::Kind::input);
    }
    EXPECT_TRUE(testing::mentions_all(message, {"gradient", "[[body.line]]"},
                                      std::string("--set ") + change + ": "));
  }
  std::remove(path.c_str());
}

// All designs that share mass must minimize the sum of compliances; their volumes may differ.
TEST(SceneReader, OnlyDesignsWithTheSameGoalShareMass) {
  std::string text;
  {
    std::ifstream in(FLEXMORPH_TWO_PLATES);
    text.assign(std::istreambuf_iterator<char>(in), {});
  }
  const auto complaint_of = [&](const Changes& changes, bool volume) -> std::string {
    std::string changed = text;
    const std::string goal = "max_volume = 0.5";
    if (volume)
      changed.replace(changed.rfind(goal), goal.size(),
                      "minimize = \"volume\"\nmax_compliance = 1.0");
    const std::string path = ::testing::TempDir() + "flexmorph_two_plates.toml";
    std::ofstream(path) << changed;
    std::string message;
    try {
      const Scene scene = read_scene(io::CaseFile(path, changes));
      EXPECT_TRUE(scene.designs[0].shares_mass && scene.designs[1].shares_mass);
    } catch (const Error& e) {
      message = e.what();
    }
    std::remove(path.c_str());
    return message;
  };
  EXPECT_EQ(complaint_of({"design.light.max_volume=0.3"}, false), "");
  EXPECT_TRUE(testing::mentions_all(complaint_of({"design.light.loads=worst"}, false),
                                    {"design.light.coupling", "shared_mass", "loads", "sum"}));
  EXPECT_TRUE(testing::mentions_all(complaint_of({}, true),
                                    {"coupling", "shared_mass", "minimize", "compliance"}));
  EXPECT_TRUE(testing::mentions_all(complaint_of({"design.light.coupling=none"}, false),
                                    {"design.heavy.coupling", "shared_mass", "[[design]]"}));
}

}  // namespace
}  // namespace flexmorph::cases
