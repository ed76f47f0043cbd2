// Shows that files of other programs are read as they are, or refused with the row: tables of
// spreadsheets with blank rows, thousands points and noise, and drawings with curves that are drawn
// twice, lines of no length and dimensions. What was ignored is in the output of `check` and `run`.
#include <filesystem>
#include <numbers>
#include <random>

#include "io/files.h"
#include "tests/cases/program.h"
#include "tests/support/errors.h"

namespace flexmorph::test {
namespace {

namespace fs = std::filesystem;

const std::string kCrank = R"(
[time]
end = 1.0
step = 0.01
[[drive]]
name = "turn"
csv = "turn.csv"
column = "x"
[[rigid_body]]
name = "crank"
mass = 0.5
size = [0.5, 0.05]
center = [0.25, 0.0]
[[joint]]
type = "revolute"
point_a = [0.0, 0.0]
b = "crank"
[[joint]]
type = "angle_drive"
name = "motor"
b = "crank"
angle = "turn"
[output]
vtk = false
plots = false
)";

/// Returns a number with a decimal comma; of numbers from 1000 on, with a point after the
/// thousands.
std::string as_written(double x, bool thousands_point) {
  const auto whole = static_cast<int>(std::round(x));
  if (thousands_point && whole >= 1000)
    return std::to_string(whole / 1000) + "." + std::to_string(1000 + whole % 1000).substr(1);
  return std::to_string(whole);
}

struct GivenFiles : ::testing::Test {
  Scratch scratch;

  std::string crank(const std::string& table) const {
    scratch.write("turn.csv", table);
    return scratch.write("crank.toml", kCrank);
  }
  /// Returns the messages of check (standard output) and of run (standard error).
  std::pair<std::string, std::string> messages(const std::string& path,
                                               const Words& more = {}) const {
    Words check = {"check", path}, run = {"run", path, "--quiet", "-o", scratch / "out"};
    check.insert(check.end(), more.begin(), more.end());
    run.insert(run.end(), more.begin(), more.end());
    const Ended checked = flexmorph(scratch, check), ran = flexmorph(scratch, run);
    EXPECT_EQ(checked.code, 0) << checked.err;
    EXPECT_TRUE(is_done(ran, scratch / "out")) << ran.err;
    return {checked.out, ran.out + ran.err};
  }
};

TEST_F(GivenFiles, TablesWithThousandsPointsAreRefusedWithTheRow) {
  std::string table = "time;x\n";
  for (int i = 0; i <= 50; ++i)
    table += "0," + std::to_string(10000 + 200 * i).substr(1) + ";" +
             as_written(2000 * std::numbers::pi * i / 50, true) + "\n";
  const std::string path = crank(table);
  for (const char* command : {"check", "run"}) {
    const Ended ended = flexmorph(scratch, {command, path});
    EXPECT_EQ(ended.code, 2);
    // The eighth interval is the first one that ends beyond 1000.
    EXPECT_TRUE(testing::mentions_all(ended.err,
                                      {"drive.csv", "turn.csv:10: ", "'1.005'", "'0,0000'"},
                                      "flexmorph: " + path + ":7:7: "));
    EXPECT_EQ(lines_of(ended.err).size(), 1u);
  }
  EXPECT_FALSE(fs::exists("runs/crank"));
}

TEST_F(GivenFiles, BlankRowsAtTheEndAreIgnored) {
  std::string table = "time,x\n";
  for (int i = 0; i <= 50; ++i)
    table += io::to_text(0.02 * i) + "," + io::to_text(0.04 * std::numbers::pi * i) + "\n";
  const auto motion_of = [&](const std::string& rows) {
    messages(crank(rows));
    return contents_of(scratch / "out/motion.csv");
  };
  const std::string plain = motion_of(table);
  EXPECT_EQ(motion_of(table + "  \n"), plain);
  EXPECT_EQ(motion_of(table + ",\n,\n\n"), plain);
}

TEST_F(GivenFiles, NoiseInATableIsNamed) {
  std::mt19937 random(11);
  std::uniform_real_distribution<double> error(-0.01, 0.01);
  std::string smooth = "time,x\n", noisy = smooth;
  for (int i = 0; i <= 50; ++i) {
    const double t = 0.02 * i, x = 2 * std::numbers::pi * t;
    smooth += io::to_text(t) + "," + io::to_text(x) + "\n";
    noisy += io::to_text(t) + "," + io::to_text(x + error(random)) + "\n";
  }
  const auto [checked, ran] = messages(crank(noisy));
  for (const std::string& text : {checked, ran})
    EXPECT_TRUE(testing::mentions_all(text, {"drive.csv = \"turn.csv\"", "noise", " times "}));
  const auto [checked_smooth, ran_smooth] = messages(crank(smooth));
  EXPECT_FALSE(contains(checked_smooth + ran_smooth, "noise"));
}

std::string entity(const std::string& name, const std::vector<double>& values,
                   const std::vector<int>& codes, const std::string& layer = "0") {
  std::string out = "0\n" + name + "\n8\n" + layer + "\n";
  for (size_t k = 0; k < codes.size(); ++k)
    out += std::to_string(codes[k]) + "\n" + io::to_text(values[k]) + "\n";
  return out;
}
std::string line(double x0, double y0, double x1, double y1) {
  return entity("LINE", {x0, y0, x1, y1}, {10, 20, 11, 21});
}
std::string circle(double x, double y, double r, const std::string& layer = "0") {
  return entity("CIRCLE", {x, y, r}, {10, 20, 40}, layer);
}
/// Returns a plate of 80 x 40 units with two holes, and more entities.
std::string dxf(const std::string& more, int unit) {
  return "0\nSECTION\n2\nHEADER\n9\n$INSUNITS\n70\n" + std::to_string(unit) +
         "\n0\nENDSEC\n0\nSECTION\n2\nENTITIES\n" + line(0, 0, 80, 0) + line(80, 0, 80, 40) +
         line(80, 40, 0, 40) + line(0, 40, 0, 0) + circle(20, 20, 6) + circle(60, 20, 6) + more +
         "0\nENDSEC\n0\nEOF\n";
}

const std::string kPlate = R"(
[domain]
outline = "plate.dxf"
thickness = 0.005
youngs_modulus = 2.1e11
[[support]]
edge = "left"
fix = ["x", "y"]
[[load]]
[[load.force]]
edge = "right"
force = [0.0, -1000.0]
[[design]]
cell = 0.002
components = [4, 2]
max_volume = 0.5
[optimizer]
max_iterations = 2
[output]
vtk = false
plots = false
)";

TEST_F(GivenFiles, DrawingsWithSuperfluousContentsAreRead) {
  scratch.write("plate.dxf", dxf("", 4));
  const std::string path = scratch.write("plate.toml", kPlate);
  const std::string clean = messages(path).first;
  EXPECT_FALSE(contains(clean, "ignored"));
  // The left edge of 40 mm has 21 nodes, 2 mm apart.
  EXPECT_TRUE(testing::mentions_all(clean, {"drawing", "0.08 x 0.04 m", "2 holes", "support 1",
                                            "21 nodes from (0, 0) to (0, 0.04) m"}));
  const std::string plain = contents_of(scratch / "out/components.csv");
  const std::string text = entity("TEXT", {5, 5, 2}, {10, 20, 40});
  scratch.write(
      "plate.dxf",
      dxf(line(0, 0, 0, 0) + circle(60, 20, 6) + text + text + circle(0, 0, 99, "DIM"), 4));
  const auto [checked, ran] = messages(path);
  for (const std::string& out : {checked, ran})
    EXPECT_TRUE(testing::mentions_all(
        out, {"plate.dxf: 1 line of no length", "plate.dxf: 1 curve that is drawn twice",
              "plate.dxf: 2 TEXT", "plate.dxf: 1 curve on the layer 'DIM'"}));
  EXPECT_EQ(contents_of(scratch / "out/components.csv"), plain);
}

// The run folder keeps the texts of the case, and the kept case gives the same design.
TEST_F(GivenFiles, NumbersInTextsAreKept) {
  scratch.write("plate.dxf", dxf("", 4));
  std::string text = kPlate;
  text.replace(text.find("thickness = 0.005\nyoungs_modulus = 2.1e11"), 41,
               "thickness = \"2.5*cell\"\nmaterial = \"steel\"");
  text.replace(text.find("cell = 0.002"), 12, "cell = \"cell\"");
  const std::string given = scratch.write("given.toml", "[constants]\ncell = \"2 mm\"\n" + text);
  messages(scratch.write("plate.toml", kPlate));
  const std::string plain = contents_of(scratch / "out/components.csv");
  messages(given, {"--set", "design.max_volume=1/2"});
  EXPECT_EQ(contents_of(scratch / "out/components.csv"), plain);
  const std::string kept = contents_of(scratch / "out/case.toml");
  EXPECT_TRUE(testing::mentions_all(kept, {"cell = \"2 mm\"", "thickness = \"2.5*cell\"",
                                           "material = \"steel\"", "max_volume = \"1/2\""}));
  const Ended again =
      flexmorph(scratch, {"run", scratch / "out/case.toml", "--quiet", "-o", scratch / "again"});
  EXPECT_TRUE(is_done(again, scratch / "again")) << again.err;
  EXPECT_EQ(contents_of(scratch / "again/components.csv"), plain);
}

// A plate of 80 mil in mil is the plate of 80 yards divided by 36000.
TEST_F(GivenFiles, DrawingsAreInMilOrYards) {
  const std::string path = scratch.write("plate.toml", kPlate);
  for (const auto& [unit, cell] : {std::pair{9, "5.08e-5"}, std::pair{10, "1.8288"}}) {
    scratch.write("plate.dxf", dxf("", unit));
    const Words more = {"--set", std::string("design.cell=") + cell};
    Words words = {"check", path};
    words.insert(words.end(), more.begin(), more.end());
    const Ended ended = flexmorph(scratch, words);
    EXPECT_EQ(ended.code, 0) << ended.err;
    EXPECT_TRUE(contains(ended.out, "40 x 20 cells")) << ended.out;
  }
}

}  // namespace
}  // namespace flexmorph::test
