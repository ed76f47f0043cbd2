// Shows that exported designs are right when they are read back by readers written here: polylines
// and circles enclose the area of the curves, the extruded surface is closed and encloses area
// times thickness, components are read back bit for bit, and invalid files are refused with the
// location of the error.
#include "io/drawings/exports.h"

#include <gtest/gtest.h>

#include <BRepAdaptor_Surface.hxx>
#include <BRepCheck_Analyzer.hxx>
#include <BRepGProp.hxx>
#include <Eigen/Geometry>
#include <GProp_GProps.hxx>
#include <STEPControl_Reader.hxx>
#include <TopExp_Explorer.hxx>
#include <TopoDS.hxx>
#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <map>
#include <numbers>
#include <span>
#include <sstream>
#include <tuple>

#include "io/drawings/drawing.h"
#include "io/drawings/step.h"
#include "io/plots.h"
#include "tests/io/scratch.h"

namespace flexmorph::io {
namespace {

constexpr double kTolerance = 2e-5;  // tolerance of curves; polygons have half of it
constexpr double kBore = 0.004;

/// Returns crossing bars in a frame, clipped, with an eye and two bores: several holes, curved
/// sides.
std::vector<Region> design() {
  std::vector<std::vector<Vec2>> outlines;
  for (const Component& c : crossing_layout(0, 0, 0.6, 0.1, 6, 1, 0.008, 0.07))
    outlines.push_back(outline_within(c, 0.004, 0.5 * kTolerance));
  outlines.push_back({{0, 0}, {0.6, 0}, {0.6, 0.01}, {0, 0.01}});
  outlines.push_back(circle_within({0.55, 0.05}, 0.012, 0.5 * kTolerance));
  const std::vector<std::vector<Vec2>> bores = {
      circle_within({0.55, 0.05}, kBore, 0.5 * kTolerance),
      circle_within({0.15, 0.05}, kBore, 0.5 * kTolerance)};
  return unite(outlines, {corners_of({{0, 0}, {0.6, 0.1}}), {}}, bores);
}
std::vector<CurvedRegion> curved_design() { return curves_of(design(), kTolerance); }

double perimeter(std::span<const CurvedRegion> regions) {
  double out = 0;
  const auto add = [&](const CurveRing& ring) {
    for (const OutlineCurve& c : ring)
      out += c.is_line() ? (c.to - c.from).norm() : c.radius * std::abs(c.sweep);
  };
  for (const CurvedRegion& r : regions) {
    add(r.outer);
    std::for_each(r.holes.begin(), r.holes.end(), add);
  }
  return out;
}

/// Returns the area within vertices and bulges: a circular segment is added on every side with a
/// bulge.
double ring_area(const std::vector<Vec2>& ring, const std::vector<double>& bulges) {
  double twice = 0;
  for (std::size_t k = 0; k < ring.size(); ++k) {
    const Vec2 &a = ring[k], &b = ring[(k + 1) % ring.size()];
    const double sweep = 4 * std::atan(bulges[k]);
    twice += a.x() * b.y() - b.x() * a.y();
    if (bulges[k] == 0) continue;
    const double radius = 0.5 * (b - a).norm() / std::sin(0.5 * sweep);
    twice += radius * radius * (sweep - std::sin(sweep));
  }
  return 0.5 * std::abs(twice);
}

TEST(Dxf, ClosedPolylinesAndCirclesEncloseTheArea) {
  const Scratch scratch;
  const std::vector<CurvedRegion> curves = curved_design();
  write_dxf(scratch / "design.dxf", curves, kMetre);
  std::istringstream in(contents_of(scratch / "design.dxf"));
  // A DXF file consists of pairs of lines: group code and value.
  std::map<std::string, double> area_of_layer;
  std::vector<Vec2> ring;
  std::vector<double> bulges, radii;
  std::string code, value, entity, layer;
  int closed = 0, polylines = 0;
  while (std::getline(in, code) && std::getline(in, value)) {
    const int group = std::stoi(code);
    if (group == 0) {
      if (value == "SEQEND") area_of_layer[layer] += ring_area(ring, bulges);
      if (value == "POLYLINE") ++polylines, ring.clear(), bulges.clear();
      if (value == "VERTEX") ring.emplace_back(0, 0), bulges.push_back(0);
      entity = value;
    } else if (group == 8) {
      layer = value;
    } else if (group == 70 && entity == "POLYLINE") {
      closed += std::stoi(value) & 1;
    } else if (entity == "VERTEX" && group == 10) {
      ring.back().x() = std::stod(value);
    } else if (entity == "VERTEX" && group == 20) {
      ring.back().y() = std::stod(value);
    } else if (entity == "VERTEX" && group == 42) {
      bulges.back() = std::stod(value);
    } else if (entity == "CIRCLE" && group == 40) {
      radii.push_back(std::stod(value));
      area_of_layer[layer] += std::numbers::pi * radii.back() * radii.back();
    }
  }
  EXPECT_EQ(value, "EOF");
  EXPECT_EQ(closed, polylines);
  EXPECT_GT(area_of_layer["HOLES"], 0);
  ASSERT_EQ(radii.size(), 2u);
  for (const double r : radii) EXPECT_NEAR(r, kBore, 1e-12);
  const double enclosed = area_of_layer["OUTLINE"] - area_of_layer["HOLES"];
  EXPECT_NEAR(enclosed, area(curves), 1e-12);
  EXPECT_NEAR(enclosed, area(design()), kTolerance * perimeter(curves));
}

// By the even-odd rule, outer rings and holes have opposite directions, so that signed areas add
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
    EXPECT_EQ(count, 1);  // once in each direction, so that facets have one orientation
    EXPECT_EQ(edges.count({edge.second, edge.first}), 1u);
  }
  EXPECT_NEAR(volume, area(regions) * thickness, 1e-9 * volume);
}

// The unit is stated in the file, and the numbers are in this unit.
TEST(Units, OfDxfAndStlAreSaid) {
  const Scratch scratch;
  const std::vector<Region> plate = {{corners_of({{0, 0}, {0.254, 0.0508}}), {}}};
  const std::vector<CurvedRegion> curves = curves_of(plate, kTolerance);
  for (const auto& [unit, code, metric, x] :
       {std::tuple(kMillimetre, "4", "1", "254"), std::tuple(kInch, "1", "0", "10"),
        std::tuple(kMetre, "6", "1", "0.254")}) {
    write_dxf(scratch / "a.dxf", curves, unit,
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

// A written drawing can be read as a domain, within the tolerance of reading.
TEST(Dxf, IsADomainAgain) {
  const Scratch scratch;
  const std::vector<CurvedRegion> all = curved_design();
  const CurvedRegion& largest = *std::max_element(
      all.begin(), all.end(), [](const auto& a, const auto& b) { return area(a) < area(b); });
  const std::vector<DrawingLayer> more = {
      {"DOMAIN", {}, {lines_of(corners_of({{0, 0}, {0.6, 0.1}}))}},
      {"LOADS", {{{0.6, 0.05}}, {{0, 0}, {0, 0.1}}}, {{full_circle({0.3, 0.05}, 0.01)}}}};
  for (const LengthUnit& unit : kLengthUnits) {
    write_dxf(scratch / "design.dxf", {&largest, 1}, unit, more);
    const Region back =
        region_of(read_drawing(scratch / "design.dxf", {{}, {"OUTLINE", "HOLES"}}).rings);
    EXPECT_EQ(back.holes.size(), largest.holes.size());
    // The distance of the reader's sides from arcs is a fraction of the size of the drawing.
    const double near = kDrawingTolerance * 0.6;
    EXPECT_NEAR(area(back), area(largest), near * perimeter({&largest, 1})) << unit.name;
    const Box box = bounds_of(polygon_within(largest.outer, 0.1 * near));
    EXPECT_NEAR((bounds_of(back.outer).upper - box.upper).norm(), 0, 1.5 * near);
    // The curves of the domain equal those that were written: the bores are circles again.
    const CurvedRegion again = curves_of({&back, 1}, 2 * near)[0];
    const auto bores = std::count_if(again.holes.begin(), again.holes.end(), [](const auto& ring) {
      return ring.size() == 1 && std::abs(ring[0].radius - kBore) < 1e-9;
    });
    EXPECT_EQ(bores, 2);
  }
}

/// Returns a STEP file as OpenCASCADE reads it, in millimetres.
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

/// Returns the radii of the cylindrical faces of a shape [mm].
std::vector<double> cylinders_of(const TopoDS_Shape& shape) {
  std::vector<double> out;
  for (TopExp_Explorer e(shape, TopAbs_FACE); e.More(); e.Next()) {
    const BRepAdaptor_Surface surface(TopoDS::Face(e.Current()));
    if (surface.GetType() == GeomAbs_Cylinder) out.push_back(surface.Cylinder().Radius());
  }
  return out;
}

TEST(Step, IsASolidOfTheVolumeWithCylindersAtItsArcs) {
  const Scratch scratch;
  std::vector<Region> polygons = design();
  polygons.push_back({corners_of({{1, 0}, {1.1, 0.1}}), {}});
  const std::vector<CurvedRegion> regions = curves_of(polygons, kTolerance);
  const double thickness = 0.013;
  int lines = 0, arcs = 0;
  for (const CurvedRegion& r : regions) {
    lines += 2;  // bottom and top
    const auto add = [&](const CurveRing& ring) {
      for (const OutlineCurve& c : ring) ++(c.is_line() ? lines : arcs);
    };
    add(r.outer);
    std::for_each(r.holes.begin(), r.holes.end(), add);
  }
  EXPECT_EQ(write_step(scratch / "design.step", regions, thickness), "");
  const TopoDS_Shape shape = step_shape(scratch / "design.step");
  EXPECT_TRUE(BRepCheck_Analyzer(shape).IsValid());
  EXPECT_EQ(count(shape, TopAbs_SOLID), static_cast<int>(regions.size()));
  EXPECT_EQ(count(shape, TopAbs_FACE), lines + arcs);
  const std::vector<double> radii = cylinders_of(shape);
  EXPECT_EQ(static_cast<int>(radii.size()), arcs);
  EXPECT_EQ(std::count_if(radii.begin(), radii.end(),
                          [](double r) { return std::abs(r - 1e3 * kBore) < 1e-9; }),
            2);
  GProp_GProps properties;
  BRepGProp::VolumeProperties(shape, properties);
  const double found = 1e-9 * properties.Mass() / thickness;
  EXPECT_NEAR(found, area(regions), 1e-9 * area(regions));
  EXPECT_NEAR(found, area(polygons), kTolerance * perimeter(regions));
}

// Equal designs give equal files; their numbers are millimetres.
TEST(Step, IsRepeatableAndInMillimetres) {
  const Scratch scratch;
  const Region corners{corners_of({{0, 0}, {0.254, 0.0508}}), {}};
  const std::vector<CurvedRegion> plate = curves_of({&corners, 1}, kTolerance);
  write_step(scratch / "a.step", plate, 0.01);
  write_step(scratch / "b.step", plate, 0.01);
  const std::string text = contents_of(scratch / "a.step");
  EXPECT_TRUE(text == contents_of(scratch / "b.step"));
  EXPECT_TRUE(contains(text, "CARTESIAN_POINT('',(254.,50.8,0.))"));
  EXPECT_TRUE(contains(text, "SI_UNIT(.MILLI.,.METRE.)"));
  EXPECT_TRUE(text.ends_with("END-ISO-10303-21;\n"));
  write_step(scratch / "none.step", {}, 0.01);  // an empty design
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

TEST(ComponentsCsv, RefusesBadFilesWithTheirLocation) {
  const Scratch scratch;
  const std::string columns = "X0,Y0,half_length,angle,c1,c2,c3", header = columns + "\n",
                    file = scratch / "bad.csv";
  const auto complaint = [&](const std::string& text) -> std::string {
    std::ofstream(file) << text;
    try {
      read_components_csv(file);
    } catch (const Error& e) {
      return e.what();
    }
    return "";
  };
  EXPECT_TRUE(says(complaint("x,y\n"), file + ":1: ", {columns}));
  EXPECT_TRUE(says(complaint(header + "0,0,1,0,1,1,1\n0,0,1,0,1,x,1\n"),
                   file + ":3: ", {"c2 = 'x'", "finite"}));
  EXPECT_TRUE(says(complaint(header + "0,0,-1,0,1,1,1\n"),
                   file + ":2: ", {"half_length = -1", "positive"}));
  EXPECT_TRUE(says(complaint(header + "0,0,1,0,1,1\n"), file + ":2: ", {"6 values", "7"}));
  EXPECT_TRUE(
      says(complaint(header + "0,0,1,0,1,1,nan\n"), file + ":2: ", {"c3 = 'nan'", "finite"}));
  EXPECT_NE(complaint(header), "");
  EXPECT_THROW(read_components_csv(scratch / "none.csv"), Error);
}

}  // namespace
}  // namespace flexmorph::io
