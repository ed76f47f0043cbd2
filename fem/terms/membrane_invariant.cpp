#include "fem/terms/membrane_invariant.h"

#include <cblas.h>

#include <algorithm>
#include <array>

namespace flexmorph::fem {
namespace {

/// Returns the products of two functions at all points: a row per pair i <= j.
MatrixXd products_of_two(const MatrixXd& f) {
  MatrixXd out(f.cols() * (f.cols() + 1) / 2, f.rows());
  for (Eigen::Index i = 0, p = 0; i < f.cols(); ++i)
    for (Eigen::Index j = i; j < f.cols(); ++j, ++p)
      out.row(p) = f.col(i).cwiseProduct(f.col(j)).transpose();
  return out;
}
/// Returns the products of rows of x and rows of y at all points: row p y.rows() + q.
MatrixXd products(const MatrixXd& x, const MatrixXd& y) {
  MatrixXd out(x.rows() * y.rows(), x.cols());
  for (Eigen::Index p = 0; p < x.rows(); ++p)
    out.middleRows(p * y.rows(), y.rows()) = y * x.row(p).asDiagonal();
  return out;
}

constexpr int kFunctions = 4, kPairs1d = kFunctions * (kFunctions + 1) / 2,
              kRows = kPairs1d * kPairs1d;

/// Sums over the points for strains of the displacement field, W = Σ_points Λᵀ C Λ. With N_k =
/// f_i(m) g_a(n) every entry of Λᵀ C Λ is a sum of products of four functions of m and four of n.
/// Therefore W consists of entries of three matrices, each summed first over m and then over n,
///
///   X (p q, r s) = Σ_gh w_gh (x_p y_q)(m_g) (y_r x_s)(n_h)     p, q, r, s: pairs of functions
///
/// with f' f' f' f' (11), f f f f (22) or f' f' f f (all others) along m.
struct PointSums {
  MatrixXd normal;  ///< Contributions of ε₁₁ and ε₂₂ to the three matrices, times C.
  MatrixXd shear;   ///< Matrix X12.

  PointSums(const ProductTable& t, const Eigen::Matrix3d& elasticity) {
    const MatrixXd dd_m = products_of_two(t.d_m), ff_m = products_of_two(t.f_m),
                   dd_n = products_of_two(t.d_n), ff_n = products_of_two(t.f_n);
    const MatrixXd& w = t.weight;
    shear.noalias() = products(dd_m, ff_m) * w * products(ff_n, dd_n).transpose();
    normal.noalias() =
        elasticity(0, 0) * products(dd_m, dd_m) * w * products(ff_n, ff_n).transpose();
    normal.noalias() +=
        elasticity(1, 1) * products(ff_m, ff_m) * w * products(dd_n, dd_n).transpose();
    // X12 (p q, r s) and X12 (q p, s r).
    for (int r = 0; r < kPairs1d; ++r)
      for (int s = 0; s < kPairs1d; ++s)
        for (int p = 0; p < kPairs1d; ++p)
          for (int q = 0; q < kPairs1d; ++q)
            normal(p * kPairs1d + q, r * kPairs1d + s) +=
                elasticity(0, 1) * (shear(p * kPairs1d + q, r * kPairs1d + s) +
                                    shear(q * kPairs1d + p, s * kPairs1d + r));
  }
};

/// Returns the products x_i y_j at all points: row i x.cols() + j, a column per point.
MatrixXd all_products(const MatrixXd& x, const MatrixXd& y) {
  MatrixXd out(x.cols() * y.cols(), x.rows());
  for (Eigen::Index i = 0; i < x.cols(); ++i)
    for (Eigen::Index j = 0; j < y.cols(); ++j)
      out.row(i * y.cols() + j) = x.col(i).cwiseProduct(y.col(j)).transpose();
  return out;
}

/// Returns W of assumed strains, all pairs by all pairs.
MatrixXd of_assumed_strains(const ProductTable& t, const PairNumbers& pairs,
                            const Eigen::Matrix3d& elasticity) {
  const MatrixXd assume = parabola_through_samples(static_cast<int>(t.f_m.rows())).transpose();
  // Factors of ε₁₁, ε₂₂ and 2ε₁₂ along m and along n: a row per pair of functions.
  const MatrixXd m11 = all_products(t.d_m, t.d_m) * assume, n11 = all_products(t.f_n, t.f_n),
                 m22 = all_products(t.f_m, t.f_m), n22 = all_products(t.d_n, t.d_n) * assume,
                 m12 = all_products(t.d_m, t.f_m) * assume,
                 n12 = all_products(t.d_n, t.f_n) * assume;
  const auto n_functions = t.f_m.cols();
  const auto n_pairs = static_cast<Eigen::Index>(pairs.i.size());
  const auto along = t.weight.rows(), across = t.weight.cols();
  // Λ of each strain at all points, a row per pair.
  MatrixXd l11(n_pairs, t.weight.size()), l22(n_pairs, t.weight.size()),
      l12(n_pairs, t.weight.size());
  for (Eigen::Index p = 0; p < n_pairs; ++p) {
    const auto k = static_cast<size_t>(pairs.i[static_cast<size_t>(p)]),
               l = static_cast<size_t>(pairs.j[static_cast<size_t>(p)]);
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
  // W = A Bᵀ + B Aᵀ.
  const auto weights = Eigen::Map<const VectorXd>(t.weight.data(), t.weight.size()).asDiagonal();
  MatrixXd a(n_pairs, 3 * t.weight.size()), b(a.rows(), a.cols()), out(n_pairs, n_pairs);
  a << l11 * weights, l22 * weights, l12 * weights;
  b << 0.5 * elasticity(0, 0) * l11 + elasticity(0, 1) * l22, 0.5 * elasticity(1, 1) * l22,
      0.5 * elasticity(2, 2) * l12;
  const auto n = static_cast<int>(n_pairs);
  cblas_dsyr2k(CblasColMajor, CblasLower, CblasNoTrans, n, static_cast<int>(a.cols()), 1, a.data(),
               n, b.data(), n, 0, out.data(), n);
  out.triangularView<Eigen::StrictlyUpper>() = out.transpose();
  return out;
}

}  // namespace

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

ProductTable even_and_odd(const ProductTable& table, const std::vector<int>& function_m,
                          const std::vector<int>& function_n) {
  // Sums and differences of the values, then of the derivatives.
  const auto both = [](const MatrixXd& f) {
    MatrixXd out(f.rows(), 4);
    out << f.col(0) + f.col(2), f.col(2) - f.col(0), f.col(1) - f.col(3), f.col(1) + f.col(3);
    return out;
  };
  return {table.weight,    both(table.f_m), both(table.d_m), both(table.f_n),
          both(table.d_n), function_m,      function_n};
}

InvariantIndices invariant_indices(const PairNumbers& pairs, const std::vector<int>& function_m,
                                   const std::vector<int>& function_n) {
  // Returns the number of {i, j} among the pairs of functions of one coordinate.
  const auto number = [](const std::vector<int>& function, int k, int l) {
    auto [i, j] = std::minmax(function[static_cast<size_t>(k)], function[static_cast<size_t>(l)]);
    return i * (2 * kFunctions - i + 1) / 2 + j - i;
  };
  // Returns the index of the pairs (a, b) and (c, d) of vectors in a matrix stored by columns.
  const auto value_index = [&](int a, int b, int c, int d) {
    return number(function_m, a, b) * kPairs1d + number(function_m, c, d) +
           kRows * (number(function_n, a, b) * kPairs1d + number(function_n, c, d));
  };
  InvariantIndices out;
  for (size_t block = 0; block + 1 < pairs.starts.size(); ++block)
    for (auto p = static_cast<size_t>(pairs.starts[block]);
         p < static_cast<size_t>(pairs.starts[block + 1]); ++p)
      for (auto q = static_cast<size_t>(pairs.starts[block]); q <= p; ++q) {
        const int k = pairs.i[p], l = pairs.j[p], r = pairs.i[q], s = pairs.j[q];
        // ε₁₁ and ε₂₂ have N_k,m N_l,m and N_k,n N_l,n; 2ε₁₂ the symmetric N_k,m N_l,n.
        out.normal.push_back(value_index(k, l, r, s));
        out.shear.push_back({value_index(k, r, l, s), value_index(k, s, l, r),
                             value_index(l, r, k, s), value_index(l, s, k, r)});
      }
  return out;
}

std::vector<double> membrane_invariant(const ProductTable& table,
                                       const InvariantIndices& value_indices,
                                       const Eigen::Matrix3d& elasticity) {
  const PointSums sums(table, elasticity);
  const double *normal = sums.normal.data(), *shear = sums.shear.data(), c33 = elasticity(2, 2);
  std::vector<double> out(value_indices.normal.size());
  for (size_t k = 0; k < out.size(); ++k) {
    const std::array<int, 4>& at = value_indices.shear[k];
    out[k] = normal[value_indices.normal[k]] +
             c33 * (shear[at[0]] + shear[at[1]] + shear[at[2]] + shear[at[3]]);
  }
  return out;
}

std::vector<double> assumed_membrane_invariant(const ProductTable& table, const PairNumbers& pairs,
                                               const Eigen::Matrix3d& elasticity) {
  const MatrixXd w = of_assumed_strains(table, pairs, elasticity);
  std::vector<double> out;
  for (size_t block = 0; block + 1 < pairs.starts.size(); ++block)
    for (int p = pairs.starts[block]; p < pairs.starts[block + 1]; ++p)
      for (int q = pairs.starts[block]; q <= p; ++q) out.push_back(w(p, q));
  return out;
}

std::vector<double> full_squares(const PairNumbers& pairs, const std::vector<double>& triangles) {
  std::vector<double> out;
  size_t at = 0;
  for (size_t c = 0; c + 1 < pairs.starts.size(); ++c) {
    const auto m = static_cast<size_t>(pairs.starts[c + 1] - pairs.starts[c]), block = out.size();
    out.resize(block + m * m);
    for (size_t r = 0; r < m; ++r)
      for (size_t t = 0; t <= r; ++t, ++at)
        out[block + r * m + t] = out[block + t * m + r] = triangles[at];
  }
  return out;
}

}  // namespace flexmorph::fem
