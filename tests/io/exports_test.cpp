// Designs for other programs, read back by readers written here: polylines enclose the area of the
// regions, the extruded surface is closed and encloses area times thickness; components survive the
// way through their file bit for bit, and bad files are refused with their place.
#include "io/exports.h"

#include <gtest/gtest.h>

#include <BRepCheck_Analyzer.hxx>
#include <BRepGProp.hxx>
#include <Eigen/Geometry>
#include <GProp_GProps.hxx>
#include <STEPControl_Reader.hxx>
#include <TopExp_Explorer.hxx>
#include <array>
#include <cmath>
#include <fstream>
#include <map>
#include <sstream>
#include <tuple>

#include "io/drawing.h"
#include "io/plots.h"
#include "io/step.h"
#include "tests/io/scratch.h"

namespace flexmorph::io {
namespace {

/// Crossing bars in a frame, clipped: several holes, curved sides.
std::vector<Region> design() {
  std::vector<std::vector<Vec2>> outlines;
  for (const Component& c : crossing_layout(0, 0, 0.6, 0.1, 6, 1, 0.008, 0.07))
    outlines.push_back(outline_within(c, 0.004, 1e-5));
  outlines.push_back({{0, 0}, {0.6, 0}, {0.6, 0.01}, {0, 0.01}});
  return unite(outlines, {{0, 0}, {0.6, 0.1}});
}

double ring_area(const std::vector<Vec2>& ring) {
  double twice = 0;
  for (std::size_t k = 0; k < ring.size(); ++k) {
    const Vec2 &a = ring[k], &b = ring[(k + 1) % ring.size()];
    twice += a.x() * b.y() - b.x() * a.y();
  }
  return 0.5 * std::abs(twice);
}

TEST(Dxf, ClosedPolylinesEncloseTheArea) {
  const Scratch scratch;
  const std::vector<Region> regions = design();
  write_dxf(scratch / "design.dxf", regions, kMetre);
  std::istringstream in(contents_of(scratch / "design.dxf"));
  // Pairs of lines: group code, value.
  std::map<std::string, double> area_of_layer;
  std::vector<Vec2> ring;
  std::string code, value, entity, layer;
  int closed = 0, polylines = 0;
  while (std::getline(in, code) && std::getline(in, value)) {
    const int group = std::stoi(code);
    if (group == 0) {
      if (value == "SEQEND") area_of_layer[layer] += ring_area(ring);
      if (value == "POLYLINE") ++polylines, ring.clear();
      if (value == "VERTEX") ring.emplace_back(0, 0);
      entity = value;
    } else if (group == 8) {
      layer = value;
    } else if (group == 70 && entity == "POLYLINE") {
      closed += std::stoi(value) & 1;
    } else if (entity == "VERTEX" && group == 10) {
      ring.back().x() = std::stod(value);
    } else if (entity == "VERTEX" && group == 20) {
      ring.back().y() = std::stod(value);
    }
  }
  EXPECT_EQ(value, "EOF");
  EXPECT_EQ(closed, polylines);
  EXPECT_GT(area_of_layer["HOLES"], 0);
  EXPECT_NEAR(area_of_layer["OUTLINE"] - area_of_layer["HOLES"], area(regions), 1e-14);
}

// Rings of the path by the even-odd rule: outer ones run against holes, so that signed areas add
// up.
TEST(Svg, PathEnclosesTheArea) {
  const std::vector<Region> regions = design();
  const std::string svg = outline_svg(regions, {{0, 0}, {0.6, 0.1}});
  const std::size_t begin = svg.find(" d=\"") + 4;
  std::istringstream path(svg.substr(begin, svg.find('"', begin) - begin));
  double area_of_path = 0;
  std::vector<Vec2> ring;
  int rings = 0;
  for (char command = 0; path >> command;) {
    if (command == 'Z') {
      double twice = 0;
      for (std::size_t k = 0; k < ring.size(); ++k) {
        const Vec2 &a = ring[k], &b = ring[(k + 1) % ring.size()];
        twice += a.x() * b.y() - b.x() * a.y();
      }
      area_of_path += 0.5 * twice;
      ring.clear();
      ++rings;
      continue;
    }
    ASSERT_TRUE(command == 'M' || command == 'L') << command;
    Vec2 p;
    ASSERT_TRUE(path >> p.x() >> p.y());
    ring.push_back(p);
  }
  EXPECT_GT(rings, 2);
  EXPECT_NE(svg.find("fill-rule=\"evenodd\""), std::string::npos);
  EXPECT_NEAR(area_of_path, area(regions), 1e-14);
}

TEST(Stl, IsWatertightAndHasTheVolume) {
  const Scratch scratch;
  const std::vector<Region> regions = design();
  const double thickness = 0.013;
  write_stl(scratch / "design.stl", regions, thickness, kMetre);
  std::istringstream in(contents_of(scratch / "design.stl"));
  using Key = std::array<double, 3>;
  std::map<std::pair<Key, Key>, int> edges;
  std::vector<Key> loop;
  double volume = 0;
  for (std::string word; in >> word;) {
    if (word != "vertex") continue;
    Key p{};
    in >> p[0] >> p[1] >> p[2];
    loop.push_back(p);
    if (loop.size() < 3) continue;
    const auto vec = [](const Key& k) { return Vec3(k[0], k[1], k[2]); };
    volume += vec(loop[0]).dot(vec(loop[1]).cross(vec(loop[2]))) / 6;
    for (std::size_t k = 0; k < 3; ++k) ++edges[{loop[k], loop[(k + 1) % 3]}];
    loop.clear();
  }
  ASSERT_GT(edges.size(), 100u);
  for (const auto& [edge, count] : edges) {
    EXPECT_EQ(count, 1);  // once in each direction: twice in all, and facets turn the same way
    EXPECT_EQ(edges.count({edge.second, edge.first}), 1u);
  }
  EXPECT_NEAR(volume, area(regions) * thickness, 1e-9 * volume);
}

// The unit is in the file, and the numbers are in it.
TEST(Units, OfDxfAndStlAreSaid) {
  const Scratch scratch;
  const std::vector<Region> plate = {{corners_of({{0, 0}, {0.254, 0.0508}}), {}}};
  for (const auto& [unit, code, metric, x] :
       {std::tuple(kMillimetre, "4", "1", "254"), std::tuple(kInch, "1", "0", "10"),
        std::tuple(kMetre, "6", "1", "0.254")}) {
    write_dxf(scratch / "a.dxf", plate, unit,
              std::vector<DrawingLayer>{{"MARKS", {{{0.0254, 0}}}}});
    const std::string dxf = contents_of(scratch / "a.dxf");
    EXPECT_TRUE(contains(dxf, std::string("9\n$INSUNITS\n70\n") + code + "\n"));
    EXPECT_TRUE(contains(dxf, std::string("9\n$MEASUREMENT\n70\n") + metric + "\n"));
    EXPECT_TRUE(contains(dxf, std::string("10\n") + x + "\n"));
    EXPECT_TRUE(contains(dxf, "0\nPOINT\n8\nMARKS\n10\n"));
    write_stl(scratch / "a.stl", plate, 0.01, unit);
    const std::string stl = contents_of(scratch / "a.stl");
    EXPECT_TRUE(stl.starts_with(std::string("solid design in ") + unit.name + "\n"));
    EXPECT_TRUE(contains(stl, std::string("vertex ") + x + " "));
  }
}

// Its own drawing is a domain again, to the rounding of the unit.
TEST(Dxf, IsADomainAgain) {
  const Scratch scratch;
  const std::vector<Region> regions = design();
  const auto largest =
      std::max_element(regions.begin(), regions.end(),
                       [](const auto& a, const auto& b) { return area(a) < area(b); });
  const std::vector<DrawingLayer> more = {{"DOMAIN", {corners_of({{0, 0}, {0.6, 0.1}})}},
                                          {"LOADS", {{{0.6, 0.05}}, {{0, 0}, {0, 0.1}}}}};
  for (const LengthUnit& unit : kLengthUnits) {
    write_dxf(scratch / "design.dxf", {&*largest, 1}, unit, more);
    const Region back = region_of(read_drawing(scratch / "design.dxf", {{}, {"OUTLINE", "HOLES"}}));
    EXPECT_EQ(back.holes.size(), largest->holes.size());
    // Vertices nearer than a tenth of the tolerance are one.
    const double near = 0.1 * kDrawingTolerance * 0.6;
    EXPECT_NEAR(area(back), area(*largest), near * 10) << unit.name;
    EXPECT_NEAR((bounds_of(back.outer).upper - bounds_of(largest->outer).upper).norm(), 0, near);
  }
}

/// A STEP file as OpenCASCADE reads it, in millimetres.
TopoDS_Shape step_shape(const std::string& path) {
  STEPControl_Reader reader;
  EXPECT_EQ(reader.ReadFile(path.c_str()), IFSelect_RetDone);
  reader.TransferRoots();
  return reader.OneShape();
}
int count(const TopoDS_Shape& shape, TopAbs_ShapeEnum kind) {
  int n = 0;
  for (TopExp_Explorer e(shape, kind); e.More(); e.Next()) ++n;
  return n;
}

TEST(Step, IsASolidOfTheVolumeAndHasItsFaces) {
  const Scratch scratch;
  std::vector<Region> regions = design();
  regions.push_back({corners_of({{1, 0}, {1.1, 0.1}}), {}});
  const double thickness = 0.013;
  int faces = 0;
  for (const Region& r : regions) {
    faces += 2;
    for (const auto& ring : rings_of(r)) faces += static_cast<int>(ring.size());
  }
  EXPECT_EQ(write_step(scratch / "design.step", regions, thickness), "");
  const TopoDS_Shape shape = step_shape(scratch / "design.step");
  EXPECT_TRUE(BRepCheck_Analyzer(shape).IsValid());
  EXPECT_EQ(count(shape, TopAbs_SOLID), static_cast<int>(regions.size()));
  EXPECT_EQ(count(shape, TopAbs_FACE), faces);
  GProp_GProps properties;
  BRepGProp::VolumeProperties(shape, properties);
  const double volume = area(regions) * thickness;
  EXPECT_NEAR(1e-9 * properties.Mass(), volume, 1e-9 * volume);
}

// The same design is the same file; the numbers in it are millimetres.
TEST(Step, IsRepeatableAndInMillimetres) {
  const Scratch scratch;
  const std::vector<Region> plate = {{corners_of({{0, 0}, {0.254, 0.0508}}), {}}};
  write_step(scratch / "a.step", plate, 0.01);
  write_step(scratch / "b.step", plate, 0.01);
  const std::string text = contents_of(scratch / "a.step");
  EXPECT_TRUE(text == contents_of(scratch / "b.step"));
  EXPECT_TRUE(contains(text, "CARTESIAN_POINT('',(254.,50.8,0.))"));
  EXPECT_TRUE(contains(text, "SI_UNIT(.MILLI.,.METRE.)"));
  EXPECT_TRUE(text.ends_with("END-ISO-10303-21;\n"));
  write_step(scratch / "none.step", {}, 0.01);  // nothing was left of a design
  EXPECT_TRUE(contains(contents_of(scratch / "none.step"), "END-ISO-10303-21;"));
}

TEST(ComponentsCsv, ReadsBackBitForBit) {
  const Scratch scratch;
  std::vector<Component> all = crossing_layout(0, -0.05, 0.6, 0.1, 3, 2, 0.1 / 3, 1.0 / 7);
  all[1].c2 = 1e-300;
  write_components_csv(scratch / "components.csv", all);
  const std::vector<Component> back = read_components_csv(scratch / "components.csv");
  ASSERT_EQ(back.size(), all.size());
  for (std::size_t k = 0; k < all.size(); ++k) EXPECT_EQ(back[k].parameters(), all[k].parameters());
}

TEST(ComponentsCsv, RefusesBadFilesWithTheirPlace) {
  const Scratch scratch;
  const std::string header = "X0,Y0,half_length,angle,c1,c2,c3\n";
  const auto complaint = [&](const std::string& text) -> std::string {
    std::ofstream(scratch / "bad.csv") << text;
    try {
      read_components_csv(scratch / "bad.csv");
    } catch (const Error& e) {
      return e.what();
    }
    return "";
  };
  EXPECT_NE(complaint("x,y\n").find("bad.csv:1: the header"), std::string::npos);
  EXPECT_NE(complaint(header + "0,0,1,0,1,1,1\n0,0,1,0,1,x,1\n").find("bad.csv:3: c2 = 'x'"),
            std::string::npos);
  EXPECT_NE(complaint(header + "0,0,-1,0,1,1,1\n").find("half_length = -1"), std::string::npos);
  EXPECT_NE(complaint(header + "0,0,1,0,1,1\n").find("6 values"), std::string::npos);
  EXPECT_NE(complaint(header + "0,0,1,0,1,1,nan\n").find("c3 = 'nan'"), std::string::npos);
  EXPECT_NE(complaint(header), "");
  EXPECT_THROW(read_components_csv(scratch / "none.csv"), Error);
}

}  // namespace
}  // namespace flexmorph::io
