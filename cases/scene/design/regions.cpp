#include "cases/scene/design/keys.h"
#include "cases/scene/read.h"
#include "io/files.h"

/// [[design.solid]], [[design.void]].
namespace flexmorph::cases {
namespace design_keys {

const io::Key& kSolid = io::key("design", "solid")
                            .tables_of()
                            .otherwise_as("none")
                            .says("Regions that are material, whatever the components do.");
const io::Key& kVoid = io::key("design", "void")
                           .tables_of()
                           .otherwise_as("none")
                           .says("Regions that are void, whatever the components do.");

}  // namespace design_keys

namespace {

using io::Table;
using io::to_text;
using namespace design_keys;

const io::Choice<bool> kStripChoice(io::shared_key({"design.solid", "design.void"}, "strip")
                                        .otherwise_as("`box` is given")
                                        .says("A strip along an end of the domain."),
                                    "a strip lies along an end: it",
                                    {{"free_end", true}, {"root", false}});
const io::Key& kBox = io::shared_key({"design.solid", "design.void"}, "box")
                          .numbers(io::any_number("x0, y0, x1, y1 of a box", "m"), 4, 4)
                          .otherwise_as("`strip` is given")
                          .says("Or the cells whose centres are in a box: x0, y0, x1, y1.");

}  // namespace

namespace design_keys {

const io::Key& kStrip = kStripChoice;
const io::Key& kStripCells = io::shared_key({"design.solid", "design.void"}, "cells")
                                 .integer("the width of a strip", 1, 100'000)
                                 .otherwise(2)
                                 .when("`strip` is given")
                                 .says("How many cells wide it is.");

}  // namespace design_keys

namespace {

bool holds(const Box& box, const Vec2& p) {
  return p.x() >= box.lower.x() && p.x() <= box.upper.x() && p.y() >= box.lower.y() &&
         p.y() <= box.upper.y();
}

int cells_in(const Grid& grid, const std::vector<Box>& boxes) {
  int count = 0;
  for (int i = 0; i < grid.nx; ++i)
    for (int j = 0; j < grid.ny; ++j)
      count += std::any_of(boxes.begin(), boxes.end(),
                           [&](const Box& box) { return holds(box, grid.cell_center(i, j)); });
  return count;
}

/// One [[design.solid]] or [[design.void]]: a box, or a strip along an end.
Box read_region(const Table& t, const Grid& grid) {
  if (t.has(kBox) == t.has(kStrip)) t.fail("a region has either a `box` or a `strip`");
  const double left = grid.x0, right = grid.x0 + grid.width;
  const double bottom = grid.y0, top = grid.y0 + grid.height;
  if (t.has(kStrip)) {
    const bool at_end = t.choice(kStripChoice);
    const double wide = grid.dx() * t.integer(kStripCells.within(1, grid.nx));
    return at_end ? Box{{right - wide, bottom}, {right, top}}
                  : Box{{left, bottom}, {left + wide, top}};
  }
  if (t.has(kStripCells)) t.fail(kStripCells, "only a strip is as wide as a number of cells");
  const std::vector<double> b = t.numbers(kBox);
  Box box{{b[0], b[1]}, {b[2], b[3]}};
  if (b[0] >= b[2] || b[1] >= b[3])
    t.fail(kBox, "x0 < x1 and y0 < y1, in the order x0, y0, x1, y1 [m]");
  if (cells_in(grid, {box}) == 0)
    t.fail(kBox, "a box holds the centre of a cell; the domain is [" + to_text(left) + ", " +
                     to_text(right) + "] x [" + to_text(bottom) + ", " + to_text(top) + "] [m]");
  return box;
}

bool overlap(const Box& a, const Box& b, double margin) {
  return (a.upper.array() > b.lower.array() + margin).all() &&
         (b.upper.array() > a.lower.array() + margin).all();
}

}  // namespace

void read_regions(const Table& t, const Body& body, const Scene& scene, BodyDesign& design) {
  const Grid& grid = design.grid;
  const double small = 1e-6 * grid.dx();
  for (const Table& region : t.tables(kSolid)) design.solid.push_back(read_region(region, grid));
  for (const Table& region : t.tables(kVoid)) {
    design.empty.push_back(read_region(region, grid));
    for (const Box& solid : design.solid)
      if (overlap(solid, design.empty.back(), small))
        region.fail("a region cannot be solid and void at once");
  }
  const double filled = cells_in(grid, design.solid) / double(grid.n_cells());
  if (const auto allowed = mmc::allowed_volume(design.goal); allowed && filled >= *allowed) {
    const std::string words = "the solid regions alone fill " + to_text(filled, 3);
    if (t.has(kMaxVolume)) t.fail(kMaxVolume, words + " of the domain");
    t.fail(words + " of the domain, and " + to_text(*allowed, 3) + " is allowed");
  }

  // Without material under it the mass would end up in the void (optim/README.md, Passive regions).
  const Vec2 end(grid.x0 + grid.width, grid.y0 + 0.5 * grid.height);
  const auto carries = [&](const Box& box) {
    return holds(box, end - Vec2(2 * grid.dx() - small, grid.dy() - small)) &&
           holds(box, end - Vec2(small, -grid.dy() + small));
  };
  for (const PointMass& mass : scene.point_masses)
    if (mass.body == body.name && std::none_of(design.solid.begin(), design.solid.end(), carries))
      t.fail("the point mass at the free end of '" + body.name +
             "' needs solid material: [[design.solid]] with strip = \"free_end\", cells = 2");
  const bool welded = std::any_of(scene.joints.begin(), scene.joints.end(), [&](const Joint& j) {
    return j.body == body.name && j.edge == "free_end";
  });
  const int strip = 2 * grid.ny;  // cells of the last two columns, each of which must be solid
  int solid = 0;
  for (int i = std::max(0, grid.nx - 2); i < grid.nx; ++i)
    for (int j = 0; j < grid.ny; ++j)
      solid += std::any_of(design.solid.begin(), design.solid.end(),
                           [&](const Box& box) { return holds(box, grid.cell_center(i, j)); });
  if (welded && solid < strip)
    t.fail("the welded free end of '" + body.name +
           "' needs solid material: [[design.solid]] with strip = \"free_end\", cells = 2");
}

}  // namespace flexmorph::cases
