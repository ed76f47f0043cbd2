#include <Spectra/GenEigsSolver.h>
#include <Spectra/SymGEigsShiftSolver.h>

#include <algorithm>
#include <cmath>

#include "fem/solve/eigenpairs.h"
#include "fem/solve/linear_solver.h"

namespace flexmorph::fem {
namespace {

using Complex = std::complex<double>;

constexpr int kMaxRestarts = 300;     // of the Krylov methods
constexpr int kMaxSearches = 20;      // of the Lanczos method, see lanczos()
constexpr double kTolerance = 1e-11;  // relative error of an eigenvalue

/// Returns the number of eigenvalues of the quadratic problem in which `count` conjugate pairs are
/// contained.
int number_of_pairs(int count) { return 2 * count + 2; }

/// Returns the number of vectors of the Krylov space for a number of eigenvalues.
int krylov_size(int count) { return std::max(2 * count + 1, count + 20); }

/// The factored matrix [A Jᵀ; J 0].
class BorderedFactor {
 public:
  BorderedFactor(const SparseMatrix& a, const SparseMatrix& rows) : n_(a.rows()) {
    // Rows of the size of A keep the matrix well scaled.
    double size = 0;
    for (int k = 0; k < a.outerSize(); ++k)
      for (SparseMatrix::InnerIterator it(a, k); it; ++it)
        size = std::max(size, std::abs(it.value()));
    if (!(size > 0)) size = 1;
    std::vector<Eigen::Triplet<double>> entries;
    for (int k = 0; k < a.outerSize(); ++k)
      for (SparseMatrix::InnerIterator it(a, k); it; ++it)
        entries.emplace_back(it.row(), it.col(), it.value() / size);
    for (int k = 0; k < rows.outerSize(); ++k)
      for (SparseMatrix::InnerIterator it(rows, k); it; ++it) {
        entries.emplace_back(n_ + it.row(), it.col(), it.value());
        entries.emplace_back(it.col(), n_ + it.row(), it.value());
      }
    const Eigen::Index all = n_ + rows.rows();
    matrix_.resize(all, all);
    matrix_.setFromTriplets(entries.begin(), entries.end());
    matrix_.makeCompressed();
    scale_ = 1 / size;
    solver_.analyze(matrix_);
    solver_.factorize(matrix_);
    right_.setZero(all);
  }

  /// Computes φ of A φ + Jᵀ μ = b, J φ = 0.
  template <class Out>
  void solve(const VectorXd& b, Out&& phi) const {
    right_.head(n_) = scale_ * b;
    solver_.solve(matrix_, right_, solution_);
    phi = solution_.head(n_);
  }

  Eigen::Index rows() const { return n_; }

 private:
  Eigen::Index n_;
  double scale_ = 1;
  SparseMatrix matrix_;
  DirectSolver solver_;
  mutable VectorXd right_, solution_;
};

/// A starting vector without symmetry, so that it contains all modes; the same at every call.
VectorXd start_vector(Eigen::Index n) {
  VectorXd out(n);
  double x = 0.5;
  for (double& each : out) {
    x = std::fmod(x + 0.6180339887498949, 1.0);  // low-discrepancy sequence
    each = x - 0.4;
  }
  return out;
}

/// Returns the dimensions of Krylov spaces that are tried one after the other. A larger space
/// converges where the wanted modes end between two of nearly equal size.
/// @param n  number of unknowns, which a space does not exceed
std::vector<int> krylov_sizes(int count, Eigen::Index n) {
  std::vector<int> out = {krylov_size(count)};
  for (int k = 0; k < 3 && 4 * out.back() <= n; ++k) out.push_back(2 * out.back());
  return out;
}

[[noreturn]] void refuse() {
  throw Error::numerical(
      "natural frequencies: the eigenvalue iteration did not converge; ask for another number of "
      "modes (--count)");
}

/// The inverse operator of the symmetric problem without the modes that are known already, in the
/// form that Spectra calls.
struct SymmetricInverse {
  using Scalar = double;
  const BorderedFactor& factor;
  MatrixXd known{}, mass_known{};  // known modes φ with φᵀ M φ = 1, and M φ (n x number)
  Eigen::Index rows() const { return factor.rows(); }
  Eigen::Index cols() const { return factor.rows(); }
  void set_shift(double) {}
  void perform_op(const double* in, double* out) const {
    Eigen::Map<VectorXd> phi(out, rows());
    factor.solve(Eigen::Map<const VectorXd>(in, rows()), phi);
    if (known.cols() > 0) phi -= known * (mass_known.transpose() * phi);
  }
};

/// The product with the mass matrix, in the form that Spectra calls.
struct MassProduct {
  using Scalar = double;
  const SparseMatrix& mass;
  Eigen::Index rows() const { return mass.rows(); }
  Eigen::Index cols() const { return mass.rows(); }
  void perform_op(const double* in, double* out) const {
    Eigen::Map<VectorXd>(out, rows()).noalias() = mass * Eigen::Map<const VectorXd>(in, rows());
  }
};

/// Modes of the symmetric problem: ω² in units of the squared shift, and vectors φ (columns).
struct SymmetricModes {
  VectorXd squares;
  MatrixXd vectors;
};

SymmetricModes lowest_modes(SymmetricInverse& inverse, const SparseMatrix& mass, int count) {
  MassProduct product{mass};
  const VectorXd start = start_vector(mass.rows());
  for (const int size : krylov_sizes(count, mass.rows())) {
    Spectra::SymGEigsShiftSolver<SymmetricInverse, MassProduct, Spectra::GEigsMode::ShiftInvert>
        solver(inverse, product, count, size, -1);
    solver.init(start.data());
    solver.compute(Spectra::SortRule::LargestMagn, kMaxRestarts, kTolerance,
                   Spectra::SortRule::SmallestAlge);
    if (solver.info() == Spectra::CompInfo::Successful)
      return {solver.eigenvalues(), solver.eigenvectors()};
  }
  refuse();
}

std::vector<Eigenpair> lanczos(const SmallMotion& motion, double shift, int count) {
  const SparseMatrix mass = shift * shift * motion.mass;  // so that the shift is one
  const BorderedFactor factor(motion.stiffness + mass, motion.constraints);
  SymmetricInverse inverse{factor};
  std::vector<Eigenpair> out;
  double largest = 0;
  // A Krylov space of one vector may contain only one of several modes of equal frequency, such as
  // rigid motions. Therefore the search is repeated without the modes that are known.
  for (int search = 0, wanted = count; search < kMaxSearches; ++search, wanted = 1) {
    const SymmetricModes found = lowest_modes(inverse, mass, wanted);
    if (search > 0 && !(found.squares.minCoeff() < largest)) break;
    if (search == 0) largest = found.squares.maxCoeff();
    const Eigen::Index known = inverse.known.cols(), more = found.vectors.cols();
    inverse.known.conservativeResize(mass.rows(), known + more);
    inverse.known.rightCols(more) = found.vectors;
    inverse.mass_known = mass * inverse.known;
    for (Eigen::Index k = 0; k < more; ++k)
      out.push_back(
          {shift * std::sqrt(Complex(-found.squares[k])), found.vectors.col(k).cast<Complex>()});
  }
  return out;
}

/// The inverse operator of the linearized quadratic problem: (φ₀, ψ₀) -> (φ, ψ), with the shift as
/// the unit of s. Eigenvalues are 1/(s - 1).
struct QuadraticInverse {
  using Scalar = double;
  const BorderedFactor& factor;
  const SparseMatrix &damping, &mass;
  Eigen::Index rows() const { return 2 * mass.rows(); }
  Eigen::Index cols() const { return rows(); }
  void perform_op(const double* in, double* out) const {
    const Eigen::Index n = mass.rows();
    const Eigen::Map<const VectorXd> phi0(in, n), psi0(in + n, n);
    const VectorXd right = -(mass * (psi0 + phi0) + damping * phi0);
    Eigen::Map<VectorXd> phi(out, n), psi(out + n, n);
    factor.solve(right, phi);
    psi = phi0 + phi;
  }
};

std::vector<Eigenpair> arnoldi(const SmallMotion& motion, double shift, int count) {
  const SparseMatrix mass = shift * shift * motion.mass, damping = shift * motion.damping;
  const BorderedFactor factor(motion.stiffness + damping + mass, motion.constraints);
  const QuadraticInverse inverse{factor, damping, mass};
  const Eigen::Index n = mass.rows();
  const int pairs = number_of_pairs(count);
  VectorXd start = start_vector(2 * n), next(2 * n);
  for (int k = 0; k < 2; ++k) {  // so that φ and ψ satisfy the constraints
    inverse.perform_op(start.data(), next.data());
    start.swap(next);
  }
  for (const int size : krylov_sizes(pairs, n)) {
    Spectra::GenEigsSolver<QuadraticInverse> solver(const_cast<QuadraticInverse&>(inverse), pairs,
                                                    size);
    solver.init(start.data());
    solver.compute(Spectra::SortRule::LargestMagn, kMaxRestarts, kTolerance,
                   Spectra::SortRule::LargestMagn);
    if (solver.info() != Spectra::CompInfo::Successful) continue;
    std::vector<Eigenpair> out;
    const VectorXcd values = solver.eigenvalues();
    const auto vectors = solver.eigenvectors();
    for (Eigen::Index k = 0; k < values.size(); ++k)
      out.push_back({shift * (1.0 + 1.0 / values[k]), vectors.col(k).head(n)});
    return out;
  }
  refuse();
}

}  // namespace

std::vector<Eigenpair> krylov_eigenpairs(const SmallMotion& motion, double shift, int count) {
  return motion.is_symmetric ? lanczos(motion, shift, count) : arnoldi(motion, shift, count);
}

int krylov_dimensions(const SmallMotion& motion, int count) {
  return krylov_size(motion.is_symmetric ? count : number_of_pairs(count));
}

}  // namespace flexmorph::fem
