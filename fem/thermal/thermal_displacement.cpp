#include "fem/thermal/thermal_displacement.h"

namespace flexmorph::fem {
namespace {

constexpr int kMassDegree = 6;

}  // namespace

ThermalMatrices thermal_matrices(const Element& element, double area_density,
                                 const ScaleFactors& factors) {
  if (element.is_rigid())
    throw Error::input("thermal displacement: a rigid body has no thermal expansion");
  if (element.n_scalars() > 0)
    throw Error::input("thermal displacement: the body has free material lines");
  const int n = element.n_vectors();
  ThermalMatrices out;
  out.M = MatrixXd::Zero(n, n);
  out.S = out.A_r = VectorXd::Zero(n);
  out.reference = element.reference();
  for (int k = 0; k < n; ++k) out.A_r[k] = element.is_position(k) ? 1 : 0;
  ShapeTable t;
  for (int e = 0; e < element.n_elements(); ++e) {
    if (element.moving(e))
      throw Error::input("thermal displacement: the body has material lines that move");
    element.tabulate(e, kMassDegree, Tabulate::position, factors, ScaleFactorKind::mass, t);
    const auto vectors = element.vectors(e);
    const MatrixXd weighted = (area_density * t.weight).asDiagonal() * t.N;
    const MatrixXd M = weighted.transpose() * t.N;
    const VectorXd S = weighted.colwise().sum();
    for (Eigen::Index k = 0; k < S.size(); ++k) {
      const int row = vectors[static_cast<size_t>(k)];
      out.S[row] += S[k];
      for (Eigen::Index l = 0; l < S.size(); ++l)
        out.M(row, vectors[static_cast<size_t>(l)]) += M(k, l);
    }
  }
  const double mass = out.S.dot(out.A_r);
  if (!(mass > 0)) throw Error::input("thermal displacement: the body has no mass");
  out.centre = out.S.transpose() * out.reference / mass;
  return out;
}

}  // namespace flexmorph::fem
