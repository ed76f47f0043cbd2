#include "fem/thermal/thermal_displacement.h"

#include <Eigen/Cholesky>
#include <Eigen/LU>

#include "fem/singular_values.h"

namespace flexmorph::fem {
namespace {

constexpr int kMassDegree = 6;

void check_position(const ThermalMatrices& m, int eliminated) {
  if (eliminated < 0 || eliminated >= m.A_r.size() || m.A_r[eliminated] == 0)
    throw Error::input("thermal displacement: vector unknown " + std::to_string(eliminated) +
                       " cannot be eliminated, it is no position");
}

void check(const Element& element, const ThermalMatrices& m, std::span<const int> eliminated) {
  if (static_cast<int>(eliminated.size()) != element.dim())
    throw Error::input("thermal displacement: " + std::to_string(eliminated.size()) +
                       " eliminated coordinates, a body has one translation in each of its " +
                       std::to_string(element.dim()) + " directions");
  for (const int k : eliminated) check_position(m, k);
}

/// Lengths per unit of the vector unknowns; without one of them.
VectorXd lengths(const Element& element) {
  VectorXd out(element.n_vectors());
  for (int k = 0; k < element.n_vectors(); ++k) out[k] = element.scale(k);
  return out;
}
VectorXd without(const VectorXd& x, Eigen::Index k) {
  VectorXd out(x.size() - 1);
  out.head(k) = x.head(k);
  out.tail(out.size() - k) = x.tail(out.size() - k);
  return out;
}

double condition_of(const MatrixXd& a) {
  const VectorXd s = singular_values(a).values;
  return s[0] / s[s.size() - 1];
}

}  // namespace

ThermalMatrices thermal_matrices(const Element& element, double area_density,
                                 const Factors& factors) {
  if (element.is_rigid()) throw Error::input("thermal displacement: a rigid body does not grow");
  if (element.n_scalars() > 0)
    throw Error::input("thermal displacement: the body has free material lines");
  const int n = element.n_vectors();
  ThermalMatrices out;
  out.M = out.M_rd = MatrixXd::Zero(n, n);
  out.S = out.A_r = VectorXd::Zero(n);
  out.reference = element.reference();
  for (int k = 0; k < n; ++k) out.A_r[k] = element.is_position(k) ? 1 : 0;
  ShapeTable t;
  for (int e = 0; e < element.n_elements(); ++e) {
    if (element.moving(e))
      throw Error::input("thermal displacement: the body has material lines that move");
    element.tabulate(e, kMassDegree, Tabulate::position, factors, FactorKind::mass, t);
    const auto vectors = element.vectors(e);
    MatrixXd relative = t.N;  // N_rd: the first shape function is 1 at the first node
    relative.col(0).array() -= 1;
    const MatrixXd weighted = (area_density * t.weight).asDiagonal() * t.N;
    const MatrixXd M = weighted.transpose() * t.N;
    const MatrixXd M_rd = relative.transpose() * (area_density * t.weight).asDiagonal() * relative;
    const VectorXd S = weighted.colwise().sum();
    for (Eigen::Index k = 0; k < S.size(); ++k) {
      const int row = vectors[static_cast<size_t>(k)];
      out.S[row] += S[k];
      for (Eigen::Index l = 0; l < S.size(); ++l) {
        out.M(row, vectors[static_cast<size_t>(l)]) += M(k, l);
        out.M_rd(row, vectors[static_cast<size_t>(l)]) += M_rd(k, l);
      }
    }
  }
  const double mass = out.S.dot(out.A_r);
  if (!(mass > 0)) throw Error::input("thermal displacement: the body has no mass");
  out.centre = out.S.transpose() * out.reference / mass;
  return out;
}

MatrixXd sweeping_matrix(const ThermalMatrices& m, int eliminated) {
  check_position(m, eliminated);
  const Eigen::Index n = m.S.size();
  MatrixXd H = MatrixXd::Zero(n, n - 1);
  for (Eigen::Index k = 0; k < n - 1; ++k) H(k < eliminated ? k : k + 1, k) = 1;
  H.row(eliminated) = -without(m.S, eliminated).transpose() / m.S[eliminated];
  return H;
}

ThermalDisplacement thermal_displacement_by_sweeping(const Element& element, double a,
                                                     std::span<const int> eliminated) {
  const ThermalMatrices m = thermal_matrices(element, 1);
  check(element, m, eliminated);
  const MatrixXd b = a * (m.M_rd * m.reference);  // M_1 e_o with J_dΘ = a 1
  const VectorXd scale = lengths(element);
  ThermalDisplacement out;
  out.value.resize(m.reference.rows(), m.reference.cols());
  for (Eigen::Index c = 0; c < m.reference.cols(); ++c) {
    const int d = eliminated[static_cast<size_t>(c)];
    const VectorXd unit = without(scale, d).cwiseInverse();  // independent unknowns per length
    const MatrixXd H = sweeping_matrix(m, d) * unit.asDiagonal();
    const MatrixXd M_H = H.transpose() * m.M_rd * H;
    const Eigen::LLT<MatrixXd> factor(M_H);
    if (factor.info() != Eigen::Success)
      throw Error::numerical("thermal displacement: M_H is not positive definite");
    out.value.col(c) = H * factor.solve(H.transpose() * b.col(c));
    out.condition = std::max(out.condition, condition_of(M_H));
  }
  return out;
}

ThermalDisplacement thermal_displacement_by_mass(const Element& element, double a,
                                                 std::span<const int> eliminated) {
  const ThermalMatrices m = thermal_matrices(element, 1);
  check(element, m, eliminated);
  const Eigen::Index n = m.S.size();
  const VectorXd scale = lengths(element);
  const MatrixXd D = scale.cwiseInverse().asDiagonal();
  // M⁻¹ in unknowns that are lengths.
  const Eigen::LDLT<MatrixXd> mass(D * m.M * D);
  const int first = element.vectors(0)[0];  // x_o
  const MatrixXd I_u =
      MatrixXd::Identity(n, n) -
      mass.solve(D * m.S) * VectorXd::Unit(n, first).transpose();  // scale of positions is 1
  const MatrixXd relative = m.reference - m.A_r * m.reference.row(first);
  const MatrixXd b = a * mass.solve(D * (m.M * relative));
  ThermalDisplacement out;
  out.value.resize(n, m.reference.cols());
  for (Eigen::Index c = 0; c < m.reference.cols(); ++c) {
    const int d = eliminated[static_cast<size_t>(c)];
    const MatrixXd H =
        scale.asDiagonal() * sweeping_matrix(m, d) * without(scale, d).cwiseInverse().asDiagonal();
    const MatrixXd system = H.transpose() * I_u * H;
    out.value.col(c) =
        D * (H * Eigen::PartialPivLU<MatrixXd>(system).solve(H.transpose() * b.col(c)));
    out.condition = std::max(out.condition, condition_of(system));
  }
  return out;
}

MatrixXd thermal_displacement(const Element& element, double a) {
  return a * thermal_matrices(element, 1).from_centre();
}

}  // namespace flexmorph::fem
