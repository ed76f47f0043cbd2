// Shows that drawings of other programs are read: a plate of 80 x 50 mm with two holes of 5 and 8
// mm radius, written with every supported entity, has its analytic area; invalid outlines are
// refused with a reason.
#include "io/drawings/drawing.h"

#include <gtest/gtest.h>
#include <sys/stat.h>

#include <cmath>
#include <numbers>

#include "geometry/components/outline.h"
#include "tests/io/drawn_plate.h"

namespace flexmorph::io {
namespace {

TEST_F(Drawings, LinesOfAnyOrderAndSenseAreJoined) {
  expect_plate(plate("part.dxf", dxf(kFrame + kHoles)));
  expect_plate(plate("PART.DXF", dxf(kFrame + kHoles)));
  // Windows ends lines with two characters.
  std::string windows;
  for (const char c : dxf(kFrame + kHoles))
    windows += c == '\n' ? std::string("\r\n") : std::string(1, c);
  expect_plate(plate("part.dxf", windows));
}

TEST_F(Drawings, UnitsAreThoseOfTheFileOrGiven) {
  const auto width = [&](int code, std::optional<double> unit) {
    return bounds_of(plate("part.dxf", dxf(kFrame, code), {unit, {}}).outer).upper.x();
  };
  EXPECT_NEAR(width(4, {}), 0.08, 1e-15);
  EXPECT_NEAR(width(6, {}), 80, 1e-12);
  EXPECT_NEAR(width(1, {}), 80 * 0.0254, 1e-14);
  EXPECT_NEAR(width(5, {}), 0.8, 1e-15);
  EXPECT_NEAR(width(0, 1e-3), 0.08, 1e-15);
  EXPECT_NEAR(width(6, 1e-3), 0.08, 1e-15);
  EXPECT_TRUE(refused("part.dxf", dxf(kFrame, 0), {"`unit`"}));
}

// A half circle has the bulge 1, which is an arc of 180 degrees counterclockwise.
TEST_F(Drawings, PolylinesHaveArcs) {
  const auto vertices = [](double bulge) {
    return std::vector<std::pair<int, double>>{{90, 4},  {70, 1}, {10, 0},     {20, 0},  {42, 0},
                                               {10, 60}, {20, 0}, {42, bulge}, {10, 60}, {20, 50},
                                               {42, 0},  {10, 0}, {20, 50},    {42, 0}};
  };
  const double half = 0.5 * std::numbers::pi * 25e-3 * 25e-3, box = 60e-3 * 50e-3;
  const Region out = plate("part.dxf", dxf(entity("LWPOLYLINE", vertices(1))));
  EXPECT_NEAR(area(out), box + half, std::numbers::pi * 25e-3 * 85e-3 * kDrawingTolerance);
  EXPECT_NEAR(bounds_of(out.outer).upper.x(), 85e-3, 1e-6);
  const Region in = plate("part.dxf", dxf(entity("LWPOLYLINE", vertices(-1))));
  EXPECT_NEAR(area(in), box - half, std::numbers::pi * 25e-3 * 85e-3 * kDrawingTolerance);
  // A quarter circle by POLYLINE, and by a chain with an arc in reverse direction.
  const double quarter = std::tan(std::numbers::pi / 8);
  std::string old = entity("POLYLINE", {{66, 1}, {70, 1}});
  old += entity("VERTEX", {{10, 0}, {20, 0}}) +
         entity("VERTEX", {{10, 40}, {20, 0}, {42, quarter}}) +
         entity("VERTEX", {{10, 0}, {20, 40}});
  const Region fan = plate("part.dxf", dxf(old + entity("SEQEND", {})));
  EXPECT_NEAR(area(fan), 0.25 * std::numbers::pi * 16e-4,
              0.5 * std::numbers::pi * 40e-3 * 40e-3 * kDrawingTolerance);
  const Region chain =
      plate("part.dxf", dxf(line(40, 0, 0, 0) + arc(0, 0, 40, 0, 90) + line(0, 0, 0, 40)));
  EXPECT_NEAR(area(chain), 0.25 * std::numbers::pi * 16e-4,
              0.5 * std::numbers::pi * 40e-3 * 40e-3 * kDrawingTolerance);
}

TEST_F(Drawings, EllipsesHaveTheirArea) {
  const std::string ellipse = entity("ELLIPSE", {{10, 40},
                                                 {20, 25},
                                                 {30, 0},
                                                 {11, 6},
                                                 {21, 8},
                                                 {31, 0},
                                                 {40, 0.5},
                                                 {41, 0},
                                                 {42, 2 * std::numbers::pi}});
  const Region r = plate("part.dxf", dxf(kFrame + ellipse));
  EXPECT_NEAR(area(r), 4e-3 - std::numbers::pi * 50e-6, 60e-3 * 80e-3 * kDrawingTolerance);
}

// Four rational quadratic splines form a circle; here it is one SPLINE of nine points.
TEST_F(Drawings, SplinesOfACircleHaveItsArea) {
  const double r = 20, w = std::sqrt(0.5);
  const Vec2 corners[] = {{1, 0}, {1, 1}, {0, 1}, {-1, 1}, {-1, 0}, {-1, -1}, {0, -1}, {1, -1}};
  std::vector<std::pair<int, double>> codes = {{70, 4}, {71, 2}, {72, 12}, {73, 9}, {74, 0}};
  for (const double knot : {0, 0, 0, 1, 1, 2, 2, 3, 3, 4, 4, 4}) codes.emplace_back(40, knot);
  for (int k = 0; k < 9; ++k) codes.emplace_back(41, k % 2 == 0 ? 1 : w);
  for (int k = 0; k < 9; ++k) {
    codes.emplace_back(10, 40 + r * corners[k % 8].x());
    codes.emplace_back(20, 25 + r * corners[k % 8].y());
    codes.emplace_back(30, 0);
  }
  const auto rings =
      read_drawing(scratch_.write("part.dxf", dxf(entity("SPLINE", codes))), {}).rings;
  ASSERT_EQ(rings.size(), 1u);
  for (const Vec2& p : rings[0]) EXPECT_NEAR((p - Vec2(0.04, 0.025)).norm(), 0.02, 1e-6 * 0.02);
  EXPECT_NEAR(area(region_of(rings)), std::numbers::pi * 4e-4,
              2 * std::numbers::pi * 20e-3 * 40e-3 * kDrawingTolerance);
  codes.erase(codes.begin() + 5);  // removes a knot
  EXPECT_TRUE(refused("part.dxf", dxf(entity("SPLINE", codes)), {"SPLINE", "knots"}));
}

// A straight line as a spline of degree one can be joined with others.
TEST_F(Drawings, SplinesCloseChains) {
  const std::string side = entity("SPLINE", {{70, 8},
                                             {71, 1},
                                             {72, 4},
                                             {73, 2},
                                             {74, 0},
                                             {40, 0},
                                             {40, 0},
                                             {40, 1},
                                             {40, 1},
                                             {10, 80},
                                             {20, 0},
                                             {30, 0},
                                             {10, 80},
                                             {20, 50},
                                             {30, 0}});
  expect_plate(plate("part.dxf", dxf(line(0, 0, 80, 0) + side + line(0, 50, 0, 0) +
                                     line(0, 50, 80, 50) + kHoles)));
}

TEST_F(Drawings, LayersAndBlocksThatAreNotMeantStayOut) {
  const std::string all = kFrame + circle(20, 25, 5, "HOLES") + circle(50, 25, 8, "HOLES") +
                          circle(0, 0, 30, "MARKS") + entity("TEXT", {{10, 1}, {20, 1}, {40, 2}});
  expect_plate(plate("part.dxf", dxf(all), {{}, {"0", "HOLES"}}));
  EXPECT_TRUE(contains(complaint("part.dxf", dxf(all)), "hole"));
  EXPECT_TRUE(refused("part.dxf", dxf(all), {"layer", "'HOLE'"}, {{}, {"0", "HOLE"}}));
  const std::string block =
      "0\nSECTION\n2\nBLOCKS\n0\nBLOCK\n8\n0\n2\nbolt\n70\n0\n10\n0\n20\n0\n" + circle(0, 0, 100) +
      "0\nENDBLK\n8\n0\n0\nENDSEC\n";
  expect_plate(plate("part.dxf", block + dxf(kFrame + kHoles)));
}

TEST_F(Drawings, SvgHasPathsAndShapes) {
  const std::string head =
      "<?xml version=\"1.0\"?>\n<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"80mm\" "
      "height=\"50mm\" viewBox=\"10 20 160 100\">";
  // There are two units to a millimetre; y points downwards.
  const std::string shapes =
      head + R"svg(<defs><rect width="1" height="1"/></defs><title>plate</title>
<rect x="10" y="20" width="160" height="100"/><g transform="translate(10 20)">
<circle cx="100" cy="50" r="16"/><g transform="scale(2) rotate(90, 20, 25)">
<ellipse cx="20" cy="25" rx="5" ry="5"/></g></g></svg>)svg";
  expect_plate(plate("part.svg", shapes));
  const std::string paths = head + R"svg(<polygon points="10,20 170,20 170,120 10,120"/>
<path transform="matrix(2 0 0 2 10 20)" d="M 45 25 m -3 0 a 8 8 0 1 0 16 0 a 8 8 0 1 0 -16 0 z
 M 15,25 A 5 5 0 0 1 25 25 A 5,5,0,0,1,15,25"/></svg>)svg";
  expect_plate(plate("part.svg", paths));
  // A parabola (quadratic Bezier curve) of height 10 over 40 encloses 2/3 of the rectangle.
  const std::string curve = head + R"svg(<path d="M 20 60 q 40 -40 80 0 z"/></svg>)svg";
  EXPECT_NEAR(area(plate("part.svg", curve)), 2. / 3 * 40e-3 * 10e-3, 45e-3 * 40e-3 * 1e-5);
  // Without a unit, or in px.
  for (const std::string size : {"", "width=\"160\" height=\"100\"", "width=\"100%\""}) {
    std::string bare = paths;
    bare.replace(bare.find("width=\"80mm\" height=\"50mm\""), 26, size);
    EXPECT_TRUE(refused("part.svg", bare, {"`unit`"}));
    expect_plate(plate("part.svg", bare, {0.5e-3, {}}));
  }
}

struct Bad {
  const char* name;
  std::string file, text;
  std::vector<std::string> parts;
  bool of_file = true;  // false if the rings are refused, which have no file
};
void PrintTo(const Bad& bad, std::ostream* out) { *out << bad.name; }
class DrawingRefused : public Drawings, public ::testing::WithParamInterface<Bad> {};
TEST_P(DrawingRefused, AndSaysWhy) {
  const Bad& bad = GetParam();
  EXPECT_TRUE(says(complaint(bad.file, bad.text), bad.of_file ? scratch_ / (bad.file + ": ") : "",
                   bad.parts));
}
const std::string kSvg = "<svg width=\"1mm\" viewBox=\"0 0 1 1\">";
INSTANTIATE_TEST_SUITE_P(
    Table, DrawingRefused,
    ::testing::Values(
        Bad{"open", "a.dxf", dxf(line(0, 0, 1, 0) + line(1, 0, 1, 1)), {"open", "(1, 1)"}},
        Bad{"three_ends",
            "a.dxf",
            dxf(kFrame + line(80, 0, 9, 9) + line(9, 9, 0, 0)),
            {"meet", "(0, 0)"}},
        Bad{"crossing", "a.dxf", dxf(kFrame + circle(0, 0, 20)), {"cross", "hole"}, false},
        Bad{"apart", "a.dxf", dxf(circle(0, 0, 20) + circle(50, 0, 5)), {"hole"}, false},
        Bad{"nested",
            "a.dxf",
            dxf(kFrame + circle(40, 25, 20) + circle(40, 25, 10)),
            {"hole"},
            false},
        Bad{"itself",
            "a.dxf",
            dxf(line(0, 0, 1, 1) + line(1, 1, 1, 0) + line(1, 0, 0, 1) + line(0, 1, 0, 0)),
            {"itself", "(0.0"},
            false},
        Bad{"no_curve", "a.dxf", dxf(""), {"no closed"}},
        Bad{"a_point", "a.dxf", dxf(circle(1, 1, 0)), {"no closed", "1 curve", "(1, 1)"}},
        Bad{"no_area",
            "a.dxf",
            dxf(entity("LWPOLYLINE", {{90, 2}, {70, 1}, {10, 0}, {20, 0}, {10, 1}, {20, 0}})),
            {"(0, 0)", "area"}},
        Bad{"insert", "a.dxf", dxf(pair(0, "INSERT") + pair(8, "0") + pair(2, "bolt")), {"INSERT"}},
        Bad{"no_dxf", "a.dxf", "hello", {"DXF"}}, Bad{"empty", "a.dxf", "", {"DXF"}},
        Bad{"far", "a.dxf", dxf(circle(1e33, 0, 1)), {"finite", "1e30"}},
        Bad{"other", "a.step", "ISO-10303-21;", {".dxf", ".svg"}},
        Bad{"no_xml", "a.svg", "<svg><path", {"XML"}}, Bad{"no_svg", "a.svg", "<html/>", {"SVG"}},
        Bad{"nothing", "a.svg", kSvg + "</svg>", {"no closed"}},
        Bad{"open_path", "a.svg", kSvg + "<path d='M 0 0 L 1 0 L 1 1'/></svg>", {"open"}},
        Bad{"bad_path", "a.svg", kSvg + "<path d='M 0 0 K 1 0'/></svg>", {"path"}},
        Bad{"bad_number", "a.svg", kSvg + "<polygon points='0 0 1 x'/></svg>", {"'x'", "number"}},
        Bad{"bad_turn",
            "a.svg",
            kSvg + "<g transform='turn(3)'></g></svg>",
            {"transform", "'turn'"}},
        Bad{"use", "a.svg", kSvg + "<use href='#a'/></svg>", {"use", "copies"}},
        Bad{"percent",
            "a.svg",
            kSvg + "<rect width='50%' height='1'/></svg>",
            {"rect", "width", "'50%'"}},
        Bad{"box", "a.svg", "<svg viewBox='0 0 1'/>", {"viewBox", "'0 0 1'"}}),
    [](const auto& test) { return test.param.name; });

TEST_F(Drawings, AreRegularFiles) {
  try {
    read_drawing(scratch_ / "none.dxf", {});
    FAIL();
  } catch (const Error& error) {
    EXPECT_TRUE(says(error.what(), scratch_ / "none.dxf: ", {"cannot"}));
  }
  ASSERT_EQ(mkfifo((scratch_ / "pipe.dxf").c_str(), 0600), 0);
  EXPECT_THROW(read_drawing(scratch_ / "pipe.dxf", {}), Error);
}

// Entities that reference each other recursively are valid XML and must not be expanded.
TEST_F(Drawings, DoNotGrowWhenTheyAreRead) {
  std::string text = "<!DOCTYPE svg [<!ENTITY a0 \"1 1 \">";
  for (int k = 1; k < 30; ++k)
    text += "<!ENTITY a" + std::to_string(k) + " \"&a" + std::to_string(k - 1) + ";&a" +
            std::to_string(k - 1) + ";\">";
  text += "]><svg width=\"1mm\"><polygon points=\"&a29;\"/></svg>";
  EXPECT_NE(complaint("bomb.svg", text), "");
}

}  // namespace
}  // namespace flexmorph::io
