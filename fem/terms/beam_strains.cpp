#include "fem/terms/beam_strains.h"

#include <array>

namespace flexmorph::fem {
namespace {

constexpr Eigen::Index kShapes = 6;
using Vectors = Eigen::Matrix<double, kShapes, 2, Eigen::RowMajor>;
using Row = Eigen::Matrix<double, 1, kShapes>;

/// Axes of a section: e₂ along the section, e₁ perpendicular to it.
struct Axes {
  Vec2 e1, e2;
  explicit Axes(const Vec2& across) : e1(0, 0), e2(across.normalized()) { e1 = {e2.y(), -e2.x()}; }
};

/// Returns the matrix that gives the components along the axes of a tensor with the components
/// (c₁₁, c₂₂, 2c₁₂) in space.
Eigen::Matrix3d turned(const Axes& a) {
  const Vec2 &u = a.e1, &v = a.e2;
  Eigen::Matrix3d out;
  out << u.x() * u.x(), u.y() * u.y(), u.x() * u.y(),  //
      v.x() * v.x(), v.y() * v.y(), v.x() * v.y(),     //
      2 * u.x() * v.x(), 2 * u.y() * v.y(), u.x() * v.y() + u.y() * v.x();
  return out;
}

using OfSamples = BeamStrainPoints::OfSamples;
constexpr Eigen::Index kSamples = BeamStrainPoints::kSamples;

/// Returns the interpolation of the strains, component by component.
OfSamples interpolation(double xi) {
  const std::array<double, 3> parabola = {(1 - xi) * (1 - 2 * xi), 4 * xi * (1 - xi),
                                          xi * (2 * xi - 1)},
                              line = {1 - xi, 0, xi};
  OfSamples out = OfSamples::Zero();
  for (Eigen::Index k = 0; k < kSamples; ++k) {
    out(0, 3 * k) = out(2, 3 * k + 2) = parabola[static_cast<size_t>(k)];
    out(1, 3 * k + 1) = line[static_cast<size_t>(k)];
  }
  return out;
}

/// Uniform strains at the samples, and the uniform strain fitted to samples.
struct Uniform {
  Eigen::Matrix<double, 3 * kSamples, 3> at_samples;
  OfSamples fit;

  explicit Uniform(const std::array<Axes, 3>& samples) {
    for (Eigen::Index k = 0; k < kSamples; ++k)
      at_samples.middleRows<3>(3 * k) = turned(samples[static_cast<size_t>(k)]);
    at_samples.row(3 + 1).setZero();  // ε₂₂ is not sampled in the middle
    const Eigen::Matrix3d normal = at_samples.transpose() * at_samples;
    fit = normal.inverse() * at_samples.transpose();
  }
};

/// Returns the matrix that gives ε̄(x) from the samples.
OfSamples assumed(double xi, const Axes& axes, const Uniform& uniform) {
  constexpr double kRoundOff = 1e-14;
  OfSamples by_components = interpolation(xi);
  const Eigen::Matrix3d missed = turned(axes) - by_components * uniform.at_samples;
  // The sections do not rotate.
  if (missed.lpNorm<Eigen::Infinity>() < kRoundOff) return by_components;
  return by_components + missed * uniform.fit;
}

/// Returns the derivatives along the axes at a node; the gradients X_x, X_y there are vectors of
/// the node.
std::array<Row, 2> at_node(const Vectors& X, Eigen::Index first, const Axes& axes) {
  Eigen::Matrix2d J;  // (X_x X_y)
  J << X.row(first + 1).transpose(), X.row(first + 2).transpose();
  const Eigen::Matrix2d inverse = J.inverse();
  std::array<Row, 2> out = {Row::Zero(), Row::Zero()};
  out[0].segment<2>(first + 1) = inverse * axes.e1;
  out[1].segment<2>(first + 1) = inverse * axes.e2;
  return out;
}

void set_row(const ShapeTable& from, Eigen::Index p, const Axes& axes, Eigen::Index to,
             BeamStrainPoints& out) {
  out.d_1.row(to) = axes.e1.x() * from.N_m.row(p) + axes.e1.y() * from.N_n.row(p);
  out.d_2.row(to) = axes.e2.x() * from.N_m.row(p) + axes.e2.y() * from.N_n.row(p);
}

/// Returns the section of every point; consecutive points with equal x form a section.
std::vector<Eigen::Index> sections_of(const ShapeTable& t) {
  std::vector<Eigen::Index> out;
  for (size_t p = 0; p < t.material.size(); ++p)
    out.push_back(p == 0 ? 0 : out.back() + (t.material[p].x() != t.material[p - 1].x()));
  return out;
}

}  // namespace

BeamStrainPoints beam_strain_points(const Element& element, int e, const ScaleFactors& factors,
                                    const MatrixXd& reference) {
  const auto numbers = element.vectors(e);
  Vectors X;
  for (Eigen::Index k = 0; k < kShapes; ++k)
    X.row(k) = reference.row(numbers[static_cast<size_t>(k)]);
  const std::vector<double> nodes = element.lines()[0];
  const double start = nodes[static_cast<size_t>(e)],
               length = nodes[static_cast<size_t>(e) + 1] - start;
  const Vec2 X_y1 = X.row(2), X_y2 = X.row(5);
  const std::array<Axes, 3> at_samples = {Axes(X_y1), Axes(X_y1 + X_y2), Axes(X_y2)};
  const Uniform uniform(at_samples);

  ShapeTable t, axis;
  element.tabulate(e, 8, Tabulate::gradient, factors, ScaleFactorKind::stiffness, t);
  BeamStrainPoints out;
  out.weight = t.weight;
  out.section = sections_of(t);
  const Eigen::Index n_sections = out.section.back() + 1, n = out.n_points();
  out.area.assign(static_cast<size_t>(n_sections), 0);
  out.d_1.setZero(n + n_sections + kSamples, kShapes);
  out.d_2.setZero(n + n_sections + kSamples, kShapes);
  for (Eigen::Index first = 0, last = 0, s = 0; first < n; first = last, ++s) {
    while (last < n && out.section[static_cast<size_t>(last)] == s) ++last;
    const Axes axes(((t.N.row(last - 1) - t.N.row(first)) * X).transpose());
    for (Eigen::Index p = first; p < last; ++p) {
      set_row(t, p, axes, p, out);
      out.area[static_cast<size_t>(s)] += t.weight[p];
    }
    const double x = t.material[static_cast<size_t>(first)].x();
    element.locate({x, 0}, Tabulate::gradient, axis);
    set_row(axis, 0, axes, out.on_axis(s), out);
    out.assumed.push_back(assumed((x - start) / length, axes, uniform));
  }
  for (const Eigen::Index k : {0, 2}) {
    const auto rows = at_node(X, k == 0 ? 0 : 3, at_samples[static_cast<size_t>(k)]);
    out.d_1.row(out.sample(k)) = rows[0];
    out.d_2.row(out.sample(k)) = rows[1];
  }
  element.locate({start + length / 2, 0}, Tabulate::gradient, axis);
  set_row(axis, 0, at_samples[1], out.sample(1), out);
  return out;
}

}  // namespace flexmorph::fem
