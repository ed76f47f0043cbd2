// Shows that plots and drawings are well-formed XML with points where the data are and gaps where
// there are none.
#include "io/plots.h"

#include <gtest/gtest.h>
#include <vtkSmartPointer.h>
#include <vtkXMLDataElement.h>
#include <vtkXMLUtilities.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <sstream>

#include "io/plane_frames.h"
#include "io/surfaces.h"
#include "tests/io/scratch.h"

namespace flexmorph::io {
namespace {

/// Returns the root of the parsed text, or null if it is not well formed.
vtkSmartPointer<vtkXMLDataElement> parse(const std::string& text) {
  return vtkSmartPointer<vtkXMLDataElement>::Take(
      vtkXMLUtilities::ReadElementFromString(text.c_str()));
}

/// Returns the attributes `d` of all paths, in the order of the file.
std::vector<std::string> paths(const std::string& svg) {
  std::vector<std::string> found;
  for (size_t at = 0; (at = svg.find(" d=\"", at)) != std::string::npos;) {
    at += 4;
    found.push_back(svg.substr(at, svg.find('"', at) - at));
  }
  return found;
}

Figure figure_of(Panel panel) { return {.title = "a < b & c", .panels = {std::move(panel)}}; }

TEST(Plot, IsWellFormedAndComplete) {
  Panel panel{.title = "\"Tip\"", .x = {"time [s]"}, .y = {"deflection [m]"}};
  panel.curves = {
      {.name = "one", .x = {0, 1}, .y = {0, 1}},
      {.name = "two & more", .x = {0, 1}, .y = {1, 0}, .markers = true, .dashed = true}};
  Figure figure = figure_of(panel);
  figure.panels.push_back(panel);
  const CommaLocale comma;
  const std::string svg = plot_svg(figure);
  const auto root = parse(svg);
  ASSERT_NE(root, nullptr);
  EXPECT_STREQ(root->GetName(), "svg");
  for (const char* word : {"a &lt; b &amp; c", "time [s]", "deflection [m]", "two &amp; more"})
    EXPECT_TRUE(contains(svg, word));
  EXPECT_FALSE(contains(svg, "id="));  // several figures share a page
}

// A long legend makes the page higher and not the diagram smaller, and its curves can be told
// apart.
TEST(Plot, OfManyCurvesIsAsHighAsOfOne) {
  const auto svg_of = [](int n) {
    Panel panel;
    for (int i = 0; i < n; ++i)
      panel.curves.push_back(
          {.name = "max_volume = " + std::to_string(i), .x = {0, 1}, .y = {0, 1}});
    Figure figure = figure_of(panel);
    figure.width = 560;
    return plot_svg(figure);
  };
  const auto frame_height = [](const std::string& svg) {
    const size_t at = svg.find("height=\"", svg.rfind("<rect"));
    return std::stod(svg.substr(at + 8));
  };
  const std::string many = svg_of(24);
  EXPECT_GT(frame_height(many), 150);
  EXPECT_GE(frame_height(many), frame_height(svg_of(7)));
  std::set<std::string> styles;
  for (size_t at = 0; (at = many.find("h26\"", at)) != std::string::npos; ++at)
    styles.insert(many.substr(at, many.find("/>", at) - at));
  EXPECT_EQ(styles.size(), 24U);
}

TEST(Plot, NonFinitePointsLeaveGaps) {
  Panel panel;
  panel.curves = {{.x = {0, 1, 2, 3, 4, 5},
                   .y = {1, 2, std::nan(""), 3, std::numeric_limits<double>::infinity(), 2}}};
  const auto drawn = paths(plot_svg(figure_of(panel)));
  ASSERT_EQ(drawn.size(), 1u);
  EXPECT_EQ(std::count(drawn[0].begin(), drawn[0].end(), 'M'), 3);
  EXPECT_EQ(std::count(drawn[0].begin(), drawn[0].end(), 'L'), 1);
  EXPECT_FALSE(contains(plot_svg(figure_of(panel)), "nan"));
}

// A power law is a straight line on logarithmic axes; values without a logarithm are gaps.
TEST(Plot, LogarithmicAxes) {
  Panel panel{.x = {"h", true}, .y = {"error", true}};
  panel.curves = {{.x = {1e-3, 1e-2, 1e-1, 1, 10}, .y = {1e-6, 1e-4, 1e-2, 0, -1}}};
  const auto drawn = paths(plot_svg(figure_of(panel)));
  ASSERT_EQ(drawn.size(), 1u);
  std::string points = drawn[0];
  std::replace_if(
      points.begin(), points.end(), [](char c) { return c == 'M' || c == 'L'; }, ' ');
  std::istringstream in(points);
  std::vector<double> p;
  for (double value; in >> value;) p.push_back(value);
  ASSERT_EQ(p.size(), 6u);
  // Tolerance: pixels are written to 0.01.
  EXPECT_NEAR(p[2] - p[0], p[4] - p[2], 0.03);
  EXPECT_NEAR(p[3] - p[1], p[5] - p[3], 0.03);
  EXPECT_GT(p[2], p[0]);
  EXPECT_LT(p[3], p[1]);  // y points up
}

TEST(Plot, EmptyAndConstantDataStillMakeAPicture) {
  Panel constant;
  constant.curves = {{.x = {1}, .y = {3e7}}, {.x = {1, 2}, .y = {3e7, 3e7}}};
  for (const Panel& panel : {Panel{}, constant, Panel{.x = {"x", true}, .y = {"y", true}}}) {
    const std::string svg = plot_svg(figure_of(panel));
    EXPECT_NE(parse(svg), nullptr);
    EXPECT_FALSE(contains(svg, "nan"));
    EXPECT_FALSE(contains(svg, "inf"));
  }
}

TEST(Ticks, AreRoundInsideAndEven) {
  for (const auto& [lower, upper] :
       {std::pair{0.0, 1.0}, {-3.7e-4, 5.2e-4}, {1e7, 3.1e7}, {299.0, 301.0}, {-1e-12, 1e-12}}) {
    const std::vector<double> ticks = nice_ticks(lower, upper, 6);
    ASSERT_GE(ticks.size(), 3u);
    EXPECT_LE(ticks.size(), 11u);
    const double step = ticks[1] - ticks[0],
                 digit = step / std::pow(10, std::floor(std::log10(step)));
    const double nearest = std::round(digit * 10) / 10;
    EXPECT_NEAR(digit, nearest, 1e-6);
    EXPECT_TRUE(nearest == 1 || nearest == 2 || nearest == 5 || nearest == 10) << nearest;
    EXPECT_GE(ticks.front(), lower - 1e-9 * step);
    EXPECT_LE(ticks.back(), upper + 1e-9 * step);
  }
  EXPECT_EQ(nice_ticks(0, 1, 5), (std::vector<double>{0, 0.2, 0.4, 3 * 0.2, 0.8, 1}));
}

TEST(Drawing, IsInMetresAndYUp) {
  const Region region{{{0, -0.05}, {0.6, -0.05}, {0.6, 0.05}}, {{{0.4, 0}, {0.4, 0.01}, {0.5, 0}}}};
  const std::string svg = outline_svg(std::vector<Region>{region}, {{0, -0.05}, {0.6, 0.05}});
  ASSERT_NE(parse(svg), nullptr);
  EXPECT_TRUE(contains(svg, "width=\"600mm\" height=\"100mm\""));
  EXPECT_TRUE(contains(svg, "viewBox=\"0 -0.05 0.6 0.1\""));
  EXPECT_TRUE(contains(svg, "matrix(1 0 0 -1 0 0)"));  // the middle stays at its position
  EXPECT_TRUE(contains(svg, "fill-rule=\"evenodd\""));
  EXPECT_EQ(paths(svg).at(0), "M0 -0.05L0.6 -0.05L0.6 0.05ZM0.4 0L0.4 0.01L0.5 0Z");
}

/// Returns a horizontal unit square at the height z.
SurfaceFrame square(double z, double value) {
  return {"square", {3, {0, 0, z, 1, 0, z, 1, 1, z, 0, 1, z}, {{0, 1, 2, 3}}}, {value}};
}

TEST(Surfaces, WhatIsNearerIsDrawnLater) {
  // Two squares are in one frame, the upper one first: seen from above, it must be drawn last.
  SurfaceFrame both = square(0.5, 4);
  const SurfaceFrame lower = square(0, 0);
  both.mesh.points.insert(both.mesh.points.end(), lower.mesh.points.begin(),
                          lower.mesh.points.end());
  both.mesh.quads.push_back({4, 5, 6, 7});
  both.values.push_back(0);
  const std::string svg = surfaces_svg("two", {both});
  ASSERT_NE(parse(svg), nullptr);
  // colours of the largest value and of zero
  const size_t light = svg.find("#fff0aa"), dark = svg.find("#264696");
  ASSERT_NE(light, std::string::npos);
  ASSERT_NE(dark, std::string::npos);
  EXPECT_LT(dark, light);
  EXPECT_THROW(surfaces_svg("none", {}), Error);
  EXPECT_THROW(surfaces_svg("plane", {{"flat", {2, {0, 0, 1, 0, 1, 1, 0, 1}, {}}, {}}}), Error);
}

/// Returns a sheared plate of 6 x 4 cells whose densities are multiples of 1/8.
PlanePlate sheared_plate() {
  PlanePlate plate;
  plate.n_across = 4;
  for (int i = 0; i <= 6; ++i)
    for (int j = 0; j <= 4; ++j) plate.points.insert(plate.points.end(), {i + 0.5 * j, 1.0 * j});
  for (int k = 0; k < 24; ++k) plate.density.push_back((k * 5 / 3 % 9) / 8.0);
  return plate;
}

/// Returns the area of all rings of a path of straight lines.
double area(std::string path) {
  double sum = 0;
  for (char& c : path)
    if (c == 'L') c = ' ';
  for (size_t from = 0; (from = path.find('M', from)) != std::string::npos; ++from) {
    std::istringstream in(path.substr(from + 1, path.find('Z', from) - from - 1));
    in.imbue(std::locale::classic());
    std::vector<Vec2> ring;
    for (double x, y; in >> x >> y;) ring.emplace_back(x, y);
    double twice = 0;
    for (size_t k = 0; k < ring.size(); ++k) {
      const Vec2 &a = ring[k], &b = ring[(k + 1) % ring.size()];
      twice += a.x() * b.y() - a.y() * b.x();
    }
    sum += 0.5 * std::abs(twice);
  }
  return sum;
}

// The areas of all grey levels, weighted by their greys, must add up to the material of the plate.
TEST(PlaneFrames, GreysKeepTheMaterial) {
  const PlanePlate plate = sheared_plate();
  double material = 0;
  for (const double each : plate.density) material += each;
  const CommaLocale comma;
  const std::string svg = plane_frames_svg("one", {{"t = 0 s", {plate}, {}}}, 1);
  ASSERT_NE(parse(svg), nullptr);
  const double scale = 940.0 / 8;  // eight metres wide, margins of 30
  double drawn = 0;
  for (size_t at = 0; (at = svg.find("fill=\"rgb(", at)) != std::string::npos; ++at) {
    const double grey = std::stoi(svg.substr(at + 10, 3));
    const size_t d = svg.rfind("d=\"", at) + 3;
    drawn += (255 - grey) / 210 * area(svg.substr(d, svg.find('"', d) - d));
  }
  EXPECT_NEAR(drawn / (scale * scale), material, 0.01 * material);  // greys are whole numbers
}

TEST(PlaneFrames, ShareOneViewAndOneScale) {
  const std::vector<Vec2> unit = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
  std::vector<Vec2> moved = unit;
  for (Vec2& p : moved) p += Vec2(3, 1);
  const std::string svg =
      plane_frames_svg("two", {{"t = 0 s", {}, {unit}}, {"t = 1 s", {}, {moved}}});
  const auto drawn = paths(svg);  // an outline and a scale bar for each frame
  ASSERT_EQ(drawn.size(), 4u);
  // 4 m on 940 units are 235 per metre; y points down, and the height is 2 m.
  EXPECT_EQ(drawn[0], "M30 500L265 500L265 265L30 265Z");
  EXPECT_EQ(drawn[2], "M735 265L970 265L970 30L735 30Z");
  EXPECT_EQ(drawn[1], drawn[3]);
  EXPECT_TRUE(drawn[1].ends_with("H147.5v-4v8")) << drawn[1];  // half a metre
  EXPECT_TRUE(contains(svg, "0.5 m"));
}

TEST(PlaneFrames, OfMeshesThatDoNotFitAreRefused) {
  EXPECT_THROW(plane_frames_svg("none", {}), Error);
  EXPECT_THROW(plane_frames_svg("empty", {PlaneFrame{}}), Error);
  PlanePlate plate = sheared_plate();
  plate.density.pop_back();
  EXPECT_THROW(plane_frames_svg("short", {{"", {plate}, {}}}), Error);
  plate.density.push_back(std::nan(""));
  EXPECT_THROW(plane_frames_svg("nan", {{"", {plate}, {}}}), Error);
  plate = sheared_plate();
  plate.points[3] = INFINITY;
  EXPECT_THROW(plane_frames_svg("far", {{"", {plate}, {}}}), Error);
}

// With fewer digits the picture of a design is shorter.
TEST(Outline, HasFewerDigitsWhereAsked) {
  const double third = 1.0 / 3;
  const Region region{{{0, 0}, {third, 0}, {third, third}}, {}};
  const Box frame{{0, 0}, {1, 1}};
  EXPECT_TRUE(contains(outline_svg({&region, 1}, frame, 5), "M0 0L0.33333 0L0.33333 0.33333Z"));
  EXPECT_TRUE(contains(outline_svg({&region, 1}, frame), "L0.3333333333333333 0"));
}

}  // namespace
}  // namespace flexmorph::io
