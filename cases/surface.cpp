#include "cases/surface.h"

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

}  // namespace flexmorph::cases
