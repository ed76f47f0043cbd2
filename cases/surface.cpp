#include "cases/surface.h"

#include <cmath>

#include "fem/dynamics/carrier.h"

namespace flexmorph::cases {
namespace {

constexpr int kFine = 4;  // quads along an edge of an element

/// Material coordinates of the points along one direction.
template <class Line>
std::vector<double> fine_lines(int n, const Line& line) {
  std::vector<double> out;
  for (int i = 0; i < n; ++i)
    for (int k = 0; k < kFine; ++k)
      out.push_back(line(i) + (line(i + 1) - line(i)) * k / static_cast<double>(kFine));
  out.push_back(line(n));
  return out;
}

/// Strain energy of every element over its area [J/m^2].
std::vector<double> energies(const fem::Body& body, const fem::LineGrid& grid,
                             const fem::State& x) {
  std::vector<double> out;
  fem::Local local;
  const int dim = grid.dim();
  for (int e = 0; e < grid.n_elements(); ++e) {
    const auto vectors = grid.vectors(e);
    const auto gather = [&](const VectorXd& all, fem::LocalRows& rows) {
      rows.resize(grid.n_shapes(), dim);
      for (int k = 0; k < grid.n_shapes(); ++k)
        rows.row(k) = all.segment(body.first_dof + dim * vectors[static_cast<size_t>(k)], dim);
    };
    gather(x.q, local.q);
    gather(x.v, local.v);
    gather(x.a, local.a);
    double energy = 0;
    for (const auto& term : body.terms) energy += term->strain_energy(e, local);
    const int i = e / grid.n_n(), j = e % grid.n_n();
    out.push_back(energy / (grid.line_m(i + 1).value - grid.line_m(i).value) /
                  (grid.line_n(j + 1).value - grid.line_n(j).value));
  }
  return out;
}

}  // namespace

Surface deformed_surface(const fem::Body& body, const fem::State& x, const Pose& pose) {
  const fem::LineGrid& grid = fem::grid_of(body);
  const std::vector<double> along =
      fine_lines(grid.n_m(), [&](int i) { return grid.line_m(i).value; });
  const std::vector<double> across =
      fine_lines(grid.n_n(), [&](int j) { return grid.line_n(j).value; });
  const std::vector<double> energy = energies(body, grid, x);
  const int rows = static_cast<int>(across.size());
  Surface out;
  out.mesh.dimension = grid.dim();
  out.across = rows - 1;
  for (size_t i = 0; i < along.size(); ++i)
    for (size_t j = 0; j < across.size(); ++j) {
      const Vec2 material(along[i], across[j]);
      const Vec3 r = fem::point_position(body, x, material), u = r - pose.place(material);
      for (int c = 0; c < grid.dim(); ++c) {
        out.mesh.points.push_back(r[c]);
        out.displacement.push_back(u[c]);
      }
      if (i + 1 == along.size() || j + 1 == across.size()) continue;
      const int a = static_cast<int>(i) * rows + static_cast<int>(j);
      out.mesh.quads.push_back({a, a + rows, a + rows + 1, a + 1});
      out.energy.push_back(energy[static_cast<size_t>(
          grid.element(static_cast<int>(i) / kFine, static_cast<int>(j) / kFine))]);
    }
  return out;
}

DesignedSurface designed_surface(const fem::Body& body, const fem::State& x, const Grid& grid,
                                 const VectorXd& density) {
  const double root = fem::grid_of(body).line_m(0).value;
  const int first = std::max(0, static_cast<int>(std::ceil((root - grid.x0) / grid.dx() - 1e-6)));
  DesignedSurface out;
  const int ny = grid.ny;
  for (int i = first; i <= grid.nx; ++i)
    for (int j = 0; j <= ny; ++j) {
      const Vec2 p = fem::point_motion(body, x, grid.node_position(i, j)).position;
      out.mesh.points.push_back(p.x());
      out.mesh.points.push_back(p.y());
      if (i == grid.nx || j == ny) continue;
      const int a = (i - first) * (ny + 1) + j;
      out.mesh.quads.push_back({a, a + ny + 1, a + ny + 2, a + 1});
      out.density.push_back(density[grid.cell(i, j)]);
    }
  return out;
}

std::vector<Vec2> drawn_corners(const RigidBody& body, const fem::Model& model,
                                const fem::State& x) {
  std::vector<Vec2> out;
  if (body.size.isZero()) return out;
  const fem::FrameMotion frame = fem::frame_of(model.body(body.name), x);
  const Eigen::Matrix2d axes = fem::rotation(frame.angle);
  for (const Vec2& corner : {Vec2(-0.5, -0.5), Vec2(0.5, -0.5), Vec2(0.5, 0.5), Vec2(-0.5, 0.5)})
    out.emplace_back(frame.origin + axes * (body.center + corner.cwiseProduct(body.size)));
  return out;
}

}  // namespace flexmorph::cases
