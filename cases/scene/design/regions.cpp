#include "cases/scene/design/keys.h"
#include "cases/scene/read.h"
#include "geometry/parts/picture.h"
#include "io/files.h"
#include "optim/mmc/problem/body_problem.h"

/// Readers of [[design.solid]] and [[design.void]].
namespace flexmorph::cases {
namespace design_keys {

const io::Key& kSolid =
    io::key("design", "solid")
        .tables_of()
        .otherwise_as("none")
        .description("Regions that are solid for all layouts of the components.");
const io::Key& kVoid = io::key("design", "void")
                           .tables_of()
                           .otherwise_as("none")
                           .description("Regions that are void for all layouts of the components.");

}  // namespace design_keys

namespace {

using io::Table;
using io::to_text;
using namespace design_keys;

io::Key& region_key(const char* name) {
  return io::shared_key({"design.solid", "design.void"}, name);
}

constexpr const char* kAnother = "required unless another shape is given";

const io::Choice<bool> kStripChoice(region_key("strip").otherwise_as(kAnother).description(
                                        "Strip along an end of the domain, `root` or `free_end`."),
                                    "the end of a strip", {{"free_end", true}, {"root", false}});
const io::Key& kBox = region_key("box")
                          .numbers(io::any_number("x0, y0, x1, y1 of a box", "m"), 4, 4)
                          .otherwise_as(kAnother)
                          .description(
                              "Box x0, y0, x1, y1. Cells with centres inside belong to it; "
                              "outlines show the exact box.");
const io::Key& kDisc = region_key("disc")
                           .numbers(io::any_number("x, y, radius of a disc", "m"), 3, 3)
                           .otherwise_as(kAnother)
                           .description("Disc with centre and radius: x, y, radius.");
const io::Key& kPolygon = region_key("polygon")
                              .numbers(io::any_number("x0, y0, x1, y1, ... of a polygon", "m"), 6)
                              .otherwise_as(kAnother)
                              .description("Polygon with the corners x0, y0, x1, y1, ...");

}  // namespace

namespace design_keys {

const io::Key& kStrip = kStripChoice;
const io::Key& kStripCells = io::shared_key({"design.solid", "design.void"}, "cells")
                                 .integer("the width of a strip", 1, 100'000)
                                 .otherwise(2)
                                 .when("`strip` is given")
                                 .description("Width of the strip, as a number of cells.");

}  // namespace design_keys

namespace {

using Ring = std::vector<Vec2>;

bool holds(const Ring& ring, const Vec2& p) { return contains({ring, {}}, p); }

/// Returns 1 for every cell of a grid that belongs to one of the regions, else 0 (n_cells).
std::vector<signed char> cells_in(const Grid& grid, std::span<const Ring> rings) {
  std::vector<signed char> in(static_cast<size_t>(grid.n_cells()), 0);
  for (const Ring& ring : rings)
    for (const int cell : cells_within(grid, {ring, {}})) in[static_cast<size_t>(cell)] = 1;
  return in;
}

/// Returns 1 for every cell in the domain of a plate that belongs to one of the regions, else 0
/// (n_cells).
std::vector<signed char> cells_in(const mmc::Plate& plate, std::span<const Ring> rings) {
  std::vector<signed char> in = cells_in(plate.grid, rings);
  for (size_t cell = 0; cell < plate.outside.size(); ++cell)
    if (plate.outside[cell]) in[cell] = 0;
  return in;
}

auto count(const std::vector<signed char>& cells) {
  return std::count(cells.begin(), cells.end(), 1);
}

Ring read_strip(const Table& t, const Grid& grid) {
  const Vec2 lower(grid.x0, grid.y0), upper = lower + Vec2(grid.width, grid.height);
  const bool at_end = t.choice(kStripChoice);
  const double wide = grid.dx() * t.integer(kStripCells.within(1, grid.nx));
  return corners_of(at_end ? Box{{upper.x() - wide, lower.y()}, upper}
                           : Box{lower, {lower.x() + wide, upper.y()}});
}

Ring read_box(const Table& t) {
  const std::vector<double> b = t.numbers(kBox);
  if (b[0] >= b[2] || b[1] >= b[3])
    t.fail(kBox, "a box is x0, y0, x1, y1 with x0 < x1 and y0 < y1 [m]");
  return corners_of({{b[0], b[1]}, {b[2], b[3]}});
}

/// Reads a disc as a polygon.
/// @param tolerance  largest error of its sides; the tolerance of outlines is a limit, too [m]
Ring read_disc(const Table& t, const Grid& grid, double tolerance) {
  const std::vector<double> d = t.numbers(kDisc);
  if (d[2] <= 0) t.fail(kDisc, "a disc is x, y, radius with a positive radius [m]");
  return circle_within({d[0], d[1]}, d[2], std::min(tolerance, mmc::kOutlineTolerance * grid.dx()));
}

/// Reads one [[design.solid]] or [[design.void]].
Ring read_region(const Table& t, const mmc::Plate& plate, double tolerance) {
  const Grid& grid = plate.grid;
  if (t.has(kBox) + t.has(kStrip) + t.has(kDisc) + t.has(kPolygon) != 1)
    t.fail("a region needs exactly one of `box`, `disc`, `polygon` and `strip`");
  if (t.has(kStrip)) return read_strip(t, grid);
  if (t.has(kStripCells)) t.fail(kStripCells, "this key needs a `strip`");
  const io::Key& shape = t.has(kBox) ? kBox : t.has(kDisc) ? kDisc : kPolygon;
  Ring ring = t.has(kBox)    ? read_box(t)
              : t.has(kDisc) ? read_disc(t, grid, tolerance)
                             : read_polygon(t, kPolygon);
  if (count(cells_in(plate, {&ring, 1})) == 0)
    t.fail(shape, "a " + shape.name + " contains the centre of at least one cell; the domain is [" +
                      to_text(grid.x0) + ", " + to_text(grid.x0 + grid.width) + "] x [" +
                      to_text(grid.y0) + ", " + to_text(grid.y0 + grid.height) + "] [m]");
  return ring;
}

/// Returns true if two regions overlap by more than the rounding errors along a common border.
bool overlap(const Ring& a, const Ring& b, const Grid& grid) {
  return area(unite({&a, 1}, {b, {}}, {})) > 1e-6 * grid.dx() * grid.dy();
}

/// Throws if a point mass or a weld at the free end is not on solid material, because the design
/// could otherwise have void there (optim/README.md, Passive regions).
void check_free_end(const Table& t, const Body& body, const Scene& scene,
                    const BodyDesign& design) {
  const Grid& grid = design.grid;
  const std::string strip =
      "' needs solid material: [[design.solid]] with strip = \"free_end\", "
      "cells = 2";
  const double small = 1e-6 * grid.dx();
  const Vec2 end(grid.x0 + grid.width, grid.y0 + 0.5 * grid.height);
  const auto carries = [&](const Ring& ring) {
    return holds(ring, end - Vec2(2 * grid.dx() - small, grid.dy() - small)) &&
           holds(ring, end - Vec2(small, -grid.dy() + small));
  };
  for (const PointMass& mass : scene.point_masses)
    if (mass.body == body.name && mass.at_end &&
        std::none_of(design.solid.begin(), design.solid.end(), carries))
      t.fail("the point mass at the free end of '" + body.name + strip);
  const bool welded = std::any_of(scene.joints.begin(), scene.joints.end(), [&](const Joint& j) {
    return j.body == body.name && j.edge == "free_end";
  });
  const auto in = cells_in(grid, design.solid);
  const auto last = std::min(in.size(), static_cast<size_t>(2 * grid.ny));  // cells of two columns
  if (welded && std::count(in.end() - static_cast<std::ptrdiff_t>(last), in.end(), 1) < 2 * grid.ny)
    t.fail("the welded free end of '" + body.name + strip);
}

}  // namespace

void read_regions(const Table& t, const Body& body, const Scene& scene, BodyDesign& design) {
  const mmc::Plate plate = plate_of(scene, design);
  const double tolerance = export_tolerance(scene, design);
  for (const Table& region : t.tables(kSolid))
    design.solid.push_back(read_region(region, plate, tolerance));
  for (const Table& region : t.tables(kVoid)) {
    design.empty.push_back(read_region(region, plate, tolerance));
    for (const Ring& solid : design.solid)
      if (overlap(solid, design.empty.back(), design.grid))
        region.fail("a region cannot be solid and void at once");
  }
  const double filled =
      static_cast<double>(count(cells_in(plate, design.solid))) / plate.n_domain_cells();
  if (const auto allowed = mmc::allowed_volume(design.goal); allowed && filled >= *allowed) {
    const std::string words = "the solid regions alone fill " + to_text(filled, 3);
    if (t.has(kMaxVolume)) t.fail(kMaxVolume, words + " of the domain");
    t.fail(words + " of the domain, but only " + to_text(*allowed, 3) + " is allowed");
  }
  check_free_end(t, body, scene, design);
}

}  // namespace flexmorph::cases
