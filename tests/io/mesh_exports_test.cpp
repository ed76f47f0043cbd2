// Shows that meshes for other programs are right when they are read back by readers written here.
#include "io/drawings/mesh_exports.h"

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <sstream>

#include "tests/io/scratch.h"

namespace flexmorph::io {
namespace {

std::vector<Region> frame() {
  return {{{{0, 0}, {3, 0}, {3, 1}, {0, 1}}, {{{1, 0.4}, {1, 0.6}, {2, 0.6}, {2, 0.4}}}}};
}

PartMesh mesh_of_frame() {
  PartMesher mesher(frame(), {});
  mesher.refine(SizeField({{0, 0}, {3, 1}}, 0.3));
  return mesher.mesh();
}

/// Returns the lines of an input file under each keyword line, in their order.
std::vector<std::pair<std::string, std::vector<std::vector<double>>>> cards(
    const std::string& text) {
  std::vector<std::pair<std::string, std::vector<std::vector<double>>>> out;
  std::istringstream in(text);
  for (std::string line; std::getline(in, line);) {
    if (line.starts_with("**")) continue;
    if (line.starts_with("*")) {
      out.emplace_back(line, std::vector<std::vector<double>>{});
      continue;
    }
    std::vector<double>& row = out.back().second.emplace_back();
    std::istringstream cells(line);
    for (std::string cell; std::getline(cells, cell, ',');) {
      EXPECT_LE(cell.size(), 20u) << "CalculiX cuts what is longer: " << cell;
      row.push_back(std::atof(cell.c_str()));
    }
  }
  return out;
}

TEST(Inp, HoldsMeshSupportsAndForces) {
  const Scratch scratch;
  const PartMesh mesh = mesh_of_frame();
  PlateModel model{mesh, {}, 0.7, 2e11 / 3, 1. / 3, {}};
  MeshLoad load{"a pull, and more", {}, {}};
  for (int k = 0; k < static_cast<int>(mesh.points.size()); ++k) {
    if (mesh.point(k).x() == 0)
      for (int c = 0; c < 2; ++c) load.held.push_back({k, c, c == 1 ? 1e-3 / 3 : 0.0});
    if (mesh.point(k).x() == 3) load.forces.push_back({k, Vec2(-1. / 3, 2. / 7)});
  }
  model.loads = {load, load};
  model.loads[1].name = "again";
  write_inp(scratch / "a.inp", model);
  const auto all = cards(contents_of(scratch / "a.inp"));
  std::map<int, Vec2> nodes;
  double area = 0, pulled = 0, thickness = 0;
  int steps = 0;
  for (const auto& [card, rows] : all) {
    if (card.starts_with("*NODE, NSET"))
      for (const auto& r : rows) nodes[static_cast<int>(r[0])] = {r[1], r[2]};
    if (card.starts_with("*ELEMENT"))
      for (const auto& r : rows) {
        ASSERT_EQ(r.size(), 7u);
        std::array<Vec2, 6> p;
        for (std::size_t k = 0; k < 6; ++k) p[k] = nodes.at(static_cast<int>(r[k + 1]));
        area +=
            0.5 * ((p[1] - p[0]).x() * (p[2] - p[0]).y() - (p[1] - p[0]).y() * (p[2] - p[0]).x());
        for (std::size_t k = 0; k < 3; ++k)
          EXPECT_NEAR((0.5 * (p[k] + p[(k + 1) % 3]) - p[3 + k]).norm(), 0, 1e-11);
      }
    if (card.starts_with("*SOLID SECTION")) thickness = rows.at(0).at(0);
    if (card.starts_with("*STEP")) ++steps;
    if (card.starts_with("*BOUNDARY")) {
      EXPECT_EQ(rows.size(), load.held.size());
    }
    if (card.starts_with("*CLOAD"))
      for (const auto& r : rows) pulled += r[1] == 1 ? r[2] : 0;
  }
  EXPECT_EQ(steps, 2);
  EXPECT_NEAR(area, mesh.area(), 1e-10);
  // The model is a slice with a proportional fraction of the forces.
  EXPECT_LT(thickness, 0.7);
  EXPECT_NEAR(pulled, 2 * thickness / 0.7 * static_cast<double>(load.forces.size()) / -3, 1e-10);
}

TEST(Msh, HoldsAllTriangles) {
  const Scratch scratch;
  const PartMesh mesh = mesh_of_frame();
  write_msh(scratch / "a.msh", mesh);
  std::istringstream in(contents_of(scratch / "a.msh"));
  std::string word;
  while (in >> word && word != "$Nodes") {
  }
  std::size_t n = 0;
  in >> n;
  ASSERT_EQ(n, mesh.points.size());
  for (std::size_t k = 0; k < n; ++k) {
    double number = 0, x = 0, y = 0, z = 0;
    in >> number >> x >> y >> z;
    EXPECT_EQ(Vec2(x, y), mesh.points[k]);
  }
  in >> word >> word >> n;
  ASSERT_EQ(n, mesh.triangles.size());
  for (std::size_t t = 0; t < n; ++t) {
    int number = 0, type = 0, tags = 0, piece = 0;
    in >> number >> type >> tags >> piece >> piece;
    EXPECT_EQ(type, 9);
    for (const int node : mesh.triangles[t]) {
      in >> number;
      EXPECT_EQ(number, node + 1);
    }
  }
}

TEST(Geo, HasALoopForEveryRing) {
  const Scratch scratch;
  write_geo(scratch / "a.geo", frame(), 0.1);
  const std::string text = contents_of(scratch / "a.geo");
  EXPECT_NE(text.find("Line Loop(2)"), std::string::npos);
  EXPECT_NE(text.find("Plane Surface(1) = {1, 2};"), std::string::npos);
  EXPECT_NE(text.find("Line(4) = {4, 1};"), std::string::npos);
  EXPECT_NE(text.find("Line(8) = {8, 5};"), std::string::npos);
}

}  // namespace
}  // namespace flexmorph::io
