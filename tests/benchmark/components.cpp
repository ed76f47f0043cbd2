// Prints the CPU time of components without mechanics: 120, 480 and 2000 slender components on 400
// x 200 cells, in a lattice with random displacements. It checks nothing.

#include <cstdio>
#include <random>
#include <vector>

#include "geometry/components/tdf.h"
#include "geometry/parts/feature.h"
#include "geometry/parts/picture.h"
#include "geometry/parts/triangulate.h"
#include "tests/benchmark/cpu.h"
#include "tests/benchmark/reference.h"

namespace {

using namespace flexmorph;
using namespace flexmorph::benchmark;

constexpr double kThinnest = 0.004;  // half-thickness [m]

/// Returns two crossing components per box of the lattice.
std::vector<Component> lattice(int along, int across, const Grid& grid) {
  std::mt19937 engine(1);
  const auto draw = [&] { return 2 * (static_cast<double>(engine()) / 4294967295.0) - 1; };
  const Vec2 box(grid.width / along, grid.height / across);
  std::vector<Component> out;
  for (int i = 0; i < along; ++i)
    for (int j = 0; j < across; ++j)
      for (const double sign : {-1.0, 1.0}) {
        double p[Component::kParameters] = {(i + 0.5 + 0.1 * draw()) * box.x(),
                                            (j + 0.5 + 0.1 * draw()) * box.y(),
                                            0.5 * box.norm() * (1 + 0.1 * draw()),
                                            sign * std::atan2(box.y(), box.x()) + 0.1 * draw(),
                                            kThinnest,
                                            kThinnest,
                                            kThinnest};
        for (int k = 4; k < Component::kParameters; ++k) p[k] *= 1.5 + 0.5 * draw();
        out.push_back(Component::from_parameters(p));
      }
  return out;
}

void row(int along, int across) {
  Grid grid;
  grid.width = 2;
  grid.height = 1;
  grid.nx = 400;
  grid.ny = 200;
  const std::vector<Component> components = lattice(along, across, grid);
  UnionTdf tdf(grid, {.min_half_thickness = kThinnest});
  VectorXd slope;
  const VectorXd ones = VectorXd::Ones(grid.n_nodes());
  const double field = milliseconds([&] { tdf.evaluate(components); });
  const double chain = milliseconds([&] { tdf.pull_back(ones, slope); });
  const double cells = milliseconds([&] { area_fractions(grid, components, kThinnest, {}, {}); });
  std::vector<std::vector<Vec2>> outlines;
  std::vector<Region> regions;
  const double union_of = milliseconds(
      [&] {
        outlines.clear();
        for (const Component& c : components)
          outlines.push_back(outline_within(c, kThinnest, 0.01 * grid.dx()));
        regions = unite(outlines, Box{{0, 0}, {grid.width, grid.height}});
      },
      1);
  const Region domain{{{0, 0}, {grid.width, 0}, {grid.width, grid.height}, {0, 1}}, {}};
  const double features = milliseconds([&] { smallest_features(regions, domain); }, 1);
  const double triangles = milliseconds(
      [&] {
        for (const Region& r : regions) triangulate(r);
      },
      1);
  std::size_t vertices = 0;
  for (const Region& r : regions) {
    vertices += r.outer.size();
    for (const auto& hole : r.holes) vertices += hole.size();
  }
  std::printf("%10zu %9zu %8.1f %8.1f %8.1f %8.0f %8.0f %8.0f\n", components.size(), vertices,
              field, chain, cells, union_of, features, triangles);
}

}  // namespace

int main(int, char** argv) {
  begin(argv);
  std::printf(
      "ms CPU\ncomponents  vertices      TDF   chain    cells    union features triangles\n");
  row(10, 6);
  row(20, 12);
  row(50, 20);
}
