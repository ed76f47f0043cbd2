#include "fem/terms/densities.h"

namespace flexmorph::fem {

const MatrixXd& table_of(const ShapeTable& t, const Measure& m) {
  if (m.m_order == 1 && m.n_order == 0) return t.N_m;
  if (m.m_order == 0 && m.n_order == 1) return t.N_n;
  if (m.m_order == 2 && m.n_order == 0) return t.N_mm;
  if (m.m_order == 0 && m.n_order == 2) return t.N_nn;
  if (m.m_order == 1 && m.n_order == 1) return t.N_mn;
  throw Error::numerical("density: this measure is not tabulated");
}

double MembraneDensity::energy(const Measures& z, Measures* gradient,
                               MeasureHessian* hessian) const {
  const auto d = z.cols();
  const auto r_m = z.row(0), r_n = z.row(1);
  const Vec3 strain(0.5 * (r_m.squaredNorm() - 1), 0.5 * (r_n.squaredNorm() - 1), r_m.dot(r_n));
  const Vec3 stress = elasticity_ * strain;
  if (gradient) {
    gradient->resize(2, d);
    gradient->row(0) = stress[0] * r_m + stress[2] * r_n;
    gradient->row(1) = stress[1] * r_n + stress[2] * r_m;
  }
  if (hessian) {
    Eigen::Matrix<double, 3, Eigen::Dynamic, 0, 3, 2 * kMaxDim> variation(3, 2 * d);
    variation.setZero();
    variation.row(0).head(d) = r_m;
    variation.row(1).tail(d) = r_n;
    variation.row(2) << r_n, r_m;
    *hessian = variation.transpose() * elasticity_ * variation;
    for (Eigen::Index c = 0; c < d; ++c) {
      (*hessian)(c, c) += stress[0];
      (*hessian)(d + c, d + c) += stress[1];
      (*hessian)(c, d + c) += stress[2];
      (*hessian)(d + c, c) += stress[2];
    }
  }
  return 0.5 * strain.dot(stress);
}

}  // namespace flexmorph::fem
