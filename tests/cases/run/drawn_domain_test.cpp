// Shows that a plate with two holes is the same plate if it is drawn as DXF, drawn as SVG, or
// described as a rectangle with void discs; and that the run folder keeps the drawing.
#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <numbers>

#include "cases/assembly/build.h"
#include "cases/assembly/verified_loads.h"
#include "geometry/parts/outline_curves.h"
#include "optim/mmc/cycles/design_verification.h"
#include "tests/cases/program.h"
#include "tests/support/errors.h"

namespace flexmorph::test {
namespace {

using nlohmann::json;

const std::string kShape = R"(
[domain]
name = "plate"
thickness = 0.004
youngs_modulus = 70e9
)";
const std::string kRest = R"(
[[support]]
edge = "left"
fix = ["x", "y"]
[[load]]
[[load.force]]
point = [0.08, 0.025]
force = [0.0, -100.0]
[[design]]
cell = 0.001
components = [4, 2]
max_volume = 0.5
[optimizer]
max_iterations = 0
[output]
plots = false
)";

std::string circle(double x, double y, double r) {
  return "0\nCIRCLE\n8\n0\n10\n" + std::to_string(x) + "\n20\n" + std::to_string(y) +
         "\n30\n0\n40\n" + std::to_string(r) + "\n";
}
std::string dxf(const std::string& more) {
  std::string out =
      "0\nSECTION\n2\nHEADER\n9\n$INSUNITS\n70\n4\n0\nENDSEC\n0\nSECTION\n2\n"
      "ENTITIES\n0\nLWPOLYLINE\n8\n0\n90\n4\n70\n1\n";
  for (const char* corner :
       {"10\n0\n20\n0\n", "10\n80\n20\n0\n", "10\n80\n20\n50\n", "10\n0\n20\n50\n"})
    out += corner;
  return out + more + "0\nENDSEC\n0\nEOF\n";
}
const std::string kDxf = dxf(circle(20, 25, 5) + circle(50, 25, 8));
const std::string kSvg = R"(<svg width="80mm" height="50mm" viewBox="0 0 80 50">
<path fill="none" d="M0 0H80V50H0zM15 25a5 5 0 0 0 10 0a5 5 0 0 0 -10 0z"/>
<circle cx="50" cy="25" r="8"/></svg>)";
const double kHoles = std::numbers::pi * (25e-6 + 64e-6);

struct Plates : ::testing::Test {
  Scratch scratch;
  std::string drawn(const std::string& name, const std::string& drawing) const {
    scratch.write(name, drawing);
    return scratch.write(name + ".toml", kShape + "outline = \"" + name + "\"\n" + kRest);
  }
  std::string pierced() const {
    const std::string voids =
        "[[design.void]]\ndisc = [0.02, 0.025, 0.005]\n[[design.void]]\ndisc = [0.05, 0.025, "
        "0.008]\n";
    std::string rest = kRest;
    rest.insert(rest.find("[optimizer]"), voids);
    return scratch.write("pierced.toml", kShape + "size = [0.08, 0.05]\n" + rest);
  }
  static mmc::BodyProblem problem(const std::string& path) {
    return cases::build_problems(cases::read_scene(io::CaseFile(path))).front();
  }
};

TEST_F(Plates, AreOneByDxfSvgAndVoids) {
  const std::vector<Component> all = {
      {.center = {0.04, 0.025}, .half_length = 5, .c1 = 4, .c2 = 4, .c3 = 4}};
  const mmc::BodyProblem voids = problem(pierced());
  std::vector<double> crisp, cells;
  for (const std::string& path : {drawn("part.dxf", kDxf), drawn("part.svg", kSvg)}) {
    const mmc::BodyProblem p = problem(path);
    ASSERT_EQ(p.domain.holes.size(), 2u);
    const std::vector<Region> regions = mmc::exported_regions(p),
                              full = mmc::regions_of(p, all, 1e-5);
    // The chords deviate from the circles by at most 1e-5 of 80 mm; void discs deviate by at most
    // 1e-2 of a cell.
    EXPECT_NEAR(area(full), 4e-3 - kHoles, 2 * std::numbers::pi * 13e-3 * 8e-7);
    EXPECT_NEAR(area(regions), area(mmc::exported_regions(voids)),
                1e-5 * 2 * std::numbers::pi * 13e-3);
    crisp.push_back(mmc::fractions_of(p, p.design.components()).sum());
    cells.push_back(mmc::plate_of(p).n_domain_cells());
    EXPECT_TRUE(mmc::connectivity_of(p, full).connected);
    // A cell belongs to the domain either completely or not at all.
    EXPECT_NEAR(cells.back() * 1e-6, 4e-3 - kHoles, 0.01 * kHoles * 5);
  }
  EXPECT_EQ(cells[0], cells[1]);
  EXPECT_EQ(crisp[0], crisp[1]);
}

// The verification uses the outline, in which holes and voids are equivalent.
TEST_F(Plates, AreJudgedAlike) {
  std::vector<double> found;
  for (const std::string& path : {drawn("part.dxf", kDxf), pierced()}) {
    const cases::Scene scene = cases::read_scene(io::CaseFile(path));
    const mmc::BodyProblem p = cases::build_problems(scene).front();
    const verification::OutlineVerification verified =
        mmc::verify_design(p, mmc::exported_regions(p), cases::loads_by_position(scene, p));
    EXPECT_LT(verified.error, 0.005);
    found.push_back(verified.compliance);
  }
  EXPECT_GT(found[0], 0);
  EXPECT_NEAR(found[0], found[1], 0.01 * found[0]);  // each has an error of at most 0.5 %
}

// Bores from drawings and from discs are exported as circles of their own radius, sides as lines.
TEST_F(Plates, LeaveAsCirclesAndLines) {
  const std::vector<Component> all = {
      {.center = {0.04, 0.025}, .half_length = 5, .c1 = 4, .c2 = 4, .c3 = 4}};
  for (const std::string& path : {drawn("part.dxf", kDxf), pierced()}) {
    const mmc::BodyProblem p = problem(path);
    EXPECT_EQ(p.export_tolerance, 0.002 / 200);  // features are two cells thick
    const CurvedRegion plate = curves_of(mmc::regions_of(p, all, 1e-5), p.export_tolerance).front();
    EXPECT_EQ(plate.outer.size(), 4u);
    ASSERT_EQ(plate.holes.size(), 2u);
    EXPECT_NEAR(area(plate), 4e-3 - kHoles, 1e-14);
    for (const CurveRing& hole : plate.holes) {
      ASSERT_TRUE(hole.front().is_circle());
      const double radius = hole.front().center.x() < 0.03 ? 0.005 : 0.008;
      EXPECT_NEAR(hole.front().radius, radius, 1e-13);
    }
  }
}

// The exported curves enclose the verified area: it equals the area of the triangles within
// perimeter times tolerance.
TEST_F(Plates, LeaveAsCurvesOfTheJudgedArea) {
  for (const std::string& path : {drawn("part.dxf", kDxf), pierced()}) {
    const cases::Scene scene = cases::read_scene(io::CaseFile(path));
    const mmc::BodyProblem p = cases::build_problems(scene).front();
    const std::vector<Region> regions = mmc::exported_regions(p);
    const std::vector<CurvedRegion> curves = curves_of(regions, p.export_tolerance);
    double perimeter = 0;
    for (const CurvedRegion& r : curves) {
      std::vector<CurveRing> rings = r.holes;
      rings.push_back(r.outer);
      for (const CurveRing& ring : rings)
        for (const OutlineCurve& c : ring)
          perimeter += c.is_line() ? (c.to - c.from).norm() : c.radius * std::abs(c.sweep);
    }
    const PartMesh mesh = mmc::verify_design(p, regions, cases::loads_by_position(scene, p)).mesh;
    EXPECT_NEAR(area(curves), mesh.area(), perimeter * p.export_tolerance);
  }
}

TEST_F(Plates, RefuseTolerancesThatAreNone) {
  for (const std::string bad : {"0.01", "1e-8", "0.0", "-1e-5", "'fine'"}) {
    std::string rest = kRest + "tolerance = " + bad + "\n";
    const std::string path = scratch.write("bad.toml", kShape + "size = [0.08, 0.05]\n" + rest);
    const Ended ended = flexmorph(scratch, {"check", path});
    EXPECT_EQ(ended.code, 2) << bad;
    EXPECT_EQ(lines_of(ended.err).size(), 1u) << ended.err;
    EXPECT_TRUE(contains(ended.err, "output.tolerance = ")) << ended.err;
  }
  const std::string rest = kRest + "tolerance = 2e-5\n";
  EXPECT_EQ(
      problem(scratch.write("good.toml", kShape + "size = [0.08, 0.05]\n" + rest)).export_tolerance,
      2e-5);
}

TEST_F(Plates, KeepTheirDrawing) {
  const std::string path = drawn("part.dxf", kDxf), folder = scratch / "run";
  const Ended ended = flexmorph(scratch, {"run", path, "-o", folder, "--quiet"});
  ASSERT_TRUE(is_done(ended, folder));
  EXPECT_EQ(contents_of(folder + "/inputs/part.dxf"), kDxf);
  const mmc::BodyProblem kept = problem(folder + "/case.toml");
  EXPECT_EQ(rings_of(kept.domain), rings_of(problem(path).domain));
}

TEST_F(Plates, RefuseDrawingsThatAreNone) {
  const auto said = [&](const std::string& path) {
    const Ended ended = flexmorph(scratch, {"run", path, "-o", scratch / "none"});
    EXPECT_EQ(ended.code, 2);
    EXPECT_EQ(lines_of(ended.err).size(), 1u) << ended.err;
    return ended.err;
  };
  const std::string crossing = said(drawn("bad.dxf", dxf(circle(0, 0, 10))));
  EXPECT_TRUE(contains(crossing, "bad.dxf.toml:6"));
  EXPECT_TRUE(contains(crossing, "domain.outline = "));
  EXPECT_TRUE(contains(crossing, "bad.dxf: "));
  EXPECT_TRUE(contains(crossing, "holes"));
  const std::string both =
      scratch.write("both.toml", kShape + "outline = \"a.dxf\"\nsize = [1.0, 1.0]\n" + kRest);
  EXPECT_TRUE(testing::mentions_all(said(both),
                                    {"both.toml:", "domain", "`size`", "`polygon`", "`outline`"}));
  const std::string lost =
      scratch.write("lost.toml", kShape + "size = [0.08, 0.05]\nunit = \"mm\"\n" + kRest);
  EXPECT_TRUE(testing::mentions_all(said(lost), {"lost.toml:", "domain.unit", "`outline`"}));
  const std::string unit = drawn("no_unit.svg", "<svg><circle r='3'/></svg>");
  EXPECT_TRUE(testing::mentions_all(said(unit), {"no_unit.svg", "`unit`"}));
}

}  // namespace
}  // namespace flexmorph::test
