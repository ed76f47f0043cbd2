#include "fem/solve/factorization/saddle_cholesky.h"

#include <cholmod.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <vector>

#include "fem/solve/factorization/substitution.h"

namespace flexmorph::fem {

namespace {

/// With more rows of B their right-hand sides cost more than UMFPACK's factor.
constexpr int kMostConstraints = 32;
/// Entries that differ by less, relative to the largest, are equal: round-off of the elements.
constexpr double kSymmetry = 1e-13;
/// Estimates of the reciprocal condition below which UMFPACK, which pivots, is asked: A alone may
/// be near to singular where the whole matrix is not (a body held by nothing but constraints).
constexpr double kTrusted = 1e-9;

}  // namespace

struct SaddleCholesky::Impl {
  cholmod_common common;
  cholmod_sparse matrix{};  // lower triangle of A
  cholmod_factor* factor = nullptr;
  cholmod_dense *solution = nullptr, *work_y = nullptr, *work_e = nullptr;

  struct Pair {
    int lower, upper;  // places of (i, j) and (j, i) in the whole matrix
  };
  struct Entry {
    int row, column, place;  // of B
  };
  std::vector<int> a_rows, b_rows;  // unknowns of the whole matrix
  std::vector<int> starts, rows, places;
  std::vector<int> mirrors;  // places of the same entries in the other triangle
  std::vector<double> values;
  std::vector<Pair> a_pairs, b_pairs;
  std::vector<Entry> b_entries;
  std::vector<double> b_values;
  MatrixXd spread, y;  // Bᵀ, A⁻¹ Bᵀ (n_a x m)
  MatrixXd schur;
  Eigen::LLT<MatrixXd> schur_factor;
  VectorXd right, multipliers;
  VectorXd permuted, block;  // in the order of the factor; rows of one supernode
  VectorXd tried, image, back;
  bool refused = false;  // the symmetric part of a matrix with this pattern

  Impl() {
    cholmod_start(&common);
    common.print = 0;
    common.supernodal = CHOLMOD_SUPERNODAL;
    common.nmethods = 1;
    common.method[0].ordering = CHOLMOD_AMD;
    common.postorder = 1;
  }
  ~Impl() {
    release();
    cholmod_finish(&common);
  }
  void release() {
    cholmod_free_factor(&factor, &common);
    for (cholmod_dense** x : {&solution, &work_y, &work_e}) cholmod_free_dense(x, &common);
  }

  /// right = A⁻¹ of the rows of A of b: one right-hand side.
  void substitute(const VectorXd& b) {
    const auto* perm = static_cast<const int*>(factor->Perm);
    const auto *first = static_cast<const int*>(factor->super),
               *row_starts = static_cast<const int*>(factor->pi),
               *starts = static_cast<const int*>(factor->px),
               *all_rows = static_cast<const int*>(factor->s);
    const auto* x = static_cast<const double*>(factor->x);
    const auto n = static_cast<Eigen::Index>(a_rows.size());
    for (Eigen::Index k = 0; k < n; ++k) permuted[k] = b[a_rows[static_cast<size_t>(perm[k])]];
    // Rows of a supernode: its own columns first.
    for (size_t k = 0; k < factor->nsuper; ++k) {
      const int width = first[k + 1] - first[k], height = row_starts[k + 1] - row_starts[k];
      const int* at = all_rows + row_starts[k];
      std::copy_n(permuted.data() + first[k], width, block.data());
      std::fill(block.data() + width, block.data() + height, 0.0);
      forward_block(x + starts[k], width, height, block.data());
      std::copy_n(block.data(), width, permuted.data() + first[k]);
      for (int i = width; i < height; ++i) permuted[at[i]] += block[i];
    }
    for (size_t k = factor->nsuper; k-- > 0;) {
      const int width = first[k + 1] - first[k], height = row_starts[k + 1] - row_starts[k];
      const int* at = all_rows + row_starts[k];
      for (int i = 0; i < height; ++i) block[i] = permuted[at[i]];
      backward_block(x + starts[k], width, height, block.data());
      std::copy_n(block.data(), width, permuted.data() + first[k]);
    }
    for (Eigen::Index k = 0; k < n; ++k) right[perm[k]] = permuted[k];
  }

  /// solution = A⁻¹ x, by columns.
  bool apply_inverse(MatrixXd& x) {
    cholmod_dense b{};
    b.nrow = b.d = static_cast<size_t>(x.rows());
    b.ncol = static_cast<size_t>(x.cols());
    b.nzmax = static_cast<size_t>(x.size());
    b.x = x.data();
    b.xtype = CHOLMOD_REAL;
    b.dtype = CHOLMOD_DOUBLE;
    return cholmod_solve2(CHOLMOD_A, factor, &b, nullptr, &solution, nullptr, &work_y, &work_e,
                          &common) != 0;
  }
  auto solved() const {
    return Eigen::Map<const MatrixXd>(static_cast<const double*>(solution->x),
                                      static_cast<Eigen::Index>(solution->nrow),
                                      static_cast<Eigen::Index>(solution->ncol));
  }

  bool split(const SparseMatrix& a);
  void view_matrix();

  static bool symmetric(const std::vector<Pair>& pairs, const SparseMatrix& a) {
    const double* x = a.valuePtr();
    const double allowed =
        kSymmetry * Eigen::Map<const VectorXd>(x, a.nonZeros()).lpNorm<Eigen::Infinity>();
    return std::all_of(pairs.begin(), pairs.end(),
                       [&](const Pair& p) { return std::abs(x[p.lower] - x[p.upper]) <= allowed; });
  }
};

SaddleCholesky::SaddleCholesky() : impl_(std::make_unique<Impl>()) {}
SaddleCholesky::~SaddleCholesky() = default;

namespace {

/// Where the matrix keeps an entry, or -1.
int place_of(const SparseMatrix& a, int row, int column) {
  const int *first = a.innerIndexPtr() + a.outerIndexPtr()[column],
            *last = a.innerIndexPtr() + a.outerIndexPtr()[column + 1],
            *at = std::lower_bound(first, last, row);
  return at != last && *at == row ? static_cast<int>(at - a.innerIndexPtr()) : -1;
}

}  // namespace

bool SaddleCholesky::analyze(const SparseMatrix& a) {
  Impl& s = *impl_;
  s.release();
  s.refused = false;
  if (!s.split(a)) return false;
  s.view_matrix();
  s.factor = cholmod_analyze(&s.matrix, &s.common);
  if (s.factor == nullptr || s.common.status < CHOLMOD_OK || !s.factor->is_super) return false;
  const auto* row_starts = static_cast<const int*>(s.factor->pi);
  int tallest = 0;
  for (size_t k = 0; k < s.factor->nsuper; ++k)
    tallest = std::max(tallest, row_starts[k + 1] - row_starts[k]);
  s.block.resize(tallest);
  s.permuted.resize(static_cast<Eigen::Index>(s.a_rows.size()));
  s.right.resize(s.permuted.size());
  return true;
}

/// Which rows and entries belong to A and which to B; false where the matrix is no such saddle.
bool SaddleCholesky::Impl::split(const SparseMatrix& a) {
  const auto n = static_cast<int>(a.rows());
  std::vector<int> number(static_cast<size_t>(n));  // in A, or - 1 - the one in B
  a_rows.clear();
  b_rows.clear();
  for (int k = 0; k < n; ++k) {
    auto& list = place_of(a, k, k) >= 0 ? a_rows : b_rows;
    const auto at = static_cast<int>(list.size());
    number[static_cast<size_t>(k)] = &list == &a_rows ? at : -1 - at;
    list.push_back(k);
  }
  if (b_rows.size() > kMostConstraints || a_rows.empty()) return false;

  starts = {0};
  rows.clear();
  places.clear();
  mirrors.clear();
  a_pairs.clear();
  b_pairs.clear();
  b_entries.clear();
  for (int column = 0; column < n; ++column) {
    const int j = number[static_cast<size_t>(column)];
    for (int p = a.outerIndexPtr()[column]; p < a.outerIndexPtr()[column + 1]; ++p) {
      const int row = a.innerIndexPtr()[p], i = number[static_cast<size_t>(row)];
      if (i < 0 && j < 0) return false;  // coupled constraints
      if (row > column) {
        const int other = place_of(a, column, row);
        if (other < 0) return false;
        (i >= 0 && j >= 0 ? a_pairs : b_pairs).push_back({p, other});
      }
      if (i >= 0 && j >= 0 && i >= j) {
        rows.push_back(i);
        places.push_back(p);
        mirrors.push_back(place_of(a, column, row));
      }
      if (i < 0) b_entries.push_back({-1 - i, j, p});
    }
    if (j >= 0) starts.push_back(static_cast<int>(rows.size()));
  }
  values.resize(rows.size());
  b_values.resize(b_entries.size());
  return true;
}

/// A as CHOLMOD takes it: its lower triangle in the vectors of split().
void SaddleCholesky::Impl::view_matrix() {
  matrix.nrow = matrix.ncol = a_rows.size();
  matrix.nzmax = rows.size();
  matrix.p = starts.data();
  matrix.i = rows.data();
  matrix.x = values.data();
  matrix.stype = -1;
  matrix.itype = CHOLMOD_INT;
  matrix.xtype = CHOLMOD_REAL;
  matrix.dtype = CHOLMOD_DOUBLE;
  matrix.sorted = matrix.packed = 1;
}

bool SaddleCholesky::factorize(const SparseMatrix& a, double miss) {
  const bool symmetric = Impl::symmetric(impl_->a_pairs, a);
  if (!Impl::symmetric(impl_->b_pairs, a)) return false;
  if (symmetric) return factorize_symmetric_part(a);
  if (!(miss > 0) || impl_->refused) return false;
  impl_->refused = !factorize_symmetric_part(a) || misses(a) > miss;
  return !impl_->refused;
}

bool SaddleCholesky::is_refused() const { return impl_->refused; }
void SaddleCholesky::set_refused(bool refused) { impl_->refused = refused; }

double SaddleCholesky::misses(const SparseMatrix& a) {
  constexpr int kPasses = 2;
  Impl& s = *impl_;
  s.tried.setZero(a.rows());
  for (size_t k = 0; k < s.a_rows.size(); ++k)  // any vector that is no eigenvector
    s.tried[s.a_rows[k]] = std::cos(static_cast<double>(k * k));
  double out = 0;
  for (int pass = 0; pass < kPasses; ++pass) {
    s.tried /= s.tried.lpNorm<Eigen::Infinity>();
    s.image.noalias() = a * s.tried;
    solve(s.image, s.back);
    s.tried -= s.back;
    for (const int row : s.b_rows) s.tried[row] = 0;
    out = s.tried.lpNorm<Eigen::Infinity>();
    if (out == 0) break;
  }
  return out;
}

bool SaddleCholesky::factorize_symmetric_part(const SparseMatrix& a) {
  Impl& s = *impl_;
  const double* entries = a.valuePtr();
  for (size_t k = 0; k < s.places.size(); ++k)
    s.values[k] = 0.5 * (entries[s.places[k]] + entries[s.mirrors[k]]);
  if (!cholmod_factorize(&s.matrix, s.factor, &s.common) || s.common.status != CHOLMOD_OK ||
      s.factor->minor < s.factor->n || cholmod_rcond(s.factor, &s.common) < kTrusted)
    return false;
  const auto n = static_cast<Eigen::Index>(s.a_rows.size()),
             m = static_cast<Eigen::Index>(s.b_rows.size());
  if (m == 0) return true;
  s.spread.setZero(n, m);
  for (size_t k = 0; k < s.b_entries.size(); ++k) {
    s.b_values[k] = entries[s.b_entries[k].place];
    s.spread(s.b_entries[k].column, s.b_entries[k].row) = s.b_values[k];
  }
  if (!s.apply_inverse(s.spread)) return false;
  s.y = s.solved();
  s.schur.noalias() = s.spread.transpose() * s.y;
  s.schur_factor.compute(s.schur);
  return s.schur_factor.info() == Eigen::Success && s.schur_factor.rcond() > kTrusted;
}

void SaddleCholesky::solve(const VectorXd& b, VectorXd& x) {
  // x = A⁻¹ f - Y λ,   B Y λ = B A⁻¹ f - g
  Impl& s = *impl_;
  const auto n = s.a_rows.size(), m = s.b_rows.size();
  s.substitute(b);
  if (m > 0) {
    s.multipliers.resize(static_cast<Eigen::Index>(m));
    for (size_t k = 0; k < m; ++k) s.multipliers[static_cast<Eigen::Index>(k)] = -b[s.b_rows[k]];
    for (size_t k = 0; k < s.b_entries.size(); ++k)
      s.multipliers[s.b_entries[k].row] += s.b_values[k] * s.right[s.b_entries[k].column];
    s.schur_factor.solveInPlace(s.multipliers);
    s.right.noalias() -= s.y * s.multipliers;
  }
  x.resize(b.size());
  for (size_t k = 0; k < n; ++k) x[s.a_rows[k]] = s.right[static_cast<Eigen::Index>(k)];
  for (size_t k = 0; k < m; ++k) x[s.b_rows[k]] = s.multipliers[static_cast<Eigen::Index>(k)];
}

}  // namespace flexmorph::fem
