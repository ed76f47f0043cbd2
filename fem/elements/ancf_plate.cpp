#include "fem/elements/ancf_plate.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "fem/elements/plate_shapes.h"

namespace flexmorph::fem {
namespace {

using plate::function_m;
using plate::function_n;
using plate::kCorners;
using plate::powers;
using plate::Row4;

/// Values of a Hermite interval at one point: a row of four functions per derivative.
struct At {
  Row4 f, d, dd;              // value, derivatives by X
  Row4 f_t, f_tt, d_t, dd_t;  // rates at fixed material point
};

At at_point(const Hermite& h, double s, bool rates, bool curvature = false) {
  const Row4 p = powers(s);
  At out;
  out.f = p * h.value.transpose();
  out.d = p * derivative(h.value).transpose() / h.length;
  if (curvature)
    out.dd = p * derivative(derivative(h.value)).transpose() / (h.length * h.length);
  else
    out.dd.setZero();
  if (rates) {
    out.f_t = p * h.rate.transpose();
    out.f_tt = p * h.acceleration.transpose();
    out.d_t = p * derivative(h.rate).transpose() / h.length;
  } else {
    out.f_t.setZero();
    out.f_tt.setZero();
    out.d_t.setZero();
  }
  if (rates && curvature)
    out.dd_t = p * derivative(derivative(h.rate)).transpose() / (h.length * h.length);
  else
    out.dd_t.setZero();
  return out;
}

Motion motion_of(const MaterialLine& line, double t) {
  return line.drive ? line.drive(t) : Motion{line.value, 0, 0};
}

int vectors_per_node(AncfPlate::ShapeSet shapes) {
  switch (shapes) {
    case AncfPlate::ShapeSet::q4:
      return 1;
    case AncfPlate::ShapeSet::h12:
      return 3;
    case AncfPlate::ShapeSet::h16:
      return 4;
  }
  return 0;
}

/// Parts of [start, start + length] cut by the cells of one grid direction, as local intervals.
struct Part {
  int cell;
  double lower, upper;  // in [0, 1]
};

/// First and last of the cells that an interval lies in.
std::array<int, 2> cell_range(double start, double length, double grid_start, double cell,
                              int n_cells) {
  const auto index = [&](double x) {
    return std::clamp(static_cast<int>(std::floor((x - grid_start) / cell)), 0, n_cells - 1);
  };
  // A thousandth of a billionth of a cell: cut lines that coincide up to round-off are one line.
  const double tiny = 1e-12 * cell;
  return {index(start + tiny), index(start + length - tiny)};
}

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

}  // namespace

AncfPlate::AncfPlate(int dim, ShapeSet shapes, std::vector<MaterialLine> m,
                     std::vector<MaterialLine> n, double t)
    : dim_(dim),
      per_node_(vectors_per_node(shapes)),
      shapes_(shapes),
      m_(std::move(m)),
      n_(std::move(n)) {
  if (m_.size() < 2 || n_.size() < 2)
    throw Error::input("ancf_plate: at least one element each way");
  for (int i = 0; i < n_m(); ++i)
    for (int j = 0; j < n_n(); ++j)
      for (const int corner : {node(i, j), node(i + 1, j), node(i + 1, j + 1), node(i, j + 1)})
        for (int k = 0; k < per_node_; ++k) vectors_.push_back(per_node_ * corner + k);
  number_free_lines();
  move_to(t);
}

void AncfPlate::move_to(double t) {
  t_ = t;
  const auto degree = shapes_ == ShapeSet::q4 ? Hermite::Degree::linear : Hermite::Degree::cubic;
  size_t next_free = 0;
  const auto place = [&](const std::vector<MaterialLine>& lines, std::vector<Motion>& at,
                         std::vector<Hermite>& hermite) {
    at.clear();
    hermite.clear();
    for (const MaterialLine& line : lines)
      at.push_back(line.free ? free_[next_free++] : motion_of(line, t));
    for (size_t i = 0; i + 1 < at.size(); ++i) {
      if (!(at[i + 1].value > at[i].value))
        throw Error::numerical("ancf_plate: material lines " + std::to_string(i) + " and " +
                               std::to_string(i + 1) + " cross at t = " + std::to_string(t));
      hermite.emplace_back(at[i], at[i + 1], degree);
    }
  };
  place(m_, at_m_, hermite_m_);
  place(n_, at_n_, hermite_n_);
}

std::span<const int> AncfPlate::vectors(int e) const {
  return {vectors_.data() + static_cast<size_t>(e) * static_cast<size_t>(n_shapes()),
          static_cast<size_t>(n_shapes())};
}

double AncfPlate::scale(int k) const {
  const int i = k / per_node_ / (n_n() + 1), j = k / per_node_ % (n_n() + 1), kind = k % per_node_;
  const auto reach = [](const std::vector<Hermite>& h, int at) {
    return h[static_cast<size_t>(std::min<int>(at, static_cast<int>(h.size()) - 1))].length;
  };
  return (kind == 1 || kind == 3 ? reach(hermite_m_, i) : 1.0) *
         (kind == 2 || kind == 3 ? reach(hermite_n_, j) : 1.0);
}

MatrixXd AncfPlate::reference() const {
  MatrixXd q = MatrixXd::Zero(n_vectors(), dim_);
  for (int i = 0; i <= n_m(); ++i)
    for (int j = 0; j <= n_n(); ++j) {
      const int first = per_node_ * node(i, j);
      q(first, 0) = line_m(i).value;
      q(first, 1) = line_n(j).value;
      if (per_node_ == 1) continue;
      q(first + 1, 0) = 1;
      q(first + 2, 1) = 1;
    }
  return q;
}

NodeVectors AncfPlate::vectors_of(int i, int j) const {
  const int first = per_node_ * node(i, j);
  const bool slopes = per_node_ > 1;
  return {first,
          slopes ? first + 1 : -1,
          slopes ? first + 2 : -1,
          shapes_ == ShapeSet::h16 ? first + 3 : -1,
          Vec2(line_m(i).value, line_n(j).value),
          m_[static_cast<size_t>(i)].drive || n_[static_cast<size_t>(j)].drive};
}

std::vector<NodeVectors> AncfPlate::edge(const std::string& name) const {
  std::vector<NodeVectors> out;
  int line = -1;
  if (name == "root" || name == "free_end") {
    for (int j = 0; j <= n_n(); ++j) out.push_back(vectors_of(name == "root" ? 0 : n_m(), j));
  } else if (std::sscanf(name.c_str(), "line %d", &line) == 1 && line >= 0 && line <= n_m()) {
    for (int j = 0; j <= n_n(); ++j) out.push_back(vectors_of(line, j));
  } else if (name == "side_low" || name == "side_high") {
    for (int i = 0; i <= n_m(); ++i) out.push_back(vectors_of(i, name == "side_low" ? 0 : n_n()));
  } else {
    throw Error::input("edge '" + name +
                       "': a plate has the edges 'root', 'free_end', 'side_low', 'side_high' and "
                       "'line 0' to 'line " +
                       std::to_string(n_m()) + "'");
  }
  return out;
}

std::vector<NodeVectors> AncfPlate::nodes() const {
  std::vector<NodeVectors> out;
  for (int i = 0; i <= n_m(); ++i)
    for (int j = 0; j <= n_n(); ++j) out.push_back(vectors_of(i, j));
  return out;
}

bool AncfPlate::moving(int e) const {
  const auto driven = [](const std::vector<MaterialLine>& lines, int i) {
    const MaterialLine &one = lines[static_cast<size_t>(i)],
                       &other = lines[static_cast<size_t>(i + 1)];
    return one.drive || one.free || other.drive || other.free;
  };
  return driven(m_, e / n_n()) || driven(n_, e % n_n());
}

void AncfPlate::fill(int e, std::span<const double> s, std::span<const double> u, Tabulate what,
                     ShapeTable& out) const {
  const Hermite& hm = hermite_m_[static_cast<size_t>(e / n_n())];
  const Hermite& hn = hermite_n_[static_cast<size_t>(e % n_n())];
  const bool rates = (what == Tabulate::position_rates || what == Tabulate::gradient_rates ||
                      what == Tabulate::curvature_rates) &&
                     moving(e);
  const bool curvature = what == Tabulate::curvature || what == Tabulate::curvature_rates;
  const bool gradient = what == Tabulate::gradient || what == Tabulate::gradient_rates || curvature;
  const auto n_points = static_cast<Eigen::Index>(s.size() * u.size());
  const auto size = [&](MatrixXd& x, bool wanted) {
    if (wanted)
      x.resize(n_points, n_shapes());
    else
      x.resize(0, 0);
  };
  out.weight.resize(n_points);
  out.material.resize(static_cast<size_t>(n_points));
  size(out.N, true);
  size(out.N_t, rates);
  size(out.N_tt, rates);
  size(out.N_m, gradient);
  size(out.N_n, gradient);
  size(out.N_mt, gradient && rates);
  size(out.N_nt, gradient && rates);
  size(out.N_mm, curvature);
  size(out.N_nn, curvature);
  size(out.N_mn, curvature);
  size(out.N_mmt, curvature && rates);
  size(out.N_nnt, curvature && rates);
  size(out.N_mnt, curvature && rates);

  Eigen::Index p = 0;
  for (const double si : s) {
    const At m = at_point(hm, si, rates, curvature);
    for (const double uj : u) {
      const At n = at_point(hn, uj, rates, curvature);
      out.material[static_cast<size_t>(p)] = {hm.start + si * hm.length, hn.start + uj * hn.length};
      int column = 0;
      for (const auto& [a, b] : kCorners)
        for (int k = 0; k < per_node_; ++k, ++column) {
          const int i = function_m(a, k), j = function_n(b, k);
          out.N(p, column) = m.f[i] * n.f[j];
          if (rates) {
            out.N_t(p, column) = m.f_t[i] * n.f[j] + m.f[i] * n.f_t[j];
            out.N_tt(p, column) = m.f_tt[i] * n.f[j] + 2 * m.f_t[i] * n.f_t[j] + m.f[i] * n.f_tt[j];
          }
          if (gradient) {
            out.N_m(p, column) = m.d[i] * n.f[j];
            out.N_n(p, column) = m.f[i] * n.d[j];
          }
          if (curvature) {
            out.N_mm(p, column) = m.dd[i] * n.f[j];
            out.N_nn(p, column) = m.f[i] * n.dd[j];
            out.N_mn(p, column) = m.d[i] * n.d[j];
          }
          if (gradient && rates) {
            out.N_mt(p, column) = m.d_t[i] * n.f[j] + m.d[i] * n.f_t[j];
            out.N_nt(p, column) = m.f_t[i] * n.d[j] + m.f[i] * n.d_t[j];
          }
          if (curvature && rates) {
            out.N_mmt(p, column) = m.dd_t[i] * n.f[j] + m.dd[i] * n.f_t[j];
            out.N_nnt(p, column) = m.f_t[i] * n.dd[j] + m.f[i] * n.dd_t[j];
            out.N_mnt(p, column) = m.d_t[i] * n.d[j] + m.d[i] * n.d_t[j];
          }
        }
      ++p;
    }
  }
}

namespace {

/// Is there a factor to weight points with?
bool weighted(const Factors& factors, FactorKind kind) {
  return kind != FactorKind::none && !factors.uniform();
}

/// Integrals of Lagrange's polynomials at n Gauss points over parts of an interval (parts x n).
MatrixXd integrals(const std::vector<Part>& parts, int n) {
  MatrixXd out(parts.size(), n);
  for (size_t i = 0; i < parts.size(); ++i)
    out.row(static_cast<Eigen::Index>(i)) = lagrange_integrals(n, parts[i].lower, parts[i].upper);
  return out;
}

/// Points per direction for integrands of a degree: with a stepwise factor the weights are
/// interpolatory, exact up to degree n - 1 only. Sixteen are the most there are (gauss()); only
/// what is rational, and has no degree, asks for more.
int n_points(int degree, bool weighted) {
  return weighted ? std::min(degree + 1, 16) : degree / 2 + 1;
}

}  // namespace

/// Weights of n x n Gauss points, times the factor.
MatrixXd AncfPlate::weights(int e, int n, const Factors& factors, FactorKind kind) const {
  const Hermite& hm = hermite_m_[static_cast<size_t>(e / n_n())];
  const Hermite& hn = hermite_n_[static_cast<size_t>(e % n_n())];
  const double area = hm.length * hn.length;
  if (!weighted(factors, kind)) {
    const Eigen::Map<const VectorXd> line(gauss(n).weights.data(), n);
    return area * line * line.transpose();
  }
  const Grid& grid = factors.grid;
  const VectorXd& field = kind == FactorKind::stiffness ? factors.stiffness : factors.mass;
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

Element::CellRange AncfPlate::cells(int e, const Grid& grid) const {
  const Hermite& hm = hermite_m_[static_cast<size_t>(e / n_n())];
  const Hermite& hn = hermite_n_[static_cast<size_t>(e % n_n())];
  const auto [i0, i1] = cell_range(hm.start, hm.length, grid.x0, grid.dx(), grid.nx);
  const auto [j0, j1] = cell_range(hn.start, hn.length, grid.y0, grid.dy(), grid.ny);
  return {i0, i1 + 1, j0, j1 + 1, hm.length * hn.length};
}

void AncfPlate::tabulate(int e, int degree, Tabulate what, const Factors& factors, FactorKind kind,
                         ShapeTable& out) const {
  const int n = n_points(degree, weighted(factors, kind));
  const GaussRule& rule = gauss(n);
  fill(e, rule.points, rule.points, what, out);
  const Eigen::MatrixXd w = weights(e, n, factors, kind);
  for (int g = 0; g < n; ++g)
    for (int h = 0; h < n; ++h) out.weight[g * n + h] = w(g, h);
}

bool AncfPlate::tabulate_products(int e, int degree, const Factors& factors, FactorKind kind,
                                  ProductTable& out) const {
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

void AncfPlate::at(int e, double s, double u, Tabulate what, ShapeTable& out) const {
  fill(e, {&s, 1}, {&u, 1}, what, out);
  out.weight[0] = 1;
}

int AncfPlate::locate(const Vec2& material, Tabulate what, ShapeTable& out) const {
  const auto interval = [](const std::vector<Motion>& lines, double x) {
    const auto end =
        std::lower_bound(lines.begin() + 1, lines.end() - 1, x,
                         [](const Motion& line, double at) { return line.value < at; });
    return static_cast<int>(end - lines.begin()) - 1;
  };
  const auto local = [](const Hermite& h, double x) {
    const double s = (x - h.start) / h.length;
    if (s < -1e-9 || s > 1 + 1e-9)
      throw Error::input("material point " + std::to_string(x) + " m lies outside the plate");
    return std::clamp(s, 0.0, 1.0);
  };
  const int i = interval(at_m_, material.x()), j = interval(at_n_, material.y());
  at(element(i, j), local(hermite_m_[static_cast<size_t>(i)], material.x()),
     local(hermite_n_[static_cast<size_t>(j)], material.y()), what, out);
  return element(i, j);
}

}  // namespace flexmorph::fem
