#include "fem/solve/factorization/supernodes.h"

#include <cholmod.h>

#include <algorithm>
#include <iterator>
#include <string>
#include <utility>

#include "geometry/base.h"

namespace flexmorph::fem {

namespace {

// Neighbouring blocks are joined as long as the additional zeros cost less than wider products
// gain.
constexpr std::size_t kNarrow = 8, kMiddle = 16, kWide = 32;
constexpr double kZerosMiddle = 0.3, kZerosWide = 0.12, kZerosAny = 0.02;

/// The CHOLMOD objects of one analysis, released together.
struct Analysis {
  cholmod_common common;
  cholmod_factor* factor = nullptr;

  Analysis() { cholmod_start(&common); }
  ~Analysis() {
    cholmod_free_factor(&factor, &common);
    cholmod_finish(&common);
  }
  Analysis(const Analysis&) = delete;
  Analysis& operator=(const Analysis&) = delete;

  void run(std::span<const int> starts, std::span<const int> rows);
};

void Analysis::run(std::span<const int> starts, std::span<const int> rows) {
  const auto n = static_cast<int>(starts.size()) - 1;
  if (std::any_of(rows.begin(), rows.end(), [n](int row) { return row >= n; })) {
    std::vector<int> inner_starts = {0}, inner;  // without the border
    for (std::size_t c = 0; c + 1 < starts.size(); ++c) {
      std::copy_if(rows.begin() + starts[c], rows.begin() + starts[c + 1],
                   std::back_inserter(inner), [n](int row) { return row < n; });
      inner_starts.push_back(static_cast<int>(inner.size()));
    }
    run(inner_starts, inner);
    return;
  }
  cholmod_sparse pattern{};
  pattern.nrow = pattern.ncol = starts.size() - 1;
  pattern.nzmax = rows.size();
  // read only, although CHOLMOD's interface is not const
  pattern.p = const_cast<int*>(starts.data());
  pattern.i = const_cast<int*>(rows.data());
  pattern.stype = -1;
  pattern.itype = CHOLMOD_INT;
  pattern.xtype = CHOLMOD_PATTERN;
  pattern.dtype = CHOLMOD_DOUBLE;
  pattern.sorted = pattern.packed = 1;
  common.supernodal = CHOLMOD_SUPERNODAL;
  common.nmethods = 1;
  common.method[0].ordering = CHOLMOD_NATURAL;
  common.postorder = 0;
  common.print = 0;
  common.nrelax[0] = kNarrow;
  common.nrelax[1] = kMiddle;
  common.nrelax[2] = kWide;
  common.zrelax[0] = kZerosMiddle;
  common.zrelax[1] = kZerosWide;
  common.zrelax[2] = kZerosAny;
  factor = cholmod_analyze(&pattern, &common);
  if (factor == nullptr || factor->is_super == 0)
    throw Error::numerical("plate solver: CHOLMOD cannot analyse the matrix of " +
                           std::to_string(pattern.nrow) + " unknowns (status " +
                           std::to_string(common.status) + "; -2 means out of memory)");
}

/// Returns the index of `row` among the rows of a block.
int value_index_in(const Supernodes& b, int s, int row) {
  const int first = b.first[static_cast<std::size_t>(s)], width = b.width(s);
  if (row < first + width) return row - first;
  const int* begin = b.below(s);
  return width + static_cast<int>(std::lower_bound(begin, begin + b.n_below(s), row) - begin);
}

/// Returns the rows that each block has in the border: the rows of its own columns, and those of
/// its descendants in the elimination tree.
std::vector<std::vector<int>> border_rows(const Supernodes& b, std::span<const int> starts,
                                          std::span<const int> rows,
                                          std::span<const int> block_of_column) {
  const int n = static_cast<int>(starts.size()) - 1;
  std::vector<std::vector<int>> out(b.first.size() - 1);
  for (std::size_t s = 0; s + 1 < b.first.size(); ++s) {
    std::vector<int>& own = out[s];
    for (auto k = static_cast<std::size_t>(starts[static_cast<std::size_t>(b.first[s])]);
         k < static_cast<std::size_t>(starts[static_cast<std::size_t>(b.first[s + 1])]); ++k)
      if (rows[k] >= n) own.push_back(rows[k]);
    std::sort(own.begin(), own.end());
    own.erase(std::unique(own.begin(), own.end()), own.end());
    // The parent of a block always has a higher number.
    const auto below = static_cast<std::size_t>(b.row_starts[s]);
    if (own.empty() || below == static_cast<std::size_t>(b.row_starts[s + 1])) continue;
    const int parent = block_of_column[static_cast<std::size_t>(b.rows[below])];
    std::vector<int>& further = out[static_cast<std::size_t>(parent)];
    further.insert(further.end(), own.begin(), own.end());
  }
  return out;
}

/// Appends to the rows of the blocks the rows that they have in the border.
void append_border(Supernodes& b, const std::vector<std::vector<int>>& border) {
  std::vector<int> rows, row_starts = {0};
  b.offset = {0};
  for (std::size_t s = 0; s < border.size(); ++s) {
    rows.insert(rows.end(), b.rows.begin() + b.row_starts[s], b.rows.begin() + b.row_starts[s + 1]);
    rows.insert(rows.end(), border[s].begin(), border[s].end());
    const auto width = static_cast<std::size_t>(b.first[s + 1] - b.first[s]),
               n_below = rows.size() - static_cast<std::size_t>(row_starts.back());
    row_starts.push_back(static_cast<int>(rows.size()));
    b.offset.push_back(b.offset.back() + width * (width + n_below));
  }
  b.rows = std::move(rows);
  b.row_starts = std::move(row_starts);
}

void link_to_parents(Supernodes& b, std::span<const int> block_of_column) {
  b.in_parent.resize(b.rows.size());
  b.run_end.resize(b.rows.size());
  for (int s = 0; s < b.n_blocks(); ++s) {
    const int n_below = b.n_below(s);
    if (n_below == 0 || b.below(s)[0] >= static_cast<int>(block_of_column.size())) continue;
    const int parent = block_of_column[static_cast<std::size_t>(b.below(s)[0])];
    b.parent[static_cast<std::size_t>(s)] = parent;
    const auto begin = static_cast<std::size_t>(b.row_starts[static_cast<std::size_t>(s)]);
    for (std::size_t k = 0; k < static_cast<std::size_t>(n_below); ++k)
      b.in_parent[begin + k] = value_index_in(b, parent, b.rows[begin + k]);
    for (std::size_t k = static_cast<std::size_t>(n_below), end = k; k-- > 0;) {
      b.run_end[begin + k] = static_cast<int>(end);
      if (k > 0 && b.in_parent[begin + k - 1] + 1 != b.in_parent[begin + k]) end = k;
    }
  }
}

/// Orders the blocks depth first, so that the updates a block needs are on top of a stack.
void order_families(Supernodes& b) {
  const auto n = static_cast<std::size_t>(b.n_blocks());
  std::vector<int> child(n, -1), sibling(n, -1), path;
  for (std::size_t s = n; s-- > 0;)
    if (b.parent[s] >= 0) {
      sibling[s] = child[static_cast<std::size_t>(b.parent[s])];
      child[static_cast<std::size_t>(b.parent[s])] = static_cast<int>(s);
    }
  for (std::size_t root = 0; root < n; ++root) {
    if (b.parent[root] >= 0) continue;
    path.push_back(static_cast<int>(root));
    while (!path.empty()) {
      int& next = child[static_cast<std::size_t>(path.back())];
      if (next >= 0) {
        path.push_back(next);
        next = sibling[static_cast<std::size_t>(next)];
      } else {
        b.order.push_back(path.back());
        path.pop_back();
      }
    }
  }
}

/// Computes the largest size of the stack of updates; each has the square of its number of rows
/// below.
void measure_stack(Supernodes& b) {
  std::vector<std::size_t> of_children(static_cast<std::size_t>(b.n_blocks()), 0);
  std::size_t stack = 0;
  for (const int s : b.order) {
    const auto n_below = static_cast<std::size_t>(b.n_below(s)), update = n_below * n_below;
    b.deepest_stack = std::max(b.deepest_stack, stack + update);
    stack -= of_children[static_cast<std::size_t>(s)];
    const int parent = b.parent[static_cast<std::size_t>(s)];
    if (parent < 0) continue;  // an update of the border is not stored
    stack += update;
    of_children[static_cast<std::size_t>(parent)] += update;
  }
}

}  // namespace

Supernodes find_supernodes(std::span<const int> starts, std::span<const int> rows) {
  Analysis analysis;
  analysis.run(starts, rows);
  const std::size_t n_blocks = analysis.factor->nsuper;
  const int* super = static_cast<const int*>(analysis.factor->super);
  const int* pi = static_cast<const int*>(analysis.factor->pi);
  const int* s_rows = static_cast<const int*>(analysis.factor->s);

  Supernodes b;
  b.first.assign(super, super + n_blocks + 1);
  b.row_starts = {0};
  std::vector<int> block_of_column(starts.size() - 1);
  for (std::size_t s = 0; s < n_blocks; ++s) {
    const int width = super[s + 1] - super[s];
    b.rows.insert(b.rows.end(), s_rows + pi[s] + width, s_rows + pi[s + 1]);
    b.row_starts.push_back(static_cast<int>(b.rows.size()));
    std::fill(block_of_column.begin() + super[s], block_of_column.begin() + super[s + 1],
              static_cast<int>(s));
  }
  b.parent.assign(n_blocks, -1);
  append_border(b, border_rows(b, starts, rows, block_of_column));
  link_to_parents(b, block_of_column);
  order_families(b);
  measure_stack(b);

  b.value_index.resize(rows.size());
  for (std::size_t c = 0; c + 1 < starts.size(); ++c) {
    const int s = block_of_column[c];
    const auto block = static_cast<std::size_t>(s);
    const std::size_t column = c - static_cast<std::size_t>(b.first[block]);
    for (auto k = static_cast<std::size_t>(starts[c]); k < static_cast<std::size_t>(starts[c + 1]);
         ++k)
      b.value_index[k] = b.offset[block] + column * static_cast<std::size_t>(b.height(s)) +
                         static_cast<std::size_t>(value_index_in(b, s, rows[k]));
  }
  return b;
}

}  // namespace flexmorph::fem
