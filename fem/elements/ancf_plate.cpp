#include "fem/elements/ancf_plate.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "fem/elements/plate_shapes.h"

namespace flexmorph::fem {
namespace {

using plate::At;
using plate::at_point;
using plate::function_m;
using plate::function_n;
using plate::kCorners;

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

}  // namespace

AncfPlate::AncfPlate(int dim, ShapeSet shapes, std::vector<MaterialLine> m,
                     std::vector<MaterialLine> n, double t)
    : LineGrid(Kind<AncfPlate>{}),
      per_node_(vectors_per_node(shapes)),
      shapes_(shapes),
      m_(std::move(m)),
      n_(std::move(n)) {
  if (m_.size() < 2 || n_.size() < 2)
    throw Error::input("ancf_plate: there must be at least one element in each direction");
  for (int i = 0; i < n_m(); ++i)
    for (int j = 0; j < n_n(); ++j)
      for (const int corner : {node(i, j), node(i + 1, j), node(i + 1, j + 1), node(i, j + 1)})
        for (int k = 0; k < per_node_; ++k) vectors_.push_back(per_node_ * corner + k);
  number_eulerian_lines();
  set_sizes({.dim = dim,
             .n_shapes = 4 * per_node_,
             .n_elements = n_m() * n_n(),
             .n_vectors = per_node_ * n_nodes(),
             .n_scalars = static_cast<int>(free_.size())});
  move_to(t);
}

void AncfPlate::move_to(double t) {
  t_ = t;
  const auto degree = shapes_ == ShapeSet::q4 ? Hermite::Degree::linear : Hermite::Degree::cubic;
  size_t next_free = 0;
  const auto location = [&](const std::vector<MaterialLine>& lines, std::vector<Motion>& at,
                            std::vector<Hermite>& hermite) {
    at.clear();
    hermite.clear();
    for (const MaterialLine& line : lines)
      at.push_back(line.free ? free_[next_free++] : motion_of(line, t));
    for (size_t i = 0; i + 1 < at.size(); ++i) {
      if (!(at[i + 1].value > at[i].value))
        throw Error::numerical("ancf_plate: material lines " + std::to_string(i) + " and " +
                               std::to_string(i + 1) + " cross at t = " + std::to_string(t) + " s");
      hermite.emplace_back(at[i], at[i + 1], degree);
    }
  };
  location(m_, at_m_, hermite_m_);
  location(n_, at_n_, hermite_n_);
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
  MatrixXd q = MatrixXd::Zero(n_vectors(), dim());
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
