#pragma once

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <span>

#include "fem/shapes/singular_values.h"
#include "fem/thermal/thermal_displacement.h"

/// The thermal displacement of a free body by the two methods of T, which solve systems of
/// equations: an independent check of the closed form that the program uses.
namespace flexmorph::fem {

/// Returns M_rd = Σ_j ∫ ρb N_rd N_rdᵀ dA (n x n), N_rd = N - N(x_o), x_o first node of element j.
inline MatrixXd relative_mass(const Element& element, double area_density) {
  MatrixXd out = MatrixXd::Zero(element.n_vectors(), element.n_vectors());
  ShapeTable t;
  for (int e = 0; e < element.n_elements(); ++e) {
    element.tabulate(e, 6, Tabulate::position, {}, ScaleFactorKind::mass, t);
    MatrixXd relative = t.N;  // the first shape function is 1 at the first node
    relative.col(0).array() -= 1;
    const MatrixXd M_rd = relative.transpose() * (area_density * t.weight).asDiagonal() * relative;
    const auto vectors = element.vectors(e);
    for (Eigen::Index k = 0; k < M_rd.rows(); ++k)
      for (Eigen::Index l = 0; l < M_rd.cols(); ++l)
        out(vectors[static_cast<size_t>(k)], vectors[static_cast<size_t>(l)]) += M_rd(k, l);
  }
  return out;
}

inline void check_position(const ThermalMatrices& m, int eliminated) {
  if (eliminated < 0 || eliminated >= m.A_r.size() || m.A_r[eliminated] == 0)
    throw Error::input("thermal displacement: vector unknown " + std::to_string(eliminated) +
                       " cannot be eliminated, it is no position");
}

inline void check_eliminated(const Element& element, const ThermalMatrices& m,
                             std::span<const int> eliminated) {
  if (static_cast<int>(eliminated.size()) != element.dim())
    throw Error::input("thermal displacement: " + std::to_string(eliminated.size()) +
                       " eliminated coordinates, a body has one translation in each of its " +
                       std::to_string(element.dim()) + " directions");
  for (const int k : eliminated) check_position(m, k);
}

/// Returns the lengths per unit of the vector unknowns.
inline VectorXd lengths(const Element& element) {
  VectorXd out(element.n_vectors());
  for (int k = 0; k < element.n_vectors(); ++k) out[k] = element.scale(k);
  return out;
}
inline VectorXd without(const VectorXd& x, Eigen::Index k) {
  VectorXd out(x.size() - 1);
  out.head(k) = x.head(k);
  out.tail(out.size() - k) = x.tail(out.size() - k);
  return out;
}

inline double condition_of(const MatrixXd& a) {
  const VectorXd s = singular_values(a).values;
  return s[0] / s[s.size() - 1];
}

/// Returns H_di (n x n - 1): all coordinates of one direction as functions of the independent ones,
/// without translation, A_rᵀ M e = 0, T (10). The independent ones are all but `eliminated`, in
/// their order.
/// @throws Error (input) unless `eliminated` is the number of a position: gradients do not
///         translate, and most cannot be found from T (10) (r_y of a beam has S = 0).
inline MatrixXd sweeping_matrix(const ThermalMatrices& m, int eliminated) {
  check_position(m, eliminated);
  const Eigen::Index n = m.S.size();
  MatrixXd H = MatrixXd::Zero(n, n - 1);
  for (Eigen::Index k = 0; k < n - 1; ++k) H(k < eliminated ? k : k + 1, k) = 1;
  H.row(eliminated) = -without(m.S, eliminated).transpose() / m.S[eliminated];
  return H;
}

/// e_Θ: the change of the unknowns by a free, uniform, isotropic expansion by a = α ΔT.
struct ThermalDisplacement {
  MatrixXd value;  ///< Displacement (n x dim).
  /// Largest condition number of the solved matrices over the directions, with unknowns scaled to
  /// lengths.
  double condition = 0;
};

/// Solves T (7)-(11): M_H e_i = Hᵀ M_1 e_o, M_H = Hᵀ M_rd H, which is positive definite.
/// @param eliminated  number of the eliminated vector unknown for each direction (dim): one
///                    translation per direction and body
/// @throws Error (input) for another number of them, or as sweeping_matrix(); (numerical) when M_H
///         is not positive definite.
inline ThermalDisplacement thermal_displacement_by_sweeping(const Element& element, double a,
                                                            std::span<const int> eliminated) {
  const ThermalMatrices m = thermal_matrices(element, 1);
  check_eliminated(element, m, eliminated);
  const MatrixXd M_rd = relative_mass(element, 1);
  const MatrixXd b = a * (M_rd * m.reference);  // M_1 e_o with J_dΘ = a 1
  const VectorXd scale = lengths(element);
  ThermalDisplacement out;
  out.value.resize(m.reference.rows(), m.reference.cols());
  for (Eigen::Index c = 0; c < m.reference.cols(); ++c) {
    const int d = eliminated[static_cast<size_t>(c)];
    const VectorXd unit = without(scale, d).cwiseInverse();  // independent unknowns per length
    const MatrixXd H = sweeping_matrix(m, d) * unit.asDiagonal();
    const MatrixXd M_H = H.transpose() * M_rd * H;
    const Eigen::LLT<MatrixXd> factor(M_H);
    if (factor.info() != Eigen::Success)
      throw Error::numerical("thermal displacement: M_H is not positive definite");
    out.value.col(c) = H * factor.solve(H.transpose() * b.col(c));
    out.condition = std::max(out.condition, condition_of(M_H));
  }
  return out;
}

/// Solves T (12)-(15): Hᵀ I_u H e_i = Hᵀ M⁻¹ ∫ ρb N a (X - X_o) dA, I_u = 1 - M⁻¹ S S(x_o), where
/// x_o is the first node of the body. (16), with x instead of X - X_o, holds for straight
/// references only.
inline ThermalDisplacement thermal_displacement_by_mass(const Element& element, double a,
                                                        std::span<const int> eliminated) {
  const ThermalMatrices m = thermal_matrices(element, 1);
  check_eliminated(element, m, eliminated);
  const Eigen::Index n = m.S.size();
  const VectorXd scale = lengths(element);
  const MatrixXd D = scale.cwiseInverse().asDiagonal();
  // M⁻¹ for unknowns that are lengths.
  const Eigen::LDLT<MatrixXd> mass(D * m.M * D);
  const int first = element.vectors(0)[0];  // x_o
  const MatrixXd I_u =
      MatrixXd::Identity(n, n) -
      mass.solve(D * m.S) * VectorXd::Unit(n, first).transpose();  // the scale of positions is 1
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

/// Returns the closed form a (e_o - A_r X_cm) (n x dim).
inline MatrixXd thermal_displacement(const Element& element, double a) {
  return a * thermal_matrices(element, 1).from_centre();
}

}  // namespace flexmorph::fem
