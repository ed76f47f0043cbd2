#include "fem/terms/assumed_strain.h"

#include <array>

namespace flexmorph::fem {
namespace {

/// Parabola through the values at 0, 1/2 and 1 of a polynomial of degree below n, all by values at
/// the n Gauss points (n x n).
MatrixXd parabola_through_samples(int n) {
  const GaussRule& rule = gauss(n);
  constexpr std::array<double, 3> kSamples = {0, 0.5, 1};
  MatrixXd sample(3, n), interpolate(n, 3);
  for (int g = 0; g < n; ++g) {
    for (int i = 0; i < 3; ++i) {
      double lagrange = rule.barycentric[static_cast<size_t>(g)];
      for (int o = 0; o < n; ++o)
        if (o != g)
          lagrange *= kSamples[static_cast<size_t>(i)] - rule.points[static_cast<size_t>(o)];
      sample(i, g) = lagrange;
    }
    const double s = rule.points[static_cast<size_t>(g)];
    interpolate.row(g) << (2 * s - 1) * (s - 1), 4 * s * (1 - s), s * (2 * s - 1);
  }
  return interpolate * sample;
}

/// Products x_i y_j at all points: row i x.cols() + j, a column per point.
MatrixXd products(const MatrixXd& x, const MatrixXd& y) {
  MatrixXd out(x.cols() * y.cols(), x.rows());
  for (Eigen::Index i = 0; i < x.cols(); ++i)
    for (Eigen::Index j = 0; j < y.cols(); ++j)
      out.row(i * y.cols() + j) = x.col(i).cwiseProduct(y.col(j)).transpose();
  return out;
}

}  // namespace

MatrixXd assumed_membrane_invariant(const ProductTable& t, std::span<const int> i,
                                    std::span<const int> j, const Eigen::Matrix3d& elasticity) {
  const MatrixXd assume = parabola_through_samples(static_cast<int>(t.f_m.rows())).transpose();
  // Factors of ε₁₁, ε₂₂ and 2ε₁₂ along m and along n: a row per pair of functions.
  const MatrixXd m11 = products(t.d_m, t.d_m) * assume, n11 = products(t.f_n, t.f_n),
                 m22 = products(t.f_m, t.f_m), n22 = products(t.d_n, t.d_n) * assume,
                 m12 = products(t.d_m, t.f_m) * assume, n12 = products(t.d_n, t.f_n) * assume;
  const auto n_functions = t.f_m.cols();
  const auto n_pairs = static_cast<Eigen::Index>(i.size());
  const auto along = t.weight.rows(), across = t.weight.cols();
  // Λ of each strain at all points, a row per pair.
  MatrixXd l11(n_pairs, t.weight.size()), l22(n_pairs, t.weight.size()),
      l12(n_pairs, t.weight.size());
  for (Eigen::Index p = 0; p < n_pairs; ++p) {
    const auto k = static_cast<size_t>(i[static_cast<size_t>(p)]),
               l = static_cast<size_t>(j[static_cast<size_t>(p)]);
    const auto kl_m = n_functions * t.function_m[k] + t.function_m[l],
               lk_m = n_functions * t.function_m[l] + t.function_m[k],
               kl_n = n_functions * t.function_n[k] + t.function_n[l],
               lk_n = n_functions * t.function_n[l] + t.function_n[k];
    for (Eigen::Index h = 0; h < across; ++h)
      for (Eigen::Index g = 0; g < along; ++g) {
        const auto point = h * along + g;
        l11(p, point) = m11(kl_m, g) * n11(kl_n, h);
        l22(p, point) = m22(kl_m, g) * n22(kl_n, h);
        // N_k,m N_l,n + N_l,m N_k,n
        l12(p, point) = (m12(kl_m, g) * n12(lk_n, h) + m12(lk_m, g) * n12(kl_n, h));
      }
  }
  const auto weights = Eigen::Map<const VectorXd>(t.weight.data(), t.weight.size()).asDiagonal();
  const MatrixXd w11 = l11 * weights;
  MatrixXd out = elasticity(0, 1) * w11 * l22.transpose();
  out += out.transpose().eval();
  out += elasticity(0, 0) * w11 * l11.transpose();
  out += elasticity(1, 1) * (l22 * weights) * l22.transpose();
  out += elasticity(2, 2) * (l12 * weights) * l12.transpose();
  return out;
}

}  // namespace flexmorph::fem
