// Shows that static plates of the shipped cases have the data of the literature, that forces
// distributed over a location have the given resultant, and that every bad input is refused with
// one message that gives location and reason.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "cases/assembly/build.h"
#include "io/drawings/exports.h"
#include "optim/mmc/cycles/design_verification.h"
#include "tests/cases/scenes.h"
#include "tests/io/scratch.h"
#include "tests/support/errors.h"

namespace flexmorph::cases {
namespace {

std::string static_refusal(const std::string& name, const Changes& changes) {
  try {
    const Scene scene = read(name, changes);
    build_static_loads(scene, build_problems(scene).front());
  } catch (const Error& e) {
    EXPECT_EQ(e.kind(), Error::Kind::input);
    return e.what();
  }
  return "";
}

TEST(StaticScene, ShortBeamIsThatOfTheLiterature) {
  const Scene s = read("short_beam");
  ASSERT_TRUE(s.domain.has_value());
  EXPECT_TRUE(s.bodies.empty());
  EXPECT_FALSE(s.esl.has_value());
  ASSERT_EQ(s.designs.size(), 1u);
  const BodyDesign& d = s.designs[0];
  EXPECT_EQ(d.grid.nx, 80);
  EXPECT_EQ(d.grid.ny, 40);
  EXPECT_EQ(d.grid.y0, 0);
  EXPECT_EQ(mmc::allowed_volume(d.goal), 0.4);
  const mmc::BodyProblem problem = build_problems(s).front();
  EXPECT_EQ(problem.design.n_components(), 16);
  EXPECT_EQ(problem.design.n_variables(), 56);  // variables of the lower half
  EXPECT_EQ(problem.locations.size(), 2u);
  // Reference for the full plate under its load (80 x 40 bilinear cells): beam theory with shear
  // for a cantilever twice as long as high, F = 1.
  const auto loads = build_static_loads(s, problem);
  const VectorXd full = VectorXd::Ones(d.grid.n_cells());
  const double beam = 8 / (3 * (1. / 12)) + 2 / (5. / 6 / 2.6);
  EXPECT_NEAR(loads->individual(full, full)[0], beam, 0.1 * beam);
}

TEST(StaticScene, BridgeHasThreeLoadsOfWhichTheWorstCounts) {
  const Scene s = read("bridge");
  const mmc::BodyProblem problem = build_problems(s).front();
  EXPECT_EQ(problem.goal.objective, &mmc::kComplianceWorst);
  EXPECT_EQ(problem.locations.size(), 5u);
  const auto loads = build_static_loads(s, problem);
  ASSERT_EQ(loads->n_loads(), 3);
  const VectorXd full = VectorXd::Ones(problem.grid.n_cells());
  const VectorXd C = loads->individual(full, full);
  EXPECT_NEAR(C[0], C[2], 1e-9 * C[0]);  // by symmetry
  EXPECT_GT(C[1], C[0]);
}

// Supports, loads and domain must be symmetric; a load of opposite direction is the image of a
// load.
TEST(StaticScene, IsSymmetricWhereEverythingIs) {
  const auto images = [](const std::string& name, const std::vector<std::string>& changes) {
    return build_problems(read(name, changes)).front().design.n_images();
  };
  EXPECT_EQ(images("short_beam", {}), 2u);
  EXPECT_EQ(images("short_beam", {"design.symmetry='none'"}), 1u);
  EXPECT_EQ(images("short_beam", {"load.0.force.0.point=[2.0, 0.25]"}), 1u);
  EXPECT_EQ(images("short_beam", {"design.components=[4, 3]"}), 2u);
  EXPECT_EQ(images("mbb", {}), 1u);
  EXPECT_EQ(images("l_bracket", {}), 1u);
  const auto start = [](double jitter) {
    return build_problems(read("short_beam", {"design.jitter=" + std::to_string(jitter)}))
        .front()
        .design;
  };
  EXPECT_TRUE(mmc::is_symmetric(start(0.1).components(), start(0).symmetry()));
  EXPECT_NE(start(0.1).x(), start(0).x());
}

/// Returns the area that only one of two region sets covers, as a fraction of the area of the
/// first.
double difference(std::span<const Region> a, std::span<const Region> b) {
  double common = 0;
  for (const Region& piece : a)
    for (const Region& other : b) {
      const std::vector<std::vector<Vec2>> outer = {other.outer};
      common += area(unite(outer, piece, other.holes));
    }
  return (area(a) + area(b) - 2 * common) / area(a);
}

// The exported outline of a symmetric design is its own mirror image. The start is disturbed,
// therefore it has no other symmetry.
TEST(StaticScene, ExportsOfSymmetricDesignsAreMirrorImages) {
  for (const std::string wanted : {"x", "y", "both"}) {
    const mmc::BodyProblem problem =
        build_problems(
            read("short_beam",
                 {"design.symmetry='" + wanted + "'", "design.symmetry_despite_loads=true",
                  "support.edge=", "support.box=[0.0, 0.0, 2.0, 1.0]", "design.jitter=0.2"}))
            .front();
    EXPECT_EQ(to_string(problem.design.symmetry()), wanted);
    const std::vector<Region> regions = mmc::exported_regions(problem);
    for (const bool in_x : {true, false}) {
      std::vector<Region> mirrored = regions;
      const auto mirror = [&](std::vector<Vec2>& ring) {
        for (Vec2& p : ring) p[in_x ? 0 : 1] = (in_x ? 2 : 1) - p[in_x ? 0 : 1];
        std::reverse(ring.begin(), ring.end());
      };
      for (Region& r : mirrored) {
        mirror(r.outer);
        for (std::vector<Vec2>& hole : r.holes) mirror(hole);
      }
      const bool kept = in_x ? wanted != "y" : wanted != "x";
      if (kept)
        EXPECT_LT(difference(regions, mirrored), 1e-9) << wanted << in_x;
      else
        EXPECT_GT(difference(regions, mirrored), 1e-3) << wanted << in_x;
    }
  }
}

// A symmetry that the case requests is established, or the message names what is not symmetric.
TEST(StaticScene, SymmetryThatIsAskedForIsThereOrRefused) {
  const auto symmetry = [](const std::string& name, const Changes& changes) {
    return to_string(build_problems(read(name, changes)).front().design.symmetry());
  };
  EXPECT_EQ(symmetry("short_beam", {}), "y");
  EXPECT_EQ(symmetry("short_beam", {"design.symmetry='y'"}), "y");
  EXPECT_EQ(symmetry("bridge", {}), "x");
  EXPECT_EQ(
      symmetry("rotating_plate_v01", {"design.symmetry='y'", "design.symmetry_despite_loads=true"}),
      "y");
  EXPECT_EQ(symmetry("rotating_plate_v01", {}), "none");
  const Changes low = {"load.0.force.0.point=[2.0, 0.25]", "design.symmetry='y'"};
  const std::string asked = "--set design.symmetry='y': ";
  EXPECT_TRUE(testing::mentions_all(static_refusal("short_beam", low),
                                    {"loads", "y = 0.5 m", "load case", "symmetry_despite_loads"},
                                    asked));
  const Changes enforced = {"load.0.force.0.point=[2.0, 0.25]", "design.symmetry='y'",
                            "design.symmetry_despite_loads=true"};
  EXPECT_EQ(symmetry("short_beam", enforced), "y");
  struct Asymmetric {
    Changes changes;
    std::vector<std::string> parts;
  };
  for (const auto& [changes, parts] : std::vector<Asymmetric>{
           {{"design.symmetry='x'"}, {"supports", "x = 1 m"}},
           {{"design.symmetry='both'"}, {"supports", "x = 1 m"}},
           {{"design.symmetry='y'", "design.solid=[{ box = [0.5, 0.0, 0.75, 0.25] }]"},
            {"solid", "y = 0.5 m"}},
           {{"design.symmetry='y'", "design.void=[{ box = [0.5, 0.0, 0.75, 0.25] }]"},
            {"void", "y = 0.5 m"}},
           {{"design.symmetry_despite_loads=true"}, {"symmetry = \"x\"", "\"y\"", "\"both\""}}})
    EXPECT_TRUE(testing::mentions_all(static_refusal("short_beam", changes), parts,
                                      "--set " + changes[0] + ": "));
  EXPECT_TRUE(testing::mentions_all(static_refusal("l_bracket", {"design.symmetry='y'"}),
                                    {"domain", "y = 0.5 m"}, asked));
  try {
    symmetry("rotating_plate_v01", {"design.symmetry='y'"});
    ADD_FAILURE();
  } catch (const Error& e) {
    EXPECT_TRUE(testing::mentions_all(
        e.what(), {"loads", "motion", "y = 0 m", "symmetry_despite_loads"}, asked));
  }
}

// Weight acts together with every load, is a load of its own, and is symmetric only across its own
// direction.
TEST(StaticScene, HasItsOwnWeight) {
  const std::vector<std::string> weight = {"gravity=[0.0, -10.0]", "domain.density=2.0"};
  const auto read_with = [&](std::vector<std::string> changes) {
    changes.insert(changes.begin(), weight.begin(), weight.end());
    return read("short_beam", changes);
  };
  const Scene s = read_with({});
  const mmc::BodyProblem problem = build_problems(s).front();
  EXPECT_EQ(problem.design.n_images(), 1u);  // the load is parallel to the weight
  const VectorXd full = VectorXd::Ones(problem.grid.n_cells());
  const VectorXd with = build_static_loads(s, problem)->displacement(full, full, 0),
                 force =
                     build_static_loads(read("short_beam"), problem)->displacement(full, full, 0);
  const Scene alone = read_with({"load="});
  ASSERT_EQ(alone.domain->loads.size(), 1u);
  const VectorXd own = build_static_loads(alone, problem)->displacement(full, full, 0);
  EXPECT_LT((with - force - own).norm(), 1e-12 * with.norm());
  // Reference: beam theory, q L^4 / (8 E I) with q = rho g A, and the shear deflection q L^2 / (2
  // kappa G A).
  const double q = 2 * 10 * 1, beam = q * 16 / (8 * (1. / 12)) + q * 4 / (2 * (5. / 6 / 2.6));
  const int tip = problem.grid.node(problem.grid.nx, problem.grid.ny / 2);
  EXPECT_NEAR(-own[2 * tip + 1], beam, 0.05 * beam);
  EXPECT_EQ(build_problems(read_with({"gravity=[-10.0, 0.0]", "load="})).front().design.n_images(),
            2u);
  EXPECT_THROW(read("short_beam", {"gravity=[0.0, -10.0]"}), Error);  // the density is missing
  EXPECT_THROW(read_with({"load=", "gravity=[0.0, 0.0]"}), Error);
}

TEST(StaticScene, LBracketKeepsOutOfWhatIsNotThere) {
  const Scene s = read("l_bracket");
  const mmc::BodyProblem problem = build_problems(s).front();
  ASSERT_EQ(problem.outside.size(), 6400u);
  EXPECT_EQ(mmc::ersatz_of(problem).n_domain_cells(), 4096);  // 64 % of 80 x 80
  const VectorXd material = mmc::fractions_of(problem, problem.design.components());
  EXPECT_EQ(material[problem.grid.cell(60, 60)], 0);
}

TEST(StaticScene, JitterIsRepeatableAndSmall) {
  const auto start = [](const Changes& changes) {
    return build_problems(read("short_beam", changes)).front().design.x();
  };
  const VectorXd straight = start({}), one = start({"design.jitter=0.1"});
  EXPECT_EQ(one, start({"design.jitter=0.1"}));
  EXPECT_NE(one, start({"design.jitter=0.1", "design.seed=2"}));
  EXPECT_GT((one - straight).lpNorm<Eigen::Infinity>(), 0.01);
  EXPECT_LE((one - straight).lpNorm<Eigen::Infinity>(), 0.1);
}

TEST(StaticScene, StartsFromAFileOfComponents) {
  const Scratch scratch;
  const std::vector<Component> two = crossing_layout(0, 0, 2, 1, 1, 1, 0.1, 0.6);
  io::write_components_csv(scratch / "two.csv", two);
  const Scene s = read("short_beam", {"design.start=\"" + (scratch / "two.csv") + "\""});
  const std::vector<Component> back = build_problems(s).front().design.components();
  ASSERT_EQ(back.size(), 2u);
  for (size_t k = 0; k < 2; ++k)
    for (size_t p = 0; p < 7; ++p)
      EXPECT_NEAR(back[k].parameters()[p], two[k].parameters()[p], 1e-14);
}

struct BadStatic {
  const char* name;
  Changes changes;
  std::vector<std::string> parts;  ///< Parts of the message after its location.
};
class StaticSceneRefuses : public ::testing::TestWithParam<BadStatic> {};
TEST_P(StaticSceneRefuses, AndSaysWhy) {
  const std::string said = static_refusal("short_beam", GetParam().changes);
  EXPECT_TRUE(testing::mentions_all(said, GetParam().parts,
                                    location_in(said, shipped("short_beam"), GetParam().changes)));
}
INSTANTIATE_TEST_SUITE_P(
    Table, StaticSceneRefuses,
    ::testing::Values(
        BadStatic{"motion", {"time.end=1"}, {"[time]", "[domain]"}},
        BadStatic{"size", {"domain.size=[2.0, -1.0]"}, {"positive", "[m]"}},
        BadStatic{"both",
                  {"domain.polygon=[0.0, 0.0, 1.0, 0.0, 1.0, 1.0]"},
                  {"domain", "size", "polygon", "outline"}},
        BadStatic{"edge", {"support.edge=\"rear\""}, {"'left', 'right', 'bottom', 'top'"}},
        BadStatic{"axis", {"support.fix=[\"z\"]"}, {"'x', 'y'"}},
        BadStatic{"goal", {"design.minimize=\"weight\""}, {"'compliance', 'volume', 'mass'"}},
        BadStatic{"limit", {"design.max_compliance=10.0"}, {"minimize", "volume"}},
        BadStatic{"no_limit", {"design.minimize=\"volume\""}, {"design.max_compliance", "missing"}},
        BadStatic{"start", {"design.start=\"nowhere.csv\""}, {"nowhere.csv"}},
        BadStatic{"far_load",
                  {"load.force.point=[9.0, 0.5]", "load.force.edge=", "load.force.box="},
                  {"[0, 2] x [0, 1] [m]"}},
        BadStatic{"unknown", {"domain.depth=1.0"}, {"size", "thickness", "youngs_modulus"}}),
    [](const auto& test) { return std::string(test.param.name); });

// The load lies within the bounding box, but not within the domain: this is detected on the mesh,
// and the key is named.
TEST(StaticScene, LoadsOutsideOfAPolygonAreRefusedWhereTheyStand) {
  const std::string said = static_refusal(
      "l_bracket", {"load.force.point=[0.9, 0.9]", "load.force.edge=", "load.force.box="});
  EXPECT_TRUE(
      testing::mentions_all(said, {"material", "0.0125 m"}, "--set load.force.point=[0.9, 0.9]: "));
}

TEST(StaticScene, NamesOfLoadsAreUnlike) {
  EXPECT_TRUE(testing::mentions_all(static_refusal("bridge", {"load.1.name=left"}),
                                    {"another", "'left'"}, "--set load.1.name=left: "));
  // A default name made from the number of the load counts, too.
  EXPECT_TRUE(
      testing::mentions_all(static_refusal("bridge", {"load.0.name=load_2", "load.1.name="}),
                            {"load.1", "another", "'load_2'"}, shipped("bridge") + ":"));
  EXPECT_EQ(static_refusal("bridge", {"load.0.name=one", "load.1.name=two"}), "");
}

// A rigid body cannot be measured or designed; the message says that it is rigid.
TEST(FlexibleBodies, AreNotRigidOnes) {
  for (const char* change : {"measure=[{body=\"crank\", quantities=[\"end_velocity\"]}]",
                             "observe.body=crank", "design.body=crank"}) {
    std::string said;
    try {
      read("four_bar", {change});
    } catch (const Error& e) {
      said = e.what();
    }
    EXPECT_TRUE(testing::mentions_all(said, {"rigid body", "[[body]]"},
                                      std::string("--set ") + change + ": "));
  }
}

}  // namespace
}  // namespace flexmorph::cases
