#include "fem/solve/factorization/supernodal_factor.h"

#include <omp.h>

#include <algorithm>
#include <cstddef>
#include <utility>

#include "fem/solve/factorization/dense_blocks.h"
#include "fem/solve/factorization/multifrontal.h"

namespace flexmorph::fem {

namespace {

using dense::pull_below;
using dense::push_below;
using dense::solve_triangle;

/// A range of loads, [first, first + count).
struct LoadRange {
  int first, count;
};

/// Returns the loads whose active block reaches beyond `column`.
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

/// Returns the loads of `mine`, those of one thread, whose active block reaches beyond `column`.
LoadRange reaching(std::span<const int> active, int column, const LoadRange& mine) {
  const LoadRange all = reaching(active, column);
  const int first = std::max(all.first, mine.first);
  const int end = std::min(all.first + all.count, mine.first + mine.count);
  return {std::min(first, mine.first + mine.count), std::max(0, end - first)};
}

/// Blocks of loads that are processed together. They do not depend on the number of threads,
/// because BLAS sums in an order that depends on the number of columns, and the last bits of
/// results would differ. A supernode stays in the cache from block to block.
struct LoadBlocks {
  /// Fewer loads do too little work per entry of L that is read.
  static constexpr int kMinLoads = 16;
  static constexpr int kMaxThreads = 4;

  int n_loads, n;
  int first = 0, last = 0;  ///< Blocks of one thread.

  explicit LoadBlocks(int loads)
      : n_loads(loads), n(std::clamp(loads / kMinLoads, 1, kMaxThreads)), last(n) {}
  LoadRange block(int k) const {
    const int from = n_loads * k / n, to = n_loads * (k + 1) / n;
    return {from, to - from};
  }
};

/// Calls use(blocks) for the blocks of every thread, in parallel.
template <class Use>
void each_share(Eigen::Index n_loads, const Use& use) {
  const LoadBlocks all(static_cast<int>(n_loads));
  const int parts = std::min(all.n, omp_get_max_threads());
#pragma omp parallel for schedule(static, 1) num_threads(parts) if (parts > 1)
  for (int k = 0; k < parts; ++k) {
    LoadBlocks mine = all;
    mine.first = all.n * k / parts;
    mine.last = all.n * (k + 1) / parts;
    use(mine);
  }
}

}  // namespace

struct SupernodalFactor::Impl {
  Multifrontal front;
  std::vector<char> contiguous;  // by supernode: 1 if its rows below the triangle are a range
  // (rows below x n_loads), work space for supernodes that are not contiguous
  mutable MatrixXd gathered;
  int most_below = 0;

  struct Supernode {
    int first, last;      // columns
    int height, n_below;  // rows of the block, rows below its triangle
    const double* block;  // column-major, leading dimension height
    const int* below;     // row indices
    bool contiguous;

    int width() const { return last - first; }
    const double* rectangle() const { return block + width(); }
  };

  Impl(std::vector<int> starts, std::vector<int> rows)
      : front(std::move(starts), std::move(rows)) {}

  int n_supernodes() const { return front.blocks().n_blocks(); }

  Supernode supernode(int s) const {
    const auto at = static_cast<std::size_t>(s);
    const Supernodes& blocks = front.blocks();
    return {blocks.first[at], blocks.first[at + 1], blocks.height(s),   blocks.n_below(s),
            front.block(s),   blocks.below(s),      contiguous[at] != 0};
  }

  void find_ranges();
  void forward(int s, MatrixXd& x, std::span<const int> active, int tail,
               const LoadRange& mine) const;
  void backward(int s, MatrixXd& x, std::span<const int> active, const Fill& fill,
                const LoadRange& mine) const;
  void reserve_memory(Eigen::Index n_loads) const {
    if (gathered.cols() < n_loads || gathered.rows() < most_below)
      gathered.resize(most_below, n_loads);
  }
  /// Returns work space for the rows below a block that only these loads use.
  double* gather_buffer(const LoadRange& mine) const { return gathered.col(mine.first).data(); }
};

void SupernodalFactor::Impl::find_ranges() {
  contiguous.resize(static_cast<std::size_t>(n_supernodes()));
  for (int s = 0; s < n_supernodes(); ++s) {
    const int n = front.blocks().n_below(s);
    const int* below = front.blocks().below(s);
    const bool range = n == 0 || below[n - 1] - below[0] == n - 1;
    contiguous[static_cast<std::size_t>(s)] = range;
    if (!range) most_below = std::max(most_below, n);
  }
}

SupernodalFactor::SupernodalFactor(std::vector<int> starts, std::vector<int> rows)
    : impl_(std::make_unique<Impl>(std::move(starts), std::move(rows))) {
  impl_->find_ranges();
}

SupernodalFactor::~SupernodalFactor() = default;
SupernodalFactor::SupernodalFactor(SupernodalFactor&&) noexcept = default;

int SupernodalFactor::size() const { return impl_->front.size(); }
std::span<double> SupernodalFactor::values() { return impl_->front.values(); }
int SupernodalFactor::factorize() { return impl_->front.factorize(); }

double SupernodalFactor::condition() const { return impl_->front.condition(); }

void SupernodalFactor::forward(MatrixXd& x, std::span<const int> active, int tail) const {
  const Impl& m = *impl_;
  m.reserve_memory(x.rows());
  each_share(x.rows(), [&](const LoadBlocks& mine) {
    for (int s = 0; s < m.n_supernodes(); ++s)
      for (int k = mine.first; k < mine.last; ++k) m.forward(s, x, active, tail, mine.block(k));
  });
}

void SupernodalFactor::backward(MatrixXd& x, std::span<const int> active, const Fill& fill) const {
  const Impl& m = *impl_;
  m.reserve_memory(x.rows());
  each_share(x.rows(), [&](const LoadBlocks& mine) {
    for (int s = m.n_supernodes() - 1; s >= 0; --s)
      for (int k = mine.first; k < mine.last; ++k) m.backward(s, x, active, fill, mine.block(k));
  });
}

void SupernodalFactor::Impl::forward(int s, MatrixXd& x, std::span<const int> active, int tail,
                                     const LoadRange& mine) const {
  const int ld = static_cast<int>(x.rows());
  const Supernode node = supernode(s);
  const LoadRange reached = reaching(active, node.first, mine);
  if (reached.count == 0) return;
  const LoadRange zero = reaching(active, node.last + tail - 1, mine);
  const int count = reached.count - zero.count;
  if (count == 0) return;
  const int load = reached.first + (zero.first == reached.first ? zero.count : 0);
  double* y = &x(load, node.first);
  solve_triangle(node.block, node.width(), node.height, true, y, ld, count);
  if (node.n_below == 0) return;
  if (node.contiguous) {
    push_below(node.rectangle(), node.n_below, node.width(), node.height, y, ld, count, 1,
               &x(load, node.below[0]), ld);
    return;
  }
  double* g = gather_buffer(mine);
  push_below(node.rectangle(), node.n_below, node.width(), node.height, y, ld, count, 0, g, count);
  for (int k = 0; k < node.n_below; ++k) {
    double* __restrict to = &x(load, node.below[k]);
    const double* __restrict from = g + static_cast<std::ptrdiff_t>(k) * count;
    for (int l = 0; l < count; ++l) to[l] += from[l];
  }
}

void SupernodalFactor::Impl::backward(int s, MatrixXd& x, std::span<const int> active,
                                      const Fill& fill, const LoadRange& mine) const {
  const int ld = static_cast<int>(x.rows());
  const Supernode node = supernode(s);
  const auto [load, count] = reaching(active, node.first, mine);
  const int end = mine.first + mine.count;
  x.block(mine.first, node.first, load - mine.first, node.width()).setZero();
  x.block(load + count, node.first, end - load - count, node.width()).setZero();
  if (count == 0) return;
  if (fill) fill(node.first, node.last, load, count);
  // Lᵀ is upper triangular: entries behind the active block that start as zero stay zero.
  for (int l = load; l < load + count; ++l) {
    const int kept = active[static_cast<std::size_t>(l)];
    for (int k = kept; k < node.last; ++k) x(l, k) = 0;
  }
  double* y = &x(load, node.first);
  if (node.n_below > 0) {
    const double* below = &x(load, node.below[0]);
    int below_ld = ld;
    if (!node.contiguous) {
      double* g = gather_buffer(mine);
      for (int k = 0; k < node.n_below; ++k) {
        const double* from = &x(load, node.below[k]);
        std::copy(from, from + count, g + static_cast<std::ptrdiff_t>(k) * count);
      }
      below = g;
      below_ld = count;
    }
    pull_below(node.rectangle(), node.n_below, node.width(), node.height, below, below_ld, count, y,
               ld);
  }
  solve_triangle(node.block, node.width(), node.height, false, y, ld, count);
}

}  // namespace flexmorph::fem
