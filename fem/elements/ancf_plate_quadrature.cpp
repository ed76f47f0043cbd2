// Gauss points of plate elements, whose weights may contain the scale factors of cells.
#include <algorithm>
#include <array>
#include <cmath>

#include "fem/elements/ancf_plate.h"
#include "fem/elements/plate_shapes.h"

namespace flexmorph::fem {
namespace {

using plate::At;
using plate::at_point;
using plate::function_m;
using plate::function_n;
using plate::kCorners;

/// Common interval of an element and one column (or row) of cells, in local coordinates of the
/// element.
struct Part {
  int cell;
  double lower, upper;  // in [0, 1]
};

/// Returns the first and the last cell that an interval overlaps.
std::array<int, 2> cell_range(double start, double length, double grid_start, double cell,
                              int n_cells) {
  const auto index = [&](double x) {
    return std::clamp(static_cast<int>(std::floor((x - grid_start) / cell)), 0, n_cells - 1);
  };
  // Interval ends and cell borders that differ by round-off only count as equal.
  const double tiny = 1e-12 * cell;
  return {index(start + tiny), index(start + length - tiny)};
}

/// Returns the common intervals of [start, start + length] with the cells of one grid direction.
std::vector<Part> parts(double start, double length, double grid_start, double cell, int n_cells) {
  const auto [first, last] = cell_range(start, length, grid_start, cell, n_cells);
  std::vector<Part> out;
  for (int c = first; c <= last; ++c) {
    const double lower = c == 0 ? start : std::max(start, grid_start + c * cell);
    const double upper =
        c == n_cells - 1 ? start + length : std::min(start + length, grid_start + (c + 1) * cell);
    if (upper > lower) out.push_back({c, (lower - start) / length, (upper - start) / length});
  }
  out.front().lower = 0;
  out.back().upper = 1;
  return out;
}

/// Returns true if a scale factor multiplies the weights.
bool weighted(const ScaleFactors& factors, ScaleFactorKind kind) {
  return kind != ScaleFactorKind::none && !factors.uniform();
}

/// Returns the integrals of the Lagrange polynomials of n Gauss points over subintervals (n_parts x
/// n).
MatrixXd integrals(const std::vector<Part>& parts, int n) {
  MatrixXd out(parts.size(), n);
  for (size_t i = 0; i < parts.size(); ++i)
    out.row(static_cast<Eigen::Index>(i)) = lagrange_integrals(n, parts[i].lower, parts[i].upper);
  return out;
}

/// Returns the number of points per direction for integrands of a degree. With a piecewise constant
/// factor the weights are interpolatory and exact up to degree n - 1 only. gauss() provides at most
/// 16 points; only rational integrands, which have no degree, would need more.
int n_points(int degree, bool weighted) {
  return weighted ? std::min(degree + 1, 16) : degree / 2 + 1;
}

}  // namespace

/// Returns the weights of n x n Gauss points times the scale factor.
MatrixXd AncfPlate::weights(int e, int n, const ScaleFactors& factors, ScaleFactorKind kind) const {
  const Hermite& hm = hermite_m_[static_cast<size_t>(e / n_n())];
  const Hermite& hn = hermite_n_[static_cast<size_t>(e % n_n())];
  const double area = hm.length * hn.length;
  if (!weighted(factors, kind)) {
    const Eigen::Map<const VectorXd> line(gauss(n).weights.data(), n);
    return area * line * line.transpose();
  }
  const Grid& grid = factors.grid;
  const VectorXd& field = kind == ScaleFactorKind::stiffness ? factors.stiffness : factors.mass;
  const std::vector<Part> pm = parts(hm.start, hm.length, grid.x0, grid.dx(), grid.nx);
  const std::vector<Part> pn = parts(hn.start, hn.length, grid.y0, grid.dy(), grid.ny);
  MatrixXd cells(pm.size(), pn.size());
  for (size_t i = 0; i < pm.size(); ++i)
    for (size_t j = 0; j < pn.size(); ++j)
      cells(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j)) =
          field[grid.cell(pm[i].cell, pn[j].cell)];
  return area * integrals(pm, n).transpose() * cells * integrals(pn, n);
}

void AncfPlate::add_cell_integrals(int e, int degree, const VectorXd& values, const Grid& grid,
                                   VectorXd& out) const {
  const int n = n_points(degree, true);
  const Hermite& hm = hermite_m_[static_cast<size_t>(e / n_n())];
  const Hermite& hn = hermite_n_[static_cast<size_t>(e % n_n())];
  const std::vector<Part> pm = parts(hm.start, hm.length, grid.x0, grid.dx(), grid.nx);
  const std::vector<Part> pn = parts(hn.start, hn.length, grid.y0, grid.dy(), grid.ny);
  // Points are numbered along m first.
  const Eigen::Map<const Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>>
      points(values.data(), n, n);
  const MatrixXd cells =
      hm.length * hn.length * integrals(pm, n) * points * integrals(pn, n).transpose();
  for (size_t i = 0; i < pm.size(); ++i)
    for (size_t j = 0; j < pn.size(); ++j)
      out[grid.cell(pm[i].cell, pn[j].cell)] +=
          cells(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j));
}

CellRange AncfPlate::cells(int e, const Grid& grid) const {
  const Hermite& hm = hermite_m_[static_cast<size_t>(e / n_n())];
  const Hermite& hn = hermite_n_[static_cast<size_t>(e % n_n())];
  const auto [i0, i1] = cell_range(hm.start, hm.length, grid.x0, grid.dx(), grid.nx);
  const auto [j0, j1] = cell_range(hn.start, hn.length, grid.y0, grid.dy(), grid.ny);
  return {i0, i1 + 1, j0, j1 + 1, hm.length * hn.length};
}

void AncfPlate::tabulate(int e, int degree, Tabulate what, const ScaleFactors& factors,
                         ScaleFactorKind kind, ShapeTable& out) const {
  const int n = n_points(degree, weighted(factors, kind));
  const GaussRule& rule = gauss(n);
  fill(e, rule.points, rule.points, what, out);
  const Eigen::MatrixXd w = weights(e, n, factors, kind);
  for (int g = 0; g < n; ++g)
    for (int h = 0; h < n; ++h) out.weight[g * n + h] = w(g, h);
}

bool AncfPlate::tabulate_products(int e, int degree, const ScaleFactors& factors,
                                  ScaleFactorKind kind, ProductTable& out) const {
  const int n = n_points(degree, weighted(factors, kind));
  out.weight = weights(e, n, factors, kind);
  const auto line = [&](const Hermite& h, MatrixXd& f, MatrixXd& d, MatrixXd& dd) {
    f.resize(n, 4);
    d.resize(n, 4);
    dd.resize(out.curvature ? n : 0, 4);
    for (int g = 0; g < n; ++g) {
      const At point = at_point(h, gauss(n).points[static_cast<size_t>(g)], false, out.curvature);
      f.row(g) = point.f;
      d.row(g) = point.d;
      if (out.curvature) dd.row(g) = point.dd;
    }
  };
  line(hermite_m_[static_cast<size_t>(e / n_n())], out.f_m, out.d_m, out.dd_m);
  line(hermite_n_[static_cast<size_t>(e % n_n())], out.f_n, out.d_n, out.dd_n);
  out.function_m.clear();
  out.function_n.clear();
  for (const auto& [a, b] : kCorners)
    for (int k = 0; k < per_node_; ++k) {
      out.function_m.push_back(function_m(a, k));
      out.function_n.push_back(function_n(b, k));
    }
  return true;
}

}  // namespace flexmorph::fem
