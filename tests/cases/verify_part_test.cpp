// Shows that `flexmorph verify` reproduces the numbers of a design or of uniform material from a
// drawing of it, names missing material, and refuses drawings that cannot be used.

#include <gtest/gtest.h>

#include <filesystem>
#include <map>
#include <sstream>

#include "cases/results/parts/part_checks.h"
#include "geometry/components/outline.h"
#include "io/drawings/step.h"
#include "tests/cases/program.h"
#include "tests/cases/run_json.h"
#include "tests/cases/scenes.h"
#include "tests/support/errors.h"

namespace flexmorph::test {
namespace {

using Ring = std::vector<Vec2>;

/// Returns a drawing of closed polylines; `unit` is the number of the DXF unit, 6 for metres.
std::string dxf(const std::vector<Ring>& rings, int unit = 6,
                const std::string& layer = "OUTLINE") {
  std::ostringstream out;
  out.precision(17);
  out << "0\nSECTION\n2\nHEADER\n9\n$INSUNITS\n70\n" << unit << "\n0\nENDSEC\n";
  out << "0\nSECTION\n2\nENTITIES\n";
  for (const Ring& ring : rings) {
    out << "0\nLWPOLYLINE\n8\n" << layer << "\n90\n" << ring.size() << "\n70\n1\n";
    for (const Vec2& p : ring) out << "10\n" << p.x() << "\n20\n" << p.y() << "\n";
  }
  out << "0\nENDSEC\n0\nEOF\n";
  return out.str();
}

Ring box(double x0, double y0, double x1, double y1) { return corners_of({{x0, y0}, {x1, y1}}); }

Ended verify(const Scratch& scratch, const std::string& name, const std::string& part,
             const Words& changes = {}) {
  Words words = {"verify", name, "--part", part, "-o", scratch / "verified", "--quiet"};
  for (const std::string& change : changes) words.insert(words.end(), {"--set", change});
  return flexmorph(scratch, words);
}

json results(const Scratch& scratch) { return run_json(scratch / "verified"); }

/// Returns the numbers of the part divided by those of another column, by name.
std::map<std::string, double> ratios(const json& run, const std::string& column) {
  std::map<std::string, double> out;
  for (const json& row : run["verify"]["numbers"])
    if (row.contains(column) && row.contains("part"))
      out[row["name"]] = row["part"].get<double>() / row[column].get<double>();
  return out;
}

/// Overrides for the short plate on few cells: half of its motion, in which no line is inserted.
const Words kShort = {"design.cell=0.01",
                      "design.min_thickness=0.01",
                      "design.half_length=0.05",
                      "design.min_feature=0.02",
                      "time.end=0.06",
                      "esl.every=0.02",
                      "output.vtk=false",
                      "output.plots=false",
                      "output.tolerance=1e-4",
                      "optimizer.max_iterations=0",
                      "expect="};

/// Evaluates a design of two bars side by side and a cross bar in the short plate. @returns the run
/// folder
std::string run_bars(const Scratch& scratch) {
  const std::string bars = scratch.write("bars.csv",
                                         "X0,Y0,half_length,angle,c1,c2,c3\n"
                                         "0.26,-0.032,0.3,0.005,0.012,0.012,0.012\n"
                                         "0.26,0.032,0.3,-0.005,0.012,0.012,0.012\n"
                                         "0.26,0,0.05,1.4,0.012,0.012,0.012\n");
  Words changes = kShort;
  changes.insert(changes.end(), {"design.start='" + bars + "'", "design.max_volume=0.9"});
  const Ended ended = run(scratch, FLEXMORPH_SHORT_CASE, scratch / "run", changes);
  EXPECT_EQ(ended.code, 0) << ended.err;
  return scratch / "run";
}

// The crisp outline of a design, read back from its DXF or STEP file, has the motion and the static
// numbers of the design.
TEST(VerifyPart, DrawnAsTheDesignHasItsNumbers) {
  const Scratch scratch;
  const std::string folder = run_bars(scratch);
  for (const char* file : {"/design.dxf", "/design.step"}) {
    const Ended ended = verify(scratch, folder, "plate=" + folder + file);
    EXPECT_EQ(ended.code, 0) << ended.err;
    const json run = results(scratch);
    EXPECT_EQ(run["status"], "done");
    const std::map<std::string, double> beside = ratios(run, "design");
    for (const char* name : {"mass", "crisp_volume", "crisp_compliance", "body_fitted.compliance",
                             "body_fitted.largest_stress", "body_fitted.largest_displacement",
                             "min_feature", "min_gap", "pieces", "tip_deflection.largest",
                             "tip_deflection.rms", "strain_energy_integral"})
      EXPECT_TRUE(beside.contains(name)) << file << " " << name;
    // Fillets keep the stress finite: meshes with different vertices agree within their error, 2 %.
    for (const auto& [name, ratio] : beside)
      EXPECT_NEAR(ratio, 1, name == "body_fitted.largest_stress" ? 0.02 : 5e-3)
          << file << " " << name;
    // The part was moved on cells, as was uniform material.
    EXPECT_TRUE(testing::mentions_all(run["motion"]["verified_on"], {"cells"}));
    EXPECT_TRUE(ratios(run, "uniform").contains("strain_energy_integral"));
    EXPECT_FALSE(run["results"][0].contains("kkt"));
  }
  // The column "design" contains the numbers of the design's own run as far as that run computed
  // them.
  const json own = run_json(folder)["results"][0];
  const json last = results(scratch);
  for (const json& row : last["verify"]["numbers"])
    for (const char* name : {"crisp_volume", "min_feature", "min_gap", "crisp_compliance"})
      if (row["name"] == name) {
        EXPECT_NEAR(row["design"].get<double>(), own[name].get<double>(),
                    1e-6 * own[name].get<double>());
      }
}

// A drawing of the full rectangle is uniform material of volume fraction 1. Without a run there is
// no design to compare with.
TEST(VerifyPart, FullPlateIsUniformMaterial) {
  const Scratch scratch;
  Words changes = kShort;
  changes.emplace_back("design.max_volume=1");
  const std::string part = scratch.write("part.dxf", dxf({box(0, -50, 530, 50)}, 4, "0"));
  const Ended ended = verify(scratch, FLEXMORPH_SHORT_CASE, "plate=" + part, changes);
  EXPECT_EQ(ended.code, 0) << ended.err;
  const json run = results(scratch);
  const std::map<std::string, double> beside = ratios(run, "uniform");
  for (const char* name : {"mass", "crisp_compliance", "strain_energy_integral"})
    EXPECT_TRUE(beside.contains(name)) << name;
  for (const auto& [name, ratio] : beside) EXPECT_NEAR(ratio, 1, 1e-9) << name;
  EXPECT_TRUE(ratios(run, "design").empty());
  EXPECT_TRUE(testing::mentions_all(run["verify"]["notes"].dump(), {"design", "finished run"}));
}

// A case that cannot move a part on cells says so.
TEST(VerifyPart, HeatHasNoMotionOnCells) {
  cases::Scene hot = cases::read("heated_boom"), cold = cases::read("four_bar");
  EXPECT_TRUE(cases::motion_notes(hot).empty());  // No note, because no part is given.
  hot.designs[0].part = cold.designs[0].part = {{box(0, 0, 1, 1), {}}};
  ASSERT_EQ(cases::motion_notes(hot).size(), 1u);
  EXPECT_TRUE(testing::mentions_all(cases::motion_notes(hot)[0], {"heat", "design mesh"}));
  EXPECT_TRUE(cases::motion_notes(cold).empty());
}

// A static plate of 80 mm x 50 mm, held by a bolt and loaded at a pin; only static numbers are
// computed.
const std::string kBores = R"(
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
disc = [0.06, 0.025, 0.005]
force = [0.0, -400.0]
bearing = true
[[design]]
cell = 0.001
components = [2, 1]
max_volume = 0.9
min_feature = 0
[[design.void]]
disc = [0.02, 0.025, 0.005]
[[design.void]]
disc = [0.06, 0.025, 0.005]
[[design.solid]]
box = [0.0, 0.0, 0.08, 0.004]
[output]
plots = false
vtk = false
)";

struct Bores : ::testing::Test {
  Scratch scratch;
  std::string name = scratch.write("bores.toml", kBores);
  Ring bolt = circle_within({0.02, 0.025}, 0.005, 1e-6),
       pin = circle_within({0.06, 0.025}, 0.005, 1e-6);

  /// Verifies rings as a part. @returns the error output and the output of the program
  std::string said(const std::vector<Ring>& rings, int code) {
    const std::string part = scratch.write("part.dxf", dxf(rings));
    const Ended ended = verify(scratch, name, "plate=" + part);
    EXPECT_EQ(ended.code, code) << ended.err;
    return ended.err + ended.out;
  }
};

TEST_F(Bores, PlateAtRestHasStaticNumbers) {
  const std::string all = said({box(0, 0, 0.08, 0.045), bolt, pin}, 0);
  const json run = results(scratch);
  const double volume = (0.08 * 0.045 - 2 * 3.14159265 * 25e-6) / (0.08 * 0.05);
  EXPECT_NEAR(run["results"][0]["body_fitted"]["volume"].get<double>(), volume, 1e-4);
  EXPECT_GT(run["results"][0]["body_fitted"]["largest_stress"].get<double>(), 0);
  EXPECT_TRUE(testing::mentions_all(run["verify"]["notes"].dump(), {"motion", "static"}));
}

TEST_F(Bores, MissingMaterialIsNamed) {
  // There is no material around the bolt.
  EXPECT_TRUE(contains(said({box(0.04, 0, 0.08, 0.045), pin}, 5), "support 1"));
  EXPECT_EQ(results(scratch)["status"], "done, not usable");
  // There is no material around the pin.
  EXPECT_TRUE(contains(said({box(0, 0, 0.04, 0.045), bolt}, 5), "load 'pin'"));
  // A tenth of the solid border at the bottom is missing.
  EXPECT_TRUE(testing::mentions_all(
      said({{{0, 0}, {0.072, 0}, {0.072, 0.004}, {0.08, 0.004}, {0.08, 0.045}, {0, 0.045}},
            bolt,
            pin},
           5),
      {"10 %", "solid"}));
}

TEST_F(Bores, WrongDrawingsAreRefused) {
  const auto refused = [&](const std::string& part, const std::vector<std::string>& parts) {
    const Ended ended = verify(scratch, name, part);
    EXPECT_EQ(ended.code, 2) << ended.err;
    EXPECT_TRUE(testing::mentions_all(ended.err, parts));
    EXPECT_FALSE(std::filesystem::exists(scratch / "verified"));
  };
  const std::vector<Ring> plate = {box(0, 0, 0.08, 0.05), bolt, pin};
  const std::string good = scratch.write("part.dxf", dxf(plate));
  refused("arm=" + good, {"--part arm=", "no design", "'arm'", "plate"});
  refused(good, {"--part " + good + ": ", "BODY=FILE"});
  refused("plate=" + scratch / "none.dxf", {"none.dxf"});
  const Ended none = verify(scratch, scratch / "no_run", "plate=" + good);
  EXPECT_EQ(none.code, 2);
  EXPECT_TRUE(testing::mentions_all(none.err, {"no_run", "run folder", "case file"}));
  EXPECT_EQ(none.err.find("four_bar"), std::string::npos) << "shipped cases are listed";
  refused("plate=" + scratch.write("part.svg", "<svg/>"), {"part.svg: ", ".dxf", ".step", ".stp"});
  // Coordinates in metres with the unit millimetre or no unit, and coordinates in millimetres with
  // the unit metre, are refused.
  refused("plate=" + scratch.write("mm.dxf", dxf(plate, 4)),
          {"mm.dxf", "'plate'", "(0.08, 0.05) m", "unit"});
  refused("plate=" + scratch.write("large.dxf", dxf({box(0, 0, 80, 50)})),
          {"large.dxf", "(80, 50) m", "'plate'", "(0.08, 0.05) m", "within"});
  refused("plate=" + scratch.write("no.dxf", dxf(plate, 0)), {"no.dxf", "$INSUNITS"});
  refused(
      "plate=" + scratch.write("cross.dxf", dxf({plate[0], pin, box(0.06, 0.022, 0.075, 0.028)})),
      {"cross.dxf", "crosses"});
  // A STEP file must contain one solid of the thickness of the plate.
  const std::string step = scratch / "part.step";
  const Region a{box(0, 0, 0.03, 0.05), {}}, b{box(0.05, 0, 0.08, 0.05), {}};
  const Region both[] = {a, b};
  ASSERT_EQ(io::write_step(step, curves_of(both, 1e-6), 0.004), "");
  refused("plate=" + step, {"part.step", "2 solids"});
  ASSERT_EQ(io::write_step(step, curves_of({both, 1}, 1e-6), 0.005), "");
  refused("plate=" + step, {"part.step", "0.005 m", "0.004 m"});
}

}  // namespace
}  // namespace flexmorph::test
