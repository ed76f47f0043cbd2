#include "fem/terms/strain_flow.h"

#include <cmath>

#include "fem/terms/membrane_invariant.h"

namespace flexmorph::fem {
namespace {

const MatrixXd& rates_of(const ShapeTable& t, const Measure& m) {
  if (m.m_order == 1 && m.n_order == 0) return t.N_mt;
  if (m.m_order == 0 && m.n_order == 1) return t.N_nt;
  if (m.m_order == 2 && m.n_order == 0) return t.N_mmt;
  if (m.m_order == 0 && m.n_order == 2) return t.N_nnt;
  if (m.m_order == 1 && m.n_order == 1) return t.N_mnt;
  throw Error::numerical("strain_flow: the rate of this measure is not tabulated");
}

/// Computes the measures at point g, or their rates.
template <class TableOf>
void measure_at(std::span<const Measure> list, const TableOf& table_of_measure, Eigen::Index g,
                const LocalRows& q, Measures& out) {
  out.setZero(static_cast<Eigen::Index>(list.size()), q.cols());
  for (size_t i = 0; i < list.size(); ++i) {
    const MatrixXd& table = table_of_measure(list[i]);
    for (Eigen::Index k = 0; k < q.rows(); ++k)
      out.row(static_cast<Eigen::Index>(i)) += table(g, k) * q.row(k);
  }
}

}  // namespace

double flow_power(const EnergyDensity& density, const ShapeTable& t, const LocalRows& q) {
  const auto list = density.measures();
  const auto d = q.cols();
  // Measures at all points, side by side, and their rates.
  const auto measures = static_cast<Eigen::Index>(list.size());
  MatrixXd all(t.weight.size(), measures * d), rates(t.weight.size(), measures * d);
  for (Eigen::Index i = 0; i < measures; ++i) {
    all.middleCols(i * d, d).noalias() = table_of(t, list[static_cast<size_t>(i)]) * q;
    rates.middleCols(i * d, d).noalias() = rates_of(t, list[static_cast<size_t>(i)]) * q;
  }
  Measures z(measures, d), stress;
  double out = 0;
  for (Eigen::Index g = 0; g < t.weight.size(); ++g) {
    for (Eigen::Index i = 0; i < measures; ++i) z.row(i) = all.row(g).segment(i * d, d);
    density.energy(z, &stress, nullptr);
    double power = 0;
    for (Eigen::Index i = 0; i < measures; ++i)
      power += stress.row(i).dot(rates.row(g).segment(i * d, d));
    out += t.weight[g] * power;
  }
  return out;
}

void add_line_energy(const EnergyDensity& density, std::span<const ShapeTable> line,
                     const LocalRows& q, VectorXd& out) {
  Measures z;
  for (size_t g = 0; g < line.size(); ++g) {
    measure_at(
        density.measures(),
        [&](const Measure& m) -> const MatrixXd& { return table_of(line[g], m); }, 0, q, z);
    out[static_cast<Eigen::Index>(g)] += density.energy(z, nullptr, nullptr);
  }
}

MatrixXd strains_on_line(const StrainMeasure& measure, std::span<const ShapeTable> line,
                         const LocalRows& q) {
  MatrixXd out(line.size(), measure.size());
  Measures z;
  StrainVector e;
  for (size_t g = 0; g < line.size(); ++g) {
    measure_at(
        measure.measures(),
        [&](const Measure& m) -> const MatrixXd& { return table_of(line[g], m); }, 0, q, z);
    measure.strain(z, e, nullptr);
    out.row(static_cast<Eigen::Index>(g)) = e.transpose();
  }
  return out;
}

ParabolaFlow::ParabolaFlow(int n, const Motion& start, const Motion& end)
    : A(parabola_through_samples(n)) {
  const GaussRule& rule = gauss(n);
  MatrixXd D(n, n);
  for (int i = 0; i < n; ++i) {
    D(i, i) = 0;
    for (int j = 0; j < n; ++j) {
      const auto a = static_cast<size_t>(i), b = static_cast<size_t>(j);
      if (j == i) continue;
      D(i, j) = rule.barycentric[b] / rule.barycentric[a] / (rule.points[a] - rule.points[b]);
      D(i, i) -= D(i, j);
    }
  }
  // Local velocity ṡ of a material point.
  const Eigen::Map<const VectorXd> s(rule.points.data(), n);
  const VectorXd flow =
      -(start.rate + (end.rate - start.rate) * s.array()).matrix() / (end.value - start.value);
  K = flow.asDiagonal() * D * A - A * flow.asDiagonal() * D;
}

double assumed_flow_power(const Element& element, int e, const ScaleFactors& factors,
                          const Eigen::Matrix3d& elasticity, const LocalRows& q) {
  ShapeTable t;
  EulerianTable sides;  // only used for the positions of the lines
  element.tabulate(e, 12, Tabulate::gradient_rates, factors, ScaleFactorKind::stiffness, t);
  element.tabulate_eulerian(e, 0, Tabulate::gradient, sides);
  const auto n = static_cast<int>(std::lround(std::sqrt(static_cast<double>(t.weight.size()))));
  const ParabolaFlow m(n, sides.side[kM1], sides.side[kM2]),
      across(n, sides.side[kN1], sides.side[kN2]);

  // Strains of the displacements and their rates at the points, points along m in a column.
  std::array<MatrixXd, 3> strain, rate;
  for (size_t i = 0; i < 3; ++i) strain[i] = rate[i] = MatrixXd(n, n);
  const MatrixXd r_m = t.N_m * q, r_n = t.N_n * q, r_mt = t.N_mt * q, r_nt = t.N_nt * q;
  for (Eigen::Index p = 0; p < t.weight.size(); ++p) {
    const auto g = p / n, h = p % n;
    strain[0](g, h) = 0.5 * (r_m.row(p).squaredNorm() - 1);
    strain[1](g, h) = 0.5 * (r_n.row(p).squaredNorm() - 1);
    strain[2](g, h) = r_m.row(p).dot(r_n.row(p));
    rate[0](g, h) = r_m.row(p).dot(r_mt.row(p));
    rate[1](g, h) = r_n.row(p).dot(r_nt.row(p));
    rate[2](g, h) = r_mt.row(p).dot(r_n.row(p)) + r_m.row(p).dot(r_nt.row(p));
  }
  rate[0] = m.A * rate[0] + m.K * strain[0];
  rate[1] = rate[1] * across.A.transpose() + strain[1] * across.K.transpose();
  rate[2] = (m.A * rate[2] + m.K * strain[2]) * across.A.transpose() +
            m.A * strain[2] * across.K.transpose();
  strain[0] = m.A * strain[0];
  strain[1] = strain[1] * across.A.transpose();
  strain[2] = m.A * strain[2] * across.A.transpose();
  double out = 0;
  for (Eigen::Index p = 0; p < t.weight.size(); ++p) {
    const auto at = [&](const std::array<MatrixXd, 3>& x) {
      return Vec3(x[0](p / n, p % n), x[1](p / n, p % n), x[2](p / n, p % n));
    };
    out += t.weight[p] * at(strain).dot(elasticity * at(rate));
  }
  return out;
}

void add_assumed_line_energy(std::span<const ShapeTable> line, const Eigen::Matrix3d& elasticity,
                             const LocalRows& q, VectorXd& out) {
  const auto n = static_cast<Eigen::Index>(line.size());
  MatrixXd strain(n, 3);
  for (Eigen::Index g = 0; g < n; ++g) {
    const ShapeTable& t = line[static_cast<size_t>(g)];
    const Eigen::RowVectorXd r_m = t.N_m * q, r_n = t.N_n * q;
    strain.row(g) << 0.5 * (r_m.squaredNorm() - 1), 0.5 * (r_n.squaredNorm() - 1), r_m.dot(r_n);
  }
  // The samples along m are on m-lines, so that only strains that are interpolated along n differ.
  strain.rightCols(2) =
      (parabola_through_samples(static_cast<int>(n)) * strain.rightCols(2)).eval();
  for (Eigen::Index g = 0; g < n; ++g)
    out[g] += 0.5 * strain.row(g).dot(elasticity * strain.row(g).transpose());
}

}  // namespace flexmorph::fem
