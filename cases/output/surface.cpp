#include "cases/output/surface.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "cases/output/rigid_fit.h"
#include "cases/scene/elements/row.h"
#include "fem/dynamics/starts/driven_frame.h"

namespace flexmorph::cases {
namespace {

/// Material coordinates of the lines between the elements of a body. Elements are numbered across
/// first.
struct Cuts {
  explicit Cuts(const fem::Body& body) : Cuts(body.element->lines()) {}
  explicit Cuts(std::array<std::vector<double>, 2> lines)
      : m(std::move(lines[0])), n(std::move(lines[1])) {}
  std::vector<double> m, n;

  size_t element(size_t i, size_t j) const { return i * (n.size() - 1) + j; }
  /// Returns the element that contains a material point, or the nearest element.
  size_t element_at(const Vec2& p) const { return element(interval(m, p.x()), interval(n, p.y())); }

 private:
  static size_t interval(const std::vector<double>& lines, double at) {
    const auto next = std::upper_bound(lines.begin() + 1, lines.end() - 1, at);
    return static_cast<size_t>(next - lines.begin()) - 1;
  }
};

/// Returns the material coordinates of the points along one direction, `fine` intervals per
/// element.
std::vector<double> fine_lines(const std::vector<double>& lines, int fine) {
  std::vector<double> out;
  for (size_t i = 0; i + 1 < lines.size(); ++i)
    for (int k = 0; k < fine; ++k)
      out.push_back(lines[i] + (lines[i + 1] - lines[i]) * k / static_cast<double>(fine));
  out.push_back(lines.back());
  return out;
}

/// Returns the strain energy of every element divided by its area [J/m^2].
std::vector<double> energies(const fem::Body& body, const Cuts& cuts, const fem::State& x) {
  std::vector<double> out;
  fem::Local local;
  const fem::Element& element = *body.element;
  const int dim = element.dim();
  for (int e = 0; e < element.n_elements(); ++e) {
    const auto vectors = element.vectors(e);
    const auto gather = [&](const VectorXd& all, fem::LocalRows& rows) {
      rows.resize(element.n_shapes(), dim);
      for (int k = 0; k < element.n_shapes(); ++k)
        rows.row(k) = all.segment(body.first_dof + dim * vectors[static_cast<size_t>(k)], dim);
    };
    gather(x.q, local.q);
    gather(x.v, local.v);
    gather(x.a, local.a);
    double energy = 0;
    for (const auto& term : body.terms) energy += term->strain_energy(e, local);
    const size_t n = cuts.n.size() - 1, i = static_cast<size_t>(e) / n,
                 j = static_cast<size_t>(e) % n;
    out.push_back(energy / (cuts.m[i + 1] - cuts.m[i]) / (cuts.n[j + 1] - cuts.n[j]));
  }
  return out;
}

/// Returns the elastic Green strain (FᵀF/s² - 1)/2 of a body at a material point: 11, 22, 12.
/// @param t  storage for shape functions
Vec3 elastic_strain(const fem::Body& body, const fem::State& x, const Vec2& material, double s,
                    fem::ShapeTable& t) {
  const int e = body.element->locate(material, fem::Tabulate::gradient, t),
            dim = body.element->dim();
  const auto vectors = body.element->vectors(e);
  Vec3 r_m(0, 0, 0), r_n(0, 0, 0);
  for (size_t k = 0; k < vectors.size(); ++k) {
    const auto q = x.q.segment(body.first_dof + dim * vectors[k], dim) / s;
    r_m.head(dim) += t.N_m(0, static_cast<Eigen::Index>(k)) * q;
    r_n.head(dim) += t.N_n(0, static_cast<Eigen::Index>(k)) * q;
  }
  return {0.5 * (r_m.dot(r_m) - 1), 0.5 * (r_n.dot(r_n) - 1), 0.5 * r_m.dot(r_n)};
}

}  // namespace

Surface deformed_surface(const ElementRow& row, const fem::Body& body, const fem::State& x,
                         const fem::ReferencePose& pose, double heating) {
  const Cuts cuts(body);
  const auto [fine_m, fine_n] = row.drawn;
  const std::vector<double> along = fine_lines(cuts.m, fine_m), across = fine_lines(cuts.n, fine_n);
  const std::vector<double> energy = energies(body, cuts, x);
  const int rows = static_cast<int>(across.size());
  const double stretch = thermal_stretch(body, x.t, heating);
  fem::ShapeTable shapes;
  std::vector<double> from;
  Surface out;
  const int dim = body.element->dim();
  out.mesh.dimension = dim;
  out.across = rows - 1;
  for (size_t i = 0; i < along.size(); ++i)
    for (size_t j = 0; j < across.size(); ++j) {
      const Vec2 material(along[i], across[j]);
      const Vec3 r = fem::point_position(body, x, material), before = pose.location(material);
      for (int c = 0; c < dim; ++c) {
        out.mesh.points.push_back(r[c]);
        from.push_back(before[c]);
      }
      if (i + 1 == along.size() || j + 1 == across.size()) continue;
      const int a = static_cast<int>(i) * rows + static_cast<int>(j);
      out.mesh.quads.push_back({a, a + rows, a + rows + 1, a + 1});
      out.middles.push_back(0.5 * Vec2(along[i] + along[i + 1], across[j] + across[j + 1]));
      if (row.draws_strain)
        for (const double each : elastic_strain(body, x, out.middles.back(), stretch, shapes))
          out.strain.push_back(each);
      out.energy.push_back(
          energy[cuts.element(i / static_cast<size_t>(fine_m), j / static_cast<size_t>(fine_n))]);
    }
  SplitDisplacements split = split_displacements(dim, from, out.mesh.points);
  out.motion = std::move(split.motion);
  out.displacement = std::move(split.deformation);
  return out;
}

DesignedSurface designed_surface(const fem::Body& body, const fem::State& x,
                                 const fem::ReferencePose& pose, const Grid& grid,
                                 const VectorXd& density) {
  const Cuts cuts(body);
  const std::vector<double> energy = energies(body, cuts, x);
  const double root = fem::grid_of(body).line_m(0).value;
  const int first = std::max(0, static_cast<int>(std::ceil((root - grid.x0) / grid.dx() - 1e-6)));
  DesignedSurface out;
  std::vector<double> from;
  const int ny = grid.ny;
  for (int i = first; i <= grid.nx; ++i)
    for (int j = 0; j <= ny; ++j) {
      const Vec2 material = grid.node_position(i, j);
      const Vec2 p = fem::point_motion(body, x, material).position;
      const Vec3 before = pose.location(material);
      for (int c = 0; c < 2; ++c) {
        out.mesh.points.push_back(p[c]);
        from.push_back(before[c]);
      }
      if (i == grid.nx || j == ny) continue;
      const int a = (i - first) * (ny + 1) + j;
      out.mesh.quads.push_back({a, a + ny + 1, a + ny + 2, a + 1});
      out.density.push_back(density[grid.cell(i, j)]);
      out.middles.push_back(grid.cell_center(i, j));
      out.energy.push_back(energy[cuts.element_at(out.middles.back())]);
    }
  SplitDisplacements split = split_displacements(2, from, out.mesh.points);
  out.motion = std::move(split.motion);
  out.displacement = std::move(split.deformation);
  return out;
}

double thermal_stretch(const fem::Body& body, double t, double heating) {
  return body.heat ? 1 + body.heat->expansion * heating * body.heat->temperature(t).value : 1;
}

std::vector<double> membrane_stress(const fem::Body& body, const fem::State& x,
                                    std::span<const Vec2> materials, double youngs_modulus,
                                    double poisson_ratio, double stretch) {
  const double plane = youngs_modulus / (1 - poisson_ratio * poisson_ratio),
               shear = youngs_modulus / (1 + poisson_ratio);
  fem::ShapeTable shapes;
  std::vector<double> out;
  out.reserve(materials.size());
  for (const Vec2& material : materials) {
    const Vec3 e = elastic_strain(body, x, material, stretch, shapes);
    const double s_11 = plane * (e[0] + poisson_ratio * e[1]),
                 s_22 = plane * (e[1] + poisson_ratio * e[0]), s_12 = shear * e[2];
    out.push_back(std::sqrt(s_11 * s_11 - s_11 * s_22 + s_22 * s_22 + 3 * s_12 * s_12));
  }
  return out;
}

io::QuadMesh disc_mesh(const fem::FrameMotion& frame, double radius, bool notched) {
  constexpr int kSides = 24;
  io::QuadMesh out;
  out.points = {frame.origin.x(), frame.origin.y()};
  for (int k = 0; k <= kSides; ++k) {
    // The angle runs from -π to π: the first and the last point are at -x.
    const double angle = frame.angle + std::numbers::pi * (2.0 * k / kSides - 1);
    out.points.push_back(frame.origin.x() + radius * std::cos(angle));
    out.points.push_back(frame.origin.y() + radius * std::sin(angle));
  }
  const int left_out = notched ? 2 : 0;
  for (int k = 1 + left_out; k + 2 <= kSides + 1 - left_out; k += 2)
    out.quads.push_back({0, k, k + 1, k + 2});
  return out;
}

double drawn_radius(const Scene& scene, const Hub& hub) {
  double width = 0, length = 0;
  for (const Joint& j : scene.joints) {
    if (j.to != hub.name) continue;
    for (const Body& body : scene.bodies) {
      if (body.name != j.body) continue;
      width = std::max(width, body.width);
      length = std::max(length, body.longest(scene.time.end));
    }
  }
  return width > 0 ? 0.25 * width : 0.02 * length;
}

double drawn_radius(const Scene& scene, const PointMass& mass) {
  const Body& body = scene.body(mass.body);
  return body.width > 0 ? 0.15 * body.width : 0.015 * body.longest(scene.time.end);
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
