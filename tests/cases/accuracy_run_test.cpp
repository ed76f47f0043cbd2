// Shows that `flexmorph accuracy` on the command line reproduces closed forms of small cases.

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>

#include "cases/assembly/build.h"
#include "cases/run/run.h"
#include "io/tables.h"
#include "tests/cases/program.h"
#include "tests/support/errors.h"

namespace flexmorph::cases {
namespace {

using test::Ended;
using test::Words;

/// Runs `flexmorph accuracy` on a case with further arguments.
Ended accuracy(const Scratch& scratch, const std::string& name, const std::string& folder,
               const Words& more) {
  Words words = {"accuracy", name, "-o", folder};
  words.insert(words.end(), more.begin(), more.end());
  return test::flexmorph(scratch, words);
}

// A static strip with a weight at its end: Euler's cantilever, u = F L³/(3 E I), with Poisson's
// ratio 0. The deflection is 1e-5 of the length, therefore nonlinear effects are negligible.
const char* const kStrip = R"toml(
[static]
steps = 4
[[body]]
name = "strip"
element = "ancf_plate"
space = "space"
terms = ["membrane", "bending"]
length = 1.0
width = 0.1
thickness = 0.01
youngs_modulus = 1e9
poisson_ratio = 0.0
elements = [2, 1]
[[joint]]
type = "clamp"
body = "strip"
edges = ["root"]
[[load]]
type = "edge"
body = "strip"
edge = "free_end"
force = [0.0, 0.0, 2.5e-3]
[[observe]]
name = "tip"
body = "strip"
at = "free_end"
[accuracy]
quantity = "strip.tip_uz"
# 2.5e-4 N at 1 m; E I = 1e9 x 0.1 x 1e-6 / 12 N m^2
reference = { value = 1e-5, source = "F L^3/(3 E I), 2.5e-4 N, E I = 1e9 x 0.1 x 1e-6 / 12" }
refinements = ["elements", "quadrature", "load_steps"]
)toml";

TEST(Accuracy, ReproducesTheCantileverAndWritesCasesThatRun) {
  const Scratch scratch;
  const std::string file = scratch.write("strip.toml", kStrip), folder = scratch / "out";
  const Ended ended = accuracy(scratch, file, folder, {"--budget", "10min"});
  ASSERT_EQ(ended.code, 0) << ended.err;
  const io::CsvTable table = io::read_csv(folder + "/accuracy.csv");
  const auto limits = table.numbers("limit"), values = table.numbers("value");
  const Words refinements = table.texts("refinement series");
  for (const char* name : {"elements", "quadrature", "load_steps"})
    EXPECT_GE(std::count(refinements.begin(), refinements.end(), name), 5) << name;
  // Cubic elements bend exactly under an end load. The curvatures of plate and beam differ by terms
  // of the square of the slope, 1e-10, which is far below the tolerance.
  for (size_t i = 0; i < limits.size(); ++i) EXPECT_NEAR(limits[i], 1e-5, 1e-5 * 1e-6);
  for (const char* name : {"/accuracy.md", "/accuracy.svg", "/strip_1pct.toml"})
    EXPECT_TRUE(std::filesystem::exists(folder + name)) << name << ended.out;
  EXPECT_NE(contents_of(folder + "/accuracy.md").find("kept"), std::string::npos) << ended.out;
  const Ended run = test::flexmorph(
      scratch, {"run", folder + "/strip_0.01pct.toml", "-o", scratch / "again", "--quiet"});
  EXPECT_EQ(run.code, 0) << run.err;

  // A second call runs no level again and reports identical numbers.
  const Ended again = accuracy(scratch, file, folder, {"--budget", "10min"});
  EXPECT_EQ(again.code, 0);
  const io::CsvTable second = io::read_csv(folder + "/accuracy.csv");
  const auto once_more = second.numbers("value");
  ASSERT_EQ(once_more.size(), values.size());
  for (size_t i = 0; i < values.size(); ++i)
    if (std::isfinite(values[i]) && std::isfinite(once_more[i])) {
      EXPECT_EQ(values[i], once_more[i]);
    }
}

TEST(Accuracy, RefusesWhatItCannotMeasure) {
  const Scratch scratch;
  const std::string folder = scratch / "out";
  const std::string file = scratch.write("strip.toml", kStrip);
  const auto fails = [&](const Words& more, const std::vector<std::string>& parts) {
    const Ended ended = accuracy(scratch, file, folder, more);
    EXPECT_EQ(ended.code, 2) << ended.out;
    EXPECT_TRUE(testing::mentions_all(ended.err, parts));
    EXPECT_EQ(test::lines_of(ended.err).size(), 1U) << ended.err;
    EXPECT_FALSE(std::filesystem::exists(folder));
  };
  // The message lists the quantities that exist.
  fails({"--set", "accuracy="}, {"strip.toml", "[accuracy]", "strip.tip_uz"});
  fails({"--set", "accuracy.quantity=compliance"},
        {"accuracy.quantity=compliance", "\"compliance\"", "strip.tip_uz"});
  fails({"--set", "accuracy.at=2"}, {"accuracy.at=2", "\"strip.tip_uz\"", "end", "1"});
  fails({"--set", "accuracy.refinements=[\"mesh\"]"},
        {"strip.toml:", "accuracy.refinements", "'mesh'", "elements, shape"});
  fails({"--set", "accuracy.reference={ value = 1, file = \"x.csv\", source = \"\" }"},
        {"accuracy.reference: ", "`value`", "`file`"});
  fails({"--refinements", "mesh"}, {"'mesh'", "elements, shape"});
  fails({"--refinements", "step"}, {"accuracy: ", "step", "time"});
  fails({"--budget", "soon"}, {"--budget soon: ", "120s"});
  fails({"--set", "accuracy.reference={ file = \"nowhere.csv\", source = \"\" }"},
        {"nowhere.csv: "});
}

// Evaluates the start design of the short beam; the quantity is the volume of the smoothed layout,
// which does not depend on the loads.
TEST(Accuracy, AnalysesADesignAsItStarts) {
  const Scratch scratch;
  const std::string folder = scratch / "out";
  const Ended ended =
      accuracy(scratch, "short_beam", folder,
               {"--set", "accuracy.quantity=volume", "--refinements", "band", "--budget", "600s",
                "--no-verify", "--set", "design.cell=0.1", "--set", "design.min_thickness=0.1",
                "--set", "design.min_feature=0"});
  ASSERT_EQ(ended.code, 0) << ended.err;
  const io::CsvTable table = io::read_csv(folder + "/accuracy.csv");
  EXPECT_GE(table.n_rows(), 5U);
  int finite = 0;
  for (const double value : table.numbers("value"))
    if (std::isfinite(value)) {
      ++finite;
      EXPECT_TRUE(value > 0.2 && value < 0.6) << value;
    }
  EXPECT_GE(finite, 3);
  // A run of zero iterations succeeds and records no iteration.
  const Ended run =
      test::flexmorph(scratch, {"run", "short_beam", "-o", scratch / "start", "--set",
                                "optimizer.max_iterations=0", "--set", "design.cell=0.1", "--set",
                                "design.min_feature=0", "--set", "expect=", "--quiet"});
  EXPECT_EQ(run.code, 0) << run.err;
  EXPECT_EQ(io::read_csv(scratch / "start/history.csv").n_rows(), 0U);
}

// The case verifies its design on a finer mesh than its own (11 x 3 elements); the recommended mesh
// may be still finer. The budget is large enough for every level on any machine, because the levels
// that a smaller budget leaves out would depend on the speed of the processor.
TEST(Accuracy, RecommendsMeshesThatTheWholeCaseTakes) {
  const Scratch scratch;
  const std::string folder = scratch / "out";
  const Ended ended = accuracy(scratch, "rotating_plate_v05", folder,
                               {"--refinements", "elements", "--budget", "600s", "--quiet", "--set",
                                "accuracy.at=0.05", "--set", "accuracy.scale=2.5e-3", "--set",
                                "verify={mesh=[11, 3]}", "--set", "time.step=5e-3"});
  ASSERT_EQ(ended.code, 0) << ended.err;
  const std::string file = folder + "/rotating_plate_v05_1pct.toml";
  ASSERT_TRUE(std::filesystem::exists(file)) << ended.out;
  const Scene finer = read_scene(io::CaseFile(file));
  EXPECT_GT(finer.bodies[0].elements[0], 11) << ended.out;
  EXPECT_FALSE(finer.verify);
  EXPECT_EQ(finer.designs.size(), 1u);
}

}  // namespace
}  // namespace flexmorph::cases
