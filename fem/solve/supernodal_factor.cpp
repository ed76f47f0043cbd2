#include "fem/solve/supernodal_factor.h"

#include <omp.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

#include "fem/solve/condition.h"
#include "fem/solve/dense_blocks.h"
#include "fem/solve/supernodes.h"

namespace flexmorph::fem {

namespace {

using dense::cholesky;
using dense::Dense;
using dense::pull_below;
using dense::push_below;
using dense::solve_triangle;

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

/// The same among the loads of one thread.
LoadRange reaching(std::span<const int> active, int column, const LoadRange& mine) {
  const LoadRange all = reaching(active, column);
  const int first = std::max(all.first, mine.first);
  const int end = std::min(all.first + all.count, mine.first + mine.count);
  return {std::min(first, mine.first + mine.count), std::max(0, end - first)};
}

/// Loads go through a supernode in blocks that do not depend on the threads, or last bits would:
/// BLAS adds in another order where there are more or fewer columns. A supernode stays in the cache
/// from block to block.
struct LoadBlocks {
  static constexpr int kSmallest = 16;  ///< fewer loads stream L for little work
  static constexpr int kMost = 4;

  int n_loads, n;
  int first = 0, last = 0;  ///< blocks of one thread

  explicit LoadBlocks(int loads)
      : n_loads(loads), n(std::clamp(loads / kSmallest, 1, kMost)), last(n) {}
  LoadRange block(int k) const {
    const int from = n_loads * k / n, to = n_loads * (k + 1) / n;
    return {from, to - from};
  }
};

/// Calls use(blocks) for the share of every thread, at the same time.
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
  std::vector<int> starts;
  std::vector<double> values;  // of K
  Supernodes blocks;
  std::vector<double> factor;    // of L, block by block
  std::vector<double> stack;     // updates that wait for their parent
  std::vector<int> waiting;      // blocks whose updates are on the stack
  std::vector<char> contiguous;  // by supernode: its rows below the diagonal block are a range
  mutable MatrixXd gathered;     // (rows below x n_loads), room for supernodes that are not
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

  int n_supernodes() const { return blocks.n_blocks(); }

  Supernode supernode(int s) const {
    const auto at = static_cast<std::size_t>(s);
    return {blocks.first[at],
            blocks.first[at + 1],
            blocks.height(s),
            blocks.n_below(s),
            factor.data() + blocks.offset[at],
            blocks.below(s),
            contiguous[at] != 0};
  }

  void find_ranges();
  void fill_block(int s, double* block);
  void add_update(int child, const double* update, int parent, double* block, double* own) const;
  int factorize_block(int s, double* block, double keep, double* own) const;
  int smallest_pivot(int s) const;
  void forward(int s, MatrixXd& x, std::span<const int> active, int tail,
               const LoadRange& mine) const;
  void backward(int s, MatrixXd& x, std::span<const int> active, const Fill& fill,
                const LoadRange& mine) const;
  void make_room(Eigen::Index n_loads) const {
    if (gathered.cols() < n_loads || gathered.rows() < most_below)
      gathered.resize(most_below, n_loads);
  }
  /// Room for the rows below a block of these loads, and nobody else's.
  double* gather_buffer(const LoadRange& mine) const { return gathered.col(mine.first).data(); }
};

void SupernodalFactor::Impl::find_ranges() {
  contiguous.resize(static_cast<std::size_t>(n_supernodes()));
  for (int s = 0; s < n_supernodes(); ++s) {
    const int n = blocks.n_below(s);
    const int* below = blocks.below(s);
    const bool range = n == 0 || below[n - 1] - below[0] == n - 1;
    contiguous[static_cast<std::size_t>(s)] = range;
    if (!range) most_below = std::max(most_below, n);
  }
}

SupernodalFactor::SupernodalFactor(std::vector<int> starts, std::vector<int> rows)
    : impl_(std::make_unique<Impl>()) {
  Impl& m = *impl_;
  m.blocks = find_supernodes(starts, rows);
  m.starts = std::move(starts);
  m.values.assign(rows.size(), 0.0);
  m.factor.assign(m.blocks.offset.back(), 0.0);
  m.stack.assign(m.blocks.deepest_stack, 0.0);
  m.find_ranges();
}

SupernodalFactor::~SupernodalFactor() = default;
SupernodalFactor::SupernodalFactor(SupernodalFactor&&) noexcept = default;

int SupernodalFactor::size() const { return static_cast<int>(impl_->starts.size()) - 1; }
std::span<double> SupernodalFactor::values() { return impl_->values; }

double SupernodalFactor::condition() const {
  const Impl& m = *impl_;
  std::vector<Eigen::Triplet<double>> entries;
  entries.reserve(2 * m.values.size());
  for (int s = 0; s < m.n_supernodes(); ++s) {
    const Impl::Supernode block = m.supernode(s);
    const std::size_t begin = m.blocks.offset[static_cast<std::size_t>(s)];
    for (int c = block.first; c < block.last; ++c)
      for (int k = m.starts[static_cast<std::size_t>(c)];
           k < m.starts[static_cast<std::size_t>(c) + 1]; ++k) {
        const auto at = static_cast<std::size_t>(k);
        const auto row =
            static_cast<int>((m.blocks.place[at] - begin) % static_cast<std::size_t>(block.height));
        const int i = row < block.width() ? block.first + row : block.below[row - block.width()];
        entries.emplace_back(i, c, m.values[at]);
        if (i != c) entries.emplace_back(c, i, m.values[at]);
      }
  }
  SparseMatrix full(size(), size());
  full.setFromTriplets(entries.begin(), entries.end());
  return condition_estimate(std::move(full));
}

/// Entries of K in the columns of a block.
void SupernodalFactor::Impl::fill_block(int s, double* block) {
  const auto at = static_cast<std::size_t>(s);
  std::fill(block, factor.data() + blocks.offset[at + 1], 0.0);
  const auto begin = static_cast<std::size_t>(starts[static_cast<std::size_t>(blocks.first[at])]);
  const auto end = static_cast<std::size_t>(starts[static_cast<std::size_t>(blocks.first[at + 1])]);
  for (std::size_t k = begin; k < end; ++k) factor[blocks.place[k]] = values[k];
}

/// Adds the update of a child to its parent: to the block and to the parent's own update.
void SupernodalFactor::Impl::add_update(int child, const double* update, int parent, double* block,
                                        double* own) const {
  const int n = blocks.n_below(child), width = blocks.width(parent), height = blocks.height(parent);
  const std::ptrdiff_t own_ld = height - width;
  const auto begin =
      static_cast<std::ptrdiff_t>(blocks.row_starts[static_cast<std::size_t>(child)]);
  const int* to = blocks.in_parent.data() + begin;
  const int* run_end = blocks.run_end.data() + begin;
  for (int c = 0; c < n; ++c, update += n) {
    double* column = to[c] < width ? block + static_cast<std::ptrdiff_t>(to[c]) * height
                                   : own + (to[c] - width) * own_ld - width;
    for (int r = c; r < n; r = run_end[r]) {
      double* __restrict y = column + to[r] - r;
      const double* __restrict x = update;
      for (int k = r; k < run_end[r]; ++k) y[k] += x[k];
    }
  }
}

/// L of a block whose updates are all in, and what it takes from the rows below:
/// own <- keep * own - L_below L_belowᵀ (lower triangle).
/// @return the column of the block that fails, or -1.
int SupernodalFactor::Impl::factorize_block(int s, double* block, double keep, double* own) const {
  const int width = blocks.width(s), height = blocks.height(s), n_below = height - width;
  const Eigen::Index failed = cholesky(Dense(block, width, width, Eigen::OuterStride<>(height)));
  if (failed >= 0) return static_cast<int>(failed);
  if (n_below == 0) return -1;
  cblas_dtrsm(CblasColMajor, CblasRight, CblasLower, CblasTrans, CblasNonUnit, n_below, width, 1,
              block, height, block + width, height);
  cblas_dsyrk(CblasColMajor, CblasLower, CblasNoTrans, n_below, width, -1, block + width, height,
              keep, own, n_below);
  return -1;
}

/// The column of a factored block whose pivot is too small or not finite, or -1.
int SupernodalFactor::Impl::smallest_pivot(int s) const {
  const Supernode node = supernode(s);
  for (int k = 0; k < node.width(); ++k) {
    const double pivot = node.block[static_cast<std::ptrdiff_t>(k) * (node.height + 1)];
    const double diagonal = values[static_cast<std::size_t>(
        starts[static_cast<std::size_t>(node.first) + static_cast<std::size_t>(k)])];
    if (!(pivot * pivot > kSmallestPivot * diagonal) || !std::isfinite(pivot)) return k;
  }
  return -1;
}

int SupernodalFactor::factorize() {
  Impl& m = *impl_;
  const Supernodes& b = m.blocks;
  m.waiting.clear();
  std::size_t top = 0;  // of the stack
  for (const int s : b.order) {
    double* block = m.factor.data() + b.offset[static_cast<std::size_t>(s)];
    const auto n_below = static_cast<std::size_t>(b.n_below(s)), size = n_below * n_below;
    double* own = m.stack.data() + top;
    m.fill_block(s, block);
    const auto has_child = [&] {
      return !m.waiting.empty() && b.parent[static_cast<std::size_t>(m.waiting.back())] == s;
    };
    const double keep = has_child() ? 1 : 0;
    for (std::size_t c = 0; keep != 0 && c < n_below; ++c)
      std::fill(own + c * n_below + c, own + (c + 1) * n_below, 0.0);
    std::size_t bottom = top;
    while (has_child()) {
      const int child = m.waiting.back();
      const auto n = static_cast<std::size_t>(b.n_below(child));
      bottom -= n * n;
      m.add_update(child, m.stack.data() + bottom, s, block, own);
      m.waiting.pop_back();
    }
    int failed = m.factorize_block(s, block, keep, own);
    if (failed < 0) failed = m.smallest_pivot(s);
    if (failed >= 0) return b.first[static_cast<std::size_t>(s)] + failed;
    double* home = m.stack.data() + bottom;
    for (std::size_t c = 0; bottom != top && c < n_below; ++c)  // the lower triangle
      std::copy(own + c * n_below + c, own + (c + 1) * n_below, home + c * n_below + c);
    top = bottom + size;
    if (size > 0) m.waiting.push_back(s);
  }
  return -1;
}

void SupernodalFactor::forward(MatrixXd& x, std::span<const int> active, int tail) const {
  const Impl& m = *impl_;
  m.make_room(x.rows());
  each_share(x.rows(), [&](const LoadBlocks& mine) {
    for (int s = 0; s < m.n_supernodes(); ++s)
      for (int k = mine.first; k < mine.last; ++k) m.forward(s, x, active, tail, mine.block(k));
  });
}

void SupernodalFactor::backward(MatrixXd& x, std::span<const int> active, const Fill& fill) const {
  const Impl& m = *impl_;
  m.make_room(x.rows());
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
