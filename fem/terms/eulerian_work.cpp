#include "fem/terms/eulerian_work.h"

#include <cmath>

namespace flexmorph::fem {

namespace {

constexpr int kLengths = 2;  // a, b; the energy of uniform material depends only on them

/// Return ∂a/∂p_l or ∂b/∂p_l, and the number of the length, a or b, that depends on p_l.
constexpr double sign(int l) { return l == kM1 || l == kN1 ? -1 : 1; }
constexpr int length_of(int l) { return l / 2; }

}  // namespace

void check_fixed(const Element& element, int e, const Vec2& material) {
  EulerianTable t;
  element.tabulate_eulerian(e, 0, Tabulate::position, t);
  // A point between two lines moves through the element if one of them moves.
  const auto on = [](double x, double line, double size) {
    return std::abs(x - line) < 1e-9 * size;
  };
  const bool at_m1 = on(material.x(), t.side[kM1].value, t.a()),
             at_m2 = on(material.x(), t.side[kM2].value, t.a()),
             at_n1 = on(material.y(), t.side[kN1].value, t.b()),
             at_n2 = on(material.y(), t.side[kN2].value, t.b());
  const auto fixed = [&](Side s) { return t.unknown[s] < 0; };
  const bool m_stays = (fixed(kM1) && fixed(kM2)) || (at_m1 && fixed(kM1)) || (at_m2 && fixed(kM2));
  const bool n_stays = (fixed(kN1) && fixed(kN2)) || (at_n1 && fixed(kN1)) || (at_n2 && fixed(kN2));
  if (!m_stays || !n_stays)
    throw Error::input(
        "material point (" + std::to_string(material.x()) + ", " + std::to_string(material.y()) +
        ") m: a point next to a free material line can only be loaded if it is on a fixed line");
}

void EulerianTables::prepare(const Element& element, int degree, Tabulate what,
                             const ScaleFactors& factors) {
  if (element.n_scalars() == 0) {
    index_.clear();
    return;
  }
  if (!factors.uniform())
    throw Error::input("a body with free material lines must have uniform material");
  index_.assign(static_cast<size_t>(element.n_elements()), -1);
  int n = 0;
  for (int e = 0; e < element.n_elements(); ++e)
    if (!element.free_sides(e).empty()) index_[static_cast<size_t>(e)] = n++;
  tables_.resize(static_cast<size_t>(n));
  for (int e = 0; e < element.n_elements(); ++e)
    if (has(e))
      element.tabulate_eulerian(e, degree, what,
                                tables_[static_cast<size_t>(index_[static_cast<size_t>(e)])]);
}

/// Measures at one point and their derivatives with respect to the lengths of the element.
struct EulerianElastic::Point {
  double weight = 0;
  Measures z;
  Measures by[kLengths];                // ∂z/∂a, ∂z/∂b at fixed local coordinates
  Measures by_two[kLengths][kLengths];  // second derivatives
  // Coefficients of the unknowns in z, and in ∂z/∂a, ∂z/∂b.
  Eigen::Matrix<double, kMaxMeasures, kMaxShapes> rows, rows_by[kLengths];
};

void EulerianElastic::measure(Eigen::Index g, const LocalRows& q, Point& out) const {
  const auto list = density_.measures();
  const auto n = static_cast<Eigen::Index>(list.size()), d = q.cols();
  const double length[kLengths] = {table_.a(), table_.b()};
  out.weight = table_.at.weight[g];
  out.z.setZero(n, d);
  for (int A = 0; A < kLengths; ++A) {
    out.by[A].setZero(n, d);
    for (int B = 0; B < kLengths; ++B) out.by_two[A][B].setZero(n, d);
  }
  for (Eigen::Index i = 0; i < n; ++i) {
    const Measure& m = list[static_cast<size_t>(i)];
    const MatrixXd& table = table_of(table_.at, m);
    for (Eigen::Index k = 0; k < q.rows(); ++k) {
      const double t = table(g, k);
      const double growth[kLengths] = {
          table_.growth(kM2, static_cast<int>(k), m.m_order, m.n_order),
          table_.growth(kN2, static_cast<int>(k), m.m_order, m.n_order)};
      out.rows(i, k) = t;
      out.z.row(i) += t * q.row(k);
      for (int A = 0; A < kLengths; ++A) {
        out.rows_by[A](i, k) = growth[A] * t;
        out.by[A].row(i) += growth[A] * t * q.row(k);
        for (int B = 0; B < kLengths; ++B) {
          const double second = growth[A] * (growth[B] - (A == B ? 1 / length[A] : 0));
          out.by_two[A][B].row(i) += second * t * q.row(k);
        }
      }
    }
  }
}

double EulerianElastic::energy(const LocalRows& q) const {
  Point point;
  double out = 0;
  for (Eigen::Index g = 0; g < table_.at.weight.size(); ++g) {
    measure(g, q, point);
    out += point.weight * density_.energy(point.z, nullptr, nullptr);
  }
  return out;
}

void EulerianElastic::add_force(const LocalRows& q, EulerianForce& force) const {
  const auto n = q.rows(), d = q.cols();
  const double length[kLengths] = {table_.a(), table_.b()};
  Point point;
  Measures stress;
  for (Eigen::Index g = 0; g < table_.at.weight.size(); ++g) {
    measure(g, q, point);
    const double energy = density_.energy(point.z, &stress, nullptr);
    for (Eigen::Index k = 0; k < n; ++k)
      for (Eigen::Index i = 0; i < stress.rows(); ++i)
        force.segment(d * k, d) += point.weight * point.rows(i, k) * stress.row(i).transpose();
    for (int l = 0; l < kSides; ++l) {
      const int A = length_of(l);
      force[n * d + l] +=
          sign(l) * point.weight * (energy / length[A] + stress.cwiseProduct(point.by[A]).sum());
    }
  }
}

void EulerianElastic::add_tangent(const LocalRows& q, double scale,
                                  EulerianTangent& tangent) const {
  const auto n = q.rows(), d = q.cols();
  const double length[kLengths] = {table_.a(), table_.b()};
  Point point;
  Measures stress;
  MeasureHessian hessian;
  Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor, kMaxMeasures * kMaxDim,
                kMaxFree>
      variation;  // derivatives of z by the shape unknowns, then by the four lines
  EulerianTangent product;
  for (Eigen::Index g = 0; g < table_.at.weight.size(); ++g) {
    measure(g, q, point);
    const double energy = density_.energy(point.z, &stress, &hessian);
    const double w = scale * point.weight;
    const Eigen::Index n_z = stress.rows();
    variation.setZero(n_z * d, n * d + kSides);
    for (Eigen::Index i = 0; i < n_z; ++i)
      for (Eigen::Index c = 0; c < d; ++c) {
        for (Eigen::Index k = 0; k < n; ++k) variation(d * i + c, d * k + c) = point.rows(i, k);
        for (int l = 0; l < kSides; ++l)
          variation(d * i + c, n * d + l) = sign(l) * point.by[length_of(l)](i, c);
      }
    tangent.noalias() += w * (variation.transpose() * (hessian * variation));
    // Work of the stress on the second variations, and the change of the area.
    for (int l = 0; l < kSides; ++l) {
      const int A = length_of(l);
      for (Eigen::Index k = 0; k < n; ++k)
        for (Eigen::Index c = 0; c < d; ++c) {
          double sum = 0;
          for (Eigen::Index i = 0; i < n_z; ++i)
            sum += (point.rows_by[A](i, k) + point.rows(i, k) / length[A]) * stress(i, c);
          tangent(d * k + c, n * d + l) += sign(l) * w * sum;
          tangent(n * d + l, d * k + c) += sign(l) * w * sum;
        }
      for (int j = 0; j < kSides; ++j) {
        const int B = length_of(j);
        const double area = A == B ? 0 : energy / (length[A] * length[B]);
        tangent(n * d + l, n * d + j) +=
            sign(l) * sign(j) * w *
            (area + stress.cwiseProduct(point.by[B]).sum() / length[A] +
             stress.cwiseProduct(point.by[A]).sum() / length[B] +
             stress.cwiseProduct(point.by_two[A][B]).sum());
      }
    }
  }
}

namespace {

// Entries behind the dimension are zero. The size is that of a vector register, because GCC 12
// otherwise warns of loads that never happen.
using Row = Eigen::Matrix<double, 1, 8>;
using Shapes = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, kMaxShapes>;

/// Returns Σ_k table_gk q_k.
Row at_point(const MatrixXd& table, Eigen::Index g, const LocalRows& q) {
  Row out = Row::Zero();
  for (Eigen::Index k = 0; k < q.rows(); ++k)
    for (Eigen::Index c = 0; c < q.cols(); ++c) out[c] += table(g, k) * q(k, c);
  return out;
}

/// Position, velocity, derivatives of the position by the lines, and the material acceleration
/// minus gravity, at a point.
struct Moving {
  Row r, velocity, load;
  std::array<Row, kSides> by_line;
};

Moving moving(const EulerianTable& t, Eigen::Index g, const Local& x, const VectorXd& gravity,
              bool has_inertia) {
  Moving out;
  out.r = at_point(t.at.N, g, x.q);
  out.velocity = at_point(t.at.N, g, x.v);
  out.load = has_inertia ? at_point(t.at.N, g, x.a) : Row::Zero();
  if (gravity.size() > 0) out.load.head(gravity.size()) -= gravity.transpose();
  for (int l = 0; l < kSides; ++l) {
    const auto i = static_cast<size_t>(l);
    out.by_line[i] = at_point(t.N_p[i], g, x.q);
    out.velocity += t.side[i].rate * out.by_line[i];
    if (!has_inertia) continue;
    out.load += 2 * t.side[i].rate * at_point(t.N_p[i], g, x.v);
    out.load += t.side[i].acceleration * out.by_line[i];
    for (int k = 0; k < kSides; ++k) {
      const double rates = t.side[i].rate * t.side[static_cast<size_t>(k)].rate;
      if (rates != 0) out.load += rates * at_point(t.second(l, k), g, x.q);
    }
  }
  return out;
}

/// Return the numbers of m- and of n-derivatives that a derivative by line l adds.
constexpr int m_orders(int l) { return l <= kM2; }
constexpr int n_orders(int l) { return l >= kN1; }

}  // namespace

double EulerianInertia::kinetic_energy(const EulerianTable& t, const Local& x) const {
  double out = 0;
  if (!has_inertia_) return out;
  for (Eigen::Index g = 0; g < t.at.weight.size(); ++g)
    out += 0.5 * density_ * t.at.weight[g] * moving(t, g, x, gravity_, true).velocity.squaredNorm();
  return out;
}

Vec3 EulerianInertia::momentum(const EulerianTable& t, const Local& x) const {
  Vec3 out = Vec3::Zero();
  if (!has_inertia_) return out;
  for (Eigen::Index g = 0; g < t.at.weight.size(); ++g) {
    const Moving at = moving(t, g, x, gravity_, true);
    for (Eigen::Index c = 0; c < x.q.cols(); ++c)
      out[c] += density_ * t.at.weight[g] * at.velocity[c];
  }
  return out;
}

double EulerianInertia::potential_energy(const EulerianTable& t, const Local& x) const {
  double out = 0;
  for (Eigen::Index g = 0; g < t.at.weight.size(); ++g) {
    const Row r = at_point(t.at.N, g, x.q);
    for (Eigen::Index c = 0; c < gravity_.size(); ++c)
      out -= density_ * t.at.weight[g] * r[c] * gravity_[c];
  }
  return out;
}

void EulerianInertia::add_force(const EulerianTable& t, const Local& x,
                                EulerianForce& force) const {
  const auto n = x.q.rows(), d = x.q.cols();
  for (Eigen::Index g = 0; g < t.at.weight.size(); ++g) {
    const Moving at = moving(t, g, x, gravity_, has_inertia_);
    const double w = density_ * t.at.weight[g];
    for (Eigen::Index k = 0; k < n; ++k)
      force.segment(d * k, d) += w * t.at.N(g, k) * at.load.head(d).transpose();
    for (int l = 0; l < kSides; ++l)
      force[n * d + l] += w * at.by_line[static_cast<size_t>(l)].dot(at.load);
  }
}

void EulerianInertia::add_tangent(const EulerianTable& t, const Local& x, const Weights& w,
                                  EulerianTangent& tangent) const {
  const auto n = x.q.rows(), d = x.q.cols();
  const auto rate = [&](int l) { return t.side[static_cast<size_t>(l)].rate; };
  const auto acceleration = [&](int l) { return t.side[static_cast<size_t>(l)].acceleration; };
  const auto N_p = [&](int l) -> const MatrixXd& { return t.N_p[static_cast<size_t>(l)]; };
  Shapes by_q(n), grown(n);
  for (Eigen::Index g = 0; g < t.at.weight.size(); ++g) {
    const Moving at = moving(t, g, x, gravity_, has_inertia_);
    const double weight = density_ * t.at.weight[g];
    const Shapes N = t.at.N.row(g).transpose();
    // Columns of the shape unknowns: δr̈ = by_q_k δq_k.
    by_q.setZero();
    if (has_inertia_) {
      by_q = w.a * N;
      for (int l = 0; l < kSides; ++l) {
        by_q += (2 * w.v * rate(l) + w.q * acceleration(l)) * N_p(l).row(g).transpose();
        for (int k = 0; k < kSides; ++k)
          if (rate(l) * rate(k) != 0)
            by_q += w.q * rate(l) * rate(k) * t.second(l, k).row(g).transpose();
      }
    }
    for (Eigen::Index k = 0; k < n; ++k) {
      for (Eigen::Index j = 0; j < n; ++j)
        for (Eigen::Index c = 0; c < d; ++c)
          tangent(d * k + c, d * j + c) += weight * N[k] * by_q[j];
      for (int l = 0; l < kSides; ++l)
        for (Eigen::Index c = 0; c < d; ++c)
          tangent(n * d + l, d * k + c) +=
              weight *
              (w.q * N_p(l)(g, k) * at.load[c] + by_q[k] * at.by_line[static_cast<size_t>(l)][c]);
    }
    // Columns of the lines, at fixed local coordinates; every table is a power of the side lengths.
    for (int j = 0; j < kSides; ++j) {
      const auto grow = [&](const MatrixXd& table, int m_order, int n_order) {
        for (Eigen::Index k = 0; k < n; ++k)
          grown[k] = t.growth(j, static_cast<int>(k), m_order, n_order) * table(g, k);
        Row out = Row::Zero();
        for (Eigen::Index k = 0; k < n; ++k) out.head(d) += grown[k] * x.q.row(k);
        return out;
      };
      Row load = Row::Zero();  // δ(r̈ - g)
      if (has_inertia_) {
        for (Eigen::Index k = 0; k < n; ++k)
          load.head(d) += w.q * t.growth(j, static_cast<int>(k), 0, 0) * N[k] * x.a.row(k);
        load += 2 * w.v * at_point(N_p(j), g, x.v);
        load += w.a * at.by_line[static_cast<size_t>(j)];
        for (int l = 0; l < kSides; ++l) {
          load += w.q * acceleration(l) * grow(N_p(l), m_orders(l), n_orders(l));
          load += w.v * 2 * rate(l) * at_point(t.second(l, j), g, x.q);
          if (rate(l) == 0) continue;
          for (Eigen::Index k = 0; k < n; ++k)
            load.head(d) += w.q * 2 * rate(l) *
                            t.growth(j, static_cast<int>(k), m_orders(l), n_orders(l)) *
                            N_p(l)(g, k) * x.v.row(k);
          for (int k = 0; k < kSides; ++k)
            if (rate(k) != 0)
              load += w.q * rate(l) * rate(k) *
                      grow(t.second(l, k), m_orders(l) + m_orders(k), n_orders(l) + n_orders(k));
        }
      }
      const Row changed = w.q * t.area_growth(j) * at.load + load;
      for (Eigen::Index k = 0; k < n; ++k)
        for (Eigen::Index c = 0; c < d; ++c)
          tangent(d * k + c, n * d + j) +=
              weight * (N[k] * changed[c] +
                        w.q * t.growth(j, static_cast<int>(k), 0, 0) * N[k] * at.load[c]);
      for (int l = 0; l < kSides; ++l) {
        const Row& by_line = at.by_line[static_cast<size_t>(l)];
        const Row shifted = grow(N_p(l), m_orders(l), n_orders(l));
        tangent(n * d + l, n * d + j) +=
            weight * (by_line.dot(changed) + w.q * shifted.dot(at.load));
      }
    }
  }
}

}  // namespace flexmorph::fem
