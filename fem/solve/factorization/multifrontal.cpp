#include "fem/solve/factorization/multifrontal.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstddef>
#include <utility>

#include "fem/solve/condition.h"
#include "fem/solve/factorization/dense_blocks.h"

namespace flexmorph::fem {

namespace {

// Smallest ratio of a pivot to its diagonal entry. A smaller one is cancellation of all digits, as
// for a plate that is disconnected from its root. (A plate that is connected by void of factor 1e-9
// has about 1e-9.)
constexpr double kSmallestPivot = 1e-12;

}  // namespace

Multifrontal::Multifrontal(std::vector<int> starts, std::vector<int> rows) {
  blocks_ = find_supernodes(starts, rows);
  starts_ = std::move(starts);
  values_.assign(rows.size(), 0.0);
  factor_.assign(blocks_.offset.back(), 0.0);
  stack_.assign(blocks_.deepest_stack, 0.0);
}

/// Writes the entries of K in the columns of a block.
void Multifrontal::fill_block(int s, double* block) {
  const auto at = static_cast<std::size_t>(s);
  std::fill(block, factor_.data() + blocks_.offset[at + 1], 0.0);
  const auto begin = static_cast<std::size_t>(starts_[static_cast<std::size_t>(blocks_.first[at])]);
  const auto end =
      static_cast<std::size_t>(starts_[static_cast<std::size_t>(blocks_.first[at + 1])]);
  for (std::size_t k = begin; k < end; ++k) factor_[blocks_.value_index[k]] = values_[k];
}

/// Adds the update of a child to its parent: to the block and to the parent's own update.
void Multifrontal::add_update(int child, const double* update, int parent, double* block,
                              double* own) const {
  const int n = blocks_.n_below(child), width = blocks_.width(parent),
            height = blocks_.height(parent);
  const std::ptrdiff_t own_ld = height - width;
  const auto begin =
      static_cast<std::ptrdiff_t>(blocks_.row_starts[static_cast<std::size_t>(child)]);
  const int* to = blocks_.in_parent.data() + begin;
  const int* run_end = blocks_.run_end.data() + begin;
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

/// Computes L of a block to which all updates have been added, and its update of the rows below:
/// own <- keep * own - L_below L_belowᵀ (lower triangle).
/// @returns the column of the block that fails, or -1.
int Multifrontal::factorize_block(int s, double* block, bool keep, double* own) const {
  const int width = blocks_.width(s), height = blocks_.height(s), n_below = height - width;
  const int failed = dense::factor_block(block, width, height);
  if (failed < 0 && n_below > 0) dense::update(block + width, height, n_below, width, keep, own);
  return failed;
}

/// Returns the column of a factored block whose pivot is too small or not finite, or -1.
int Multifrontal::smallest_pivot(int s) const {
  const auto first = static_cast<std::size_t>(blocks_.first[static_cast<std::size_t>(s)]);
  for (int k = 0; k < blocks_.width(s); ++k) {
    const double pivot = block(s)[static_cast<std::ptrdiff_t>(k) * (blocks_.height(s) + 1)];
    const double diagonal =
        values_[static_cast<std::size_t>(starts_[first + static_cast<std::size_t>(k)])];
    if (!(pivot * pivot > kSmallestPivot * diagonal) || !std::isfinite(pivot)) return k;
  }
  return -1;
}

/// Adds the update of a root of the elimination tree to the border.
void Multifrontal::add_to_border(int s, const double* update, MatrixXd& border) const {
  const int n = blocks_.n_below(s);
  const int* below = blocks_.below(s);
  for (int c = 0; c < n; ++c)
    for (int r = c; r < n; ++r)
      border(below[r] - size(), below[c] - size()) +=
          update[static_cast<std::ptrdiff_t>(c) * n + r];
}

int Multifrontal::factorize(MatrixXd* border) {
  const Supernodes& b = blocks_;
  waiting_.clear();
  if (border) border->setZero();
  std::size_t top = 0;  // of the stack of updates
  for (const int s : b.order) {
    double* block = factor_.data() + b.offset[static_cast<std::size_t>(s)];
    const auto n_below = static_cast<std::size_t>(b.n_below(s)), size = n_below * n_below;
    double* own = stack_.data() + top;
    fill_block(s, block);
    const auto has_child = [&] {
      return !waiting_.empty() && b.parent[static_cast<std::size_t>(waiting_.back())] == s;
    };
    const bool keep = has_child();
    for (std::size_t c = 0; keep && c < n_below; ++c)
      std::fill(own + c * n_below + c, own + (c + 1) * n_below, 0.0);
    std::size_t bottom = top;
    while (has_child()) {
      const int child = waiting_.back();
      const auto n = static_cast<std::size_t>(b.n_below(child));
      bottom -= n * n;
      add_update(child, stack_.data() + bottom, s, block, own);
      waiting_.pop_back();
    }
    int failed = factorize_block(s, block, keep, own);
    if (failed < 0) failed = smallest_pivot(s);
    if (failed >= 0) return b.first[static_cast<std::size_t>(s)] + failed;
    if (b.parent[static_cast<std::size_t>(s)] < 0) {
      assert(size == 0 || border != nullptr);
      if (size > 0) add_to_border(s, own, *border);
      top = bottom;
      continue;
    }
    double* moved = stack_.data() + bottom;
    for (std::size_t c = 0; bottom != top && c < n_below; ++c)  // the lower triangle
      std::copy(own + c * n_below + c, own + (c + 1) * n_below, moved + c * n_below + c);
    top = bottom + size;
    waiting_.push_back(s);
  }
  return -1;
}

double Multifrontal::condition() const {
  std::vector<Eigen::Triplet<double>> entries;
  entries.reserve(2 * values_.size());
  for (int s = 0; s < blocks_.n_blocks(); ++s) {
    const auto at = static_cast<std::size_t>(s);
    const int first = blocks_.first[at], width = blocks_.width(s);
    for (int c = first; c < first + width; ++c)
      for (auto k = static_cast<std::size_t>(starts_[static_cast<std::size_t>(c)]);
           k < static_cast<std::size_t>(starts_[static_cast<std::size_t>(c) + 1]); ++k) {
        const auto row = static_cast<int>((blocks_.value_index[k] - blocks_.offset[at]) %
                                          static_cast<std::size_t>(blocks_.height(s)));
        const int i = row < width ? first + row : blocks_.below(s)[row - width];
        if (i >= size()) continue;
        entries.emplace_back(i, c, values_[k]);
        if (i != c) entries.emplace_back(c, i, values_[k]);
      }
  }
  SparseMatrix full(size(), size());
  full.setFromTriplets(entries.begin(), entries.end());
  return condition_estimate(full);
}

}  // namespace flexmorph::fem
