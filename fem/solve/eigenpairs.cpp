#include "fem/solve/eigenpairs.h"

#include <Eigen/Dense>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

namespace flexmorph::fem {
namespace {

using Complex = std::complex<double>;

constexpr int kMaxDense = 120;  // unknowns of a problem that is solved by dense matrices

/// Returns an orthonormal basis of the null space of the constraints (n x degrees_of_freedom).
MatrixXd null_space(const SmallMotion& motion) {
  const Eigen::Index n = motion.mass.rows(), m = motion.constraints.rows();
  if (m == 0) return MatrixXd::Identity(n, n);
  const Eigen::HouseholderQR<MatrixXd> qr(MatrixXd(motion.constraints).transpose());
  MatrixXd out = MatrixXd::Zero(n, n - m);
  out.bottomRows(n - m).setIdentity();
  out.applyOnTheLeft(qr.householderQ());
  return out;
}

std::vector<Eigenpair> dense_symmetric(const MatrixXd& basis, const MatrixXd& stiffness,
                                       const MatrixXd& mass) {
  std::vector<Eigenpair> out;
  const auto add = [&](double square, const VectorXd& y) {
    out.push_back({std::sqrt(Complex(square)), (basis * y).cast<Complex>()});
  };
  // The inverse problem M y = ν (K + M) y has accurate low frequencies, and M may be singular.
  const MatrixXd shifted = stiffness + mass;
  if (shifted.llt().info() == Eigen::Success) {
    const Eigen::GeneralizedSelfAdjointEigenSolver<MatrixXd> eigen(mass, shifted);
    for (Eigen::Index k = mass.rows() - 1; k >= 0; --k)
      if (const double nu = eigen.eigenvalues()[k]; nu > 1e-14)
        add(1 - 1 / nu, eigen.eigenvectors().col(k));
    return out;
  }
  // Some s² are above the shift: the state is unstable.
  const Eigen::EigenSolver<MatrixXd> eigen(shifted.partialPivLu().solve(mass));
  for (Eigen::Index k = 0; k < mass.rows(); ++k)
    if (const double nu = eigen.eigenvalues()[k].real(); std::abs(nu) > 1e-14)
      add(1 - 1 / nu, eigen.eigenvectors().col(k).real());
  return out;
}

std::vector<Eigenpair> dense_quadratic(const MatrixXd& basis, const MatrixXd& stiffness,
                                       const MatrixXd& damping, const MatrixXd& mass) {
  const Eigen::Index r = mass.rows();
  const Eigen::PartialPivLU<MatrixXd> factor(stiffness + damping + mass);
  MatrixXd inverse(2 * r, 2 * r);
  inverse.topLeftCorner(r, r) = -factor.solve(damping + mass);
  inverse.topRightCorner(r, r) = -factor.solve(mass);
  inverse.bottomRows(r) = inverse.topRows(r);
  inverse.bottomLeftCorner(r, r).diagonal().array() += 1;
  const Eigen::EigenSolver<MatrixXd> eigen(inverse);
  std::vector<Eigenpair> out;
  for (Eigen::Index k = 0; k < 2 * r; ++k)
    if (const Complex nu = eigen.eigenvalues()[k]; std::abs(nu) > 1e-14)
      out.push_back({1.0 + 1.0 / nu, basis * eigen.eigenvectors().col(k).head(r)});
  return out;
}

}  // namespace

std::vector<Eigenpair> dense_eigenpairs(const SmallMotion& motion, double shift) {
  const MatrixXd basis = null_space(motion);
  const auto reduced = [&](const SparseMatrix& a, double factor) {
    return MatrixXd(factor * (basis.transpose() * (a * basis)));
  };
  const MatrixXd K = reduced(motion.stiffness, 1), M = reduced(motion.mass, shift * shift);
  std::vector<Eigenpair> out =
      motion.is_symmetric
          ? dense_symmetric(basis, 0.5 * (K + K.transpose()), 0.5 * (M + M.transpose()))
          : dense_quadratic(basis, K, reduced(motion.damping, shift), M);
  for (Eigenpair& each : out) each.value *= shift;
  return out;
}

std::vector<Eigenpair> eigenpairs(const SmallMotion& motion, double shift, int count) {
  const int n = static_cast<int>(motion.mass.rows()), n_free = motion.degrees_of_freedom();
  std::vector<Eigenpair> out;
  if (n_free == 0) return out;
  out = n <= kMaxDense || n_free < 2 * krylov_dimensions(motion, count)
            ? dense_eigenpairs(motion, shift)
            : krylov_eigenpairs(motion, shift, count);
  std::erase_if(out, [](const Eigenpair& each) {
    return each.value.imag() < -1e-9 * std::abs(each.value);  // its conjugate stays
  });
  std::stable_sort(out.begin(), out.end(), [](const Eigenpair& a, const Eigenpair& b) {
    return std::abs(a.value) < std::abs(b.value);
  });
  if (out.size() > static_cast<size_t>(count)) out.resize(static_cast<size_t>(count));
  for (const Eigenpair& each : out)
    if (!std::isfinite(std::abs(each.value)) || !each.shape.allFinite())
      throw Error::numerical("natural frequencies: a mode has numbers that are not finite");
  return out;
}

}  // namespace flexmorph::fem
