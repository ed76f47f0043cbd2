#include "fem/solve/supernodal_factor.h"

#include <cblas.h>
#include <cholmod.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

namespace flexmorph::fem {

namespace {

// Largest relaxed supernodes: measured on a plate of 400 x 40 cells, wide enough for the
// block products, narrow enough that the zeros they store cost less than they bring.
constexpr std::size_t kNarrow = 8, kMiddle = 16, kWide = 32;
constexpr double kZerosMiddle = 0.3, kZerosWide = 0.12, kZerosAny = 0.02;

// Part of its diagonal entry that a pivot keeps at least: less is cancellation of all digits, as of
// a plate that is cut off from its root and floats. (A plate that hangs on a void of factor 1e-9
// keeps about 1e-9.)
constexpr double kSmallestPivot = 1e-12;

/// Loads [first, first + count) whose active block reaches beyond `column`.
struct LoadRange {
  int first, count;
};

LoadRange reaching(std::span<const int> active, int column) {
  const int n = static_cast<int>(active.size());
  if (n == 0) return {0, 0};
  if (active.front() >= active.back()) {
    const auto end =
        std::partition_point(active.begin(), active.end(), [column](int a) { return a > column; });
    return {0, static_cast<int>(end - active.begin())};
  }
  const auto begin =
      std::partition_point(active.begin(), active.end(), [column](int a) { return a <= column; });
  const int first = static_cast<int>(begin - active.begin());
  return {first, n - first};
}

}  // namespace

struct SupernodalFactor::Impl {
  std::vector<int> starts, rows;
  std::vector<double> values;
  std::vector<char> contiguous;  // by supernode: its rows below the diagonal block are a range
  mutable MatrixXd gathered;     // (n_loads x rows below), for supernodes that are not
  int most_below = 0;
  cholmod_common common;
  cholmod_sparse matrix{};
  cholmod_factor* factor = nullptr;

  Impl() { cholmod_start(&common); }
  ~Impl() {
    cholmod_free_factor(&factor, &common);
    cholmod_finish(&common);
  }
  Impl(const Impl&) = delete;
  Impl& operator=(const Impl&) = delete;

  struct Supernode {
    int first, last;      // columns
    int height, n_below;  // rows of the block, rows below its triangle
    const double* block;  // column-major, leading dimension height
    const int* below;     // row indices
    bool contiguous;

    int width() const { return last - first; }
    const double* rectangle() const { return block + width(); }
  };

  int n_supernodes() const { return static_cast<int>(factor->nsuper); }

  Supernode supernode(int s) const {
    const int* super = static_cast<const int*>(factor->super);
    const int* pi = static_cast<const int*>(factor->pi);
    const int* px = static_cast<const int*>(factor->px);
    const int width = super[s + 1] - super[s];
    const int height = pi[s + 1] - pi[s];
    return {super[s],
            super[s + 1],
            height,
            height - width,
            static_cast<const double*>(factor->x) + px[s],
            static_cast<const int*>(factor->s) + pi[s] + width,
            contiguous[static_cast<std::size_t>(s)] != 0};
  }

  void analyse();
  double* gather_buffer(Eigen::Index n_loads) const {
    if (gathered.rows() < n_loads || gathered.cols() < most_below) {
      gathered.resize(n_loads, most_below);
    }
    return gathered.data();
  }
};

void SupernodalFactor::Impl::analyse() {
  const std::size_t n = starts.size() - 1;
  matrix.nrow = matrix.ncol = n;
  matrix.nzmax = rows.size();
  matrix.p = starts.data();
  matrix.i = rows.data();
  matrix.x = values.data();
  matrix.stype = -1;
  matrix.itype = CHOLMOD_INT;
  matrix.xtype = CHOLMOD_REAL;
  matrix.dtype = CHOLMOD_DOUBLE;
  matrix.sorted = matrix.packed = 1;

  common.supernodal = CHOLMOD_SUPERNODAL;
  common.nmethods = 1;
  common.method[0].ordering = CHOLMOD_NATURAL;
  common.postorder = 0;
  common.print = 0;
  common.quick_return_if_not_posdef = 1;
  common.nrelax[0] = kNarrow;
  common.nrelax[1] = kMiddle;
  common.nrelax[2] = kWide;
  common.zrelax[0] = kZerosMiddle;
  common.zrelax[1] = kZerosWide;
  common.zrelax[2] = kZerosAny;
  factor = cholmod_analyze(&matrix, &common);
  if (factor == nullptr || factor->is_super == 0) {
    throw Error::numerical("static solver: CHOLMOD could not analyse a matrix of " +
                           std::to_string(n) + " unknowns (status " +
                           std::to_string(common.status) + "; -2 is out of memory)");
  }
  const int* pi = static_cast<const int*>(factor->pi);
  const int* super = static_cast<const int*>(factor->super);
  const int* s_rows = static_cast<const int*>(factor->s);
  contiguous.resize(factor->nsuper);
  for (int s = 0; s < n_supernodes(); ++s) {
    const int begin = pi[s] + super[s + 1] - super[s], end = pi[s + 1];
    const bool range = begin == end || s_rows[end - 1] - s_rows[begin] == end - 1 - begin;
    contiguous[static_cast<std::size_t>(s)] = range;
    if (!range) most_below = std::max(most_below, end - begin);
  }
}

SupernodalFactor::SupernodalFactor(std::vector<int> starts, std::vector<int> rows)
    : impl_(std::make_unique<Impl>()) {
  impl_->starts = std::move(starts);
  impl_->rows = std::move(rows);
  impl_->values.assign(impl_->rows.size(), 0.0);
  impl_->analyse();
}

SupernodalFactor::~SupernodalFactor() = default;
SupernodalFactor::SupernodalFactor(SupernodalFactor&&) noexcept = default;

int SupernodalFactor::size() const { return static_cast<int>(impl_->matrix.nrow); }
std::span<double> SupernodalFactor::values() { return impl_->values; }

int SupernodalFactor::factorize() {
  Impl& m = *impl_;
  cholmod_factorize(&m.matrix, m.factor, &m.common);
  if (m.common.status < 0) {
    throw Error::numerical("static solver: CHOLMOD failed with status " +
                           std::to_string(m.common.status) + " (-2 is out of memory)");
  }
  if (m.factor->minor < m.factor->n) return static_cast<int>(m.factor->minor);
  for (int s = 0; s < m.n_supernodes(); ++s) {
    const Impl::Supernode node = m.supernode(s);
    for (int k = 0; k < node.width(); ++k) {
      const double pivot = node.block[static_cast<std::ptrdiff_t>(k) * (node.height + 1)];
      const double diagonal = m.values[static_cast<std::size_t>(
          m.starts[static_cast<std::size_t>(node.first) + static_cast<std::size_t>(k)])];
      if (!(pivot * pivot > kSmallestPivot * diagonal) || !std::isfinite(pivot)) {
        return node.first + k;
      }
    }
  }
  return -1;
}

void SupernodalFactor::forward(MatrixXd& x, std::span<const int> active) const {
  const Impl& m = *impl_;
  const int ld = static_cast<int>(x.rows());
  for (int s = 0; s < m.n_supernodes(); ++s) {
    const Impl::Supernode node = m.supernode(s);
    const auto [load, count] = reaching(active, node.first);
    if (count == 0) break;  // the blocks of later supernodes reach even fewer loads
    double* y = &x(load, node.first);
    cblas_dtrsm(CblasColMajor, CblasRight, CblasLower, CblasTrans, CblasNonUnit, count,
                node.width(), 1, node.block, node.height, y, ld);
    if (node.n_below == 0) continue;
    if (node.contiguous) {
      cblas_dgemm(CblasColMajor, CblasNoTrans, CblasTrans, count, node.n_below, node.width(), -1, y,
                  ld, node.rectangle(), node.height, 1, &x(load, node.below[0]), ld);
      continue;
    }
    double* g = m.gather_buffer(x.rows());
    cblas_dgemm(CblasColMajor, CblasNoTrans, CblasTrans, count, node.n_below, node.width(), 1, y,
                ld, node.rectangle(), node.height, 0, g, count);
    for (int k = 0; k < node.n_below; ++k) {
      x.col(node.below[k]).segment(load, count) -=
          Eigen::Map<const VectorXd>(g + static_cast<std::ptrdiff_t>(k) * count, count);
    }
  }
}

void SupernodalFactor::backward(MatrixXd& x, std::span<const int> active, const Fill& fill) const {
  const Impl& m = *impl_;
  const int ld = static_cast<int>(x.rows());
  for (int s = m.n_supernodes() - 1; s >= 0; --s) {
    const Impl::Supernode node = m.supernode(s);
    const auto [load, count] = reaching(active, node.first);
    x.block(0, node.first, load, node.width()).setZero();
    x.block(load + count, node.first, ld - load - count, node.width()).setZero();
    if (count == 0) continue;
    if (fill) fill(node.first, node.last, load, count);
    // Lᵀ is upper triangular: held entries that start as zero stay zero, and so does the cut.
    for (int l = load; l < load + count; ++l) {
      const int kept = active[static_cast<std::size_t>(l)];
      for (int k = kept; k < node.last; ++k) x(l, k) = 0;
    }
    double* y = &x(load, node.first);
    if (node.n_below > 0) {
      const double* below = &x(load, node.below[0]);
      int below_ld = ld;
      if (!node.contiguous) {
        double* g = m.gather_buffer(x.rows());
        for (int k = 0; k < node.n_below; ++k) {
          Eigen::Map<VectorXd>(g + static_cast<std::ptrdiff_t>(k) * count, count) =
              x.col(node.below[k]).segment(load, count);
        }
        below = g;
        below_ld = count;
      }
      cblas_dgemm(CblasColMajor, CblasNoTrans, CblasNoTrans, count, node.width(), node.n_below, -1,
                  below, below_ld, node.rectangle(), node.height, 1, y, ld);
    }
    cblas_dtrsm(CblasColMajor, CblasRight, CblasLower, CblasNoTrans, CblasNonUnit, count,
                node.width(), 1, node.block, node.height, y, ld);
  }
}

}  // namespace flexmorph::fem
