#include "fem/solve/factorization/supernodal_factor.h"

#include <omp.h>

#include <algorithm>
#include <cstddef>
#include <utility>

#include "fem/solve/factorization/load_substitution.h"
#include "fem/solve/factorization/multifrontal.h"
#include "fem/solve/factorization/substitution.h"

namespace flexmorph::fem {

namespace {

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

constexpr int kUnit = 16;  // Loads that are processed together.

/// Calls use(loads) for the loads of every thread, in parallel. Results do not depend on the number
/// of threads, because no load depends on others (load_substitution.h).
template <class Use>
void each_share(Eigen::Index n_loads, const Use& use) {
  const int n = static_cast<int>(n_loads), units = (n + kUnit - 1) / kUnit;
  const int parts = std::clamp(units, 1, omp_get_max_threads());
#pragma omp parallel for schedule(static, 1) num_threads(parts) if (parts > 1)
  for (int k = 0; k < parts; ++k) {
    const int first = kUnit * (units * k / parts);
    use(LoadRange{first, std::min(kUnit * (units * (k + 1) / parts), n) - first});
  }
}

/// Calls a Fill in units that do not depend on the number of threads, because the last bits of a
/// product of BLAS depend on its size.
void fill_by_units(const SupernodalFactor::Fill& fill, int first, int last, LoadRange loads) {
  for (const int end = loads.first + loads.count; loads.first < end;) {
    const int next = std::min((loads.first / kUnit + 1) * kUnit, end);
    fill(first, last, loads.first, next - loads.first);
    loads.first = next;
  }
}

}  // namespace

struct SupernodalFactor::Impl {
  Multifrontal front;
  int highest = 0;               // largest number of rows of a block
  mutable MatrixXd single_load;  // work space of every thread for the rows of a block

  Impl(std::vector<int> starts, std::vector<int> rows) : front(std::move(starts), std::move(rows)) {
    for (int s = 0; s < n_supernodes(); ++s) highest = std::max(highest, front.blocks().height(s));
  }

  int n_supernodes() const { return front.blocks().n_blocks(); }

  /// Returns a block and the loads [load, load + count) of x.
  LoadBlock block(int s, MatrixXd& x, int load, int count) const {
    const Supernodes& b = front.blocks();
    return {front.block(s), b.width(s),  b.height(s), b.first[static_cast<std::size_t>(s)],
            b.below(s),     &x(load, 0), x.rows(),    count};
  }

  void forward(int s, MatrixXd& x, std::span<const int> active, int tail,
               const LoadRange& mine) const;
  void backward(int s, MatrixXd& x, std::span<const int> active, const Fill& fill,
                const LoadRange& mine) const;
  void reserve_memory() const {
    const int threads = omp_get_max_threads();
    if (single_load.cols() < threads) single_load.resize(highest, threads);
  }
  /// Copies the rows of a block for a single load to the work space of the thread.
  double* gather(const LoadBlock& b) const {
    double* y = single_load.col(omp_get_thread_num()).data();
    for (int r = 0; r < b.height; ++r) y[r] = *b.row(r);
    return y;
  }
};

SupernodalFactor::SupernodalFactor(std::vector<int> starts, std::vector<int> rows)
    : impl_(std::make_unique<Impl>(std::move(starts), std::move(rows))) {}

SupernodalFactor::~SupernodalFactor() = default;
SupernodalFactor::SupernodalFactor(SupernodalFactor&&) noexcept = default;

int SupernodalFactor::size() const { return impl_->front.size(); }
std::span<double> SupernodalFactor::values() { return impl_->front.values(); }
int SupernodalFactor::factorize() { return impl_->front.factorize(); }

double SupernodalFactor::condition() const { return impl_->front.condition(); }

void SupernodalFactor::forward(MatrixXd& x, std::span<const int> active, int tail) const {
  const Impl& m = *impl_;
  m.reserve_memory();
  each_share(x.rows(), [&](const LoadRange& mine) {
    for (int s = 0; s < m.n_supernodes(); ++s) m.forward(s, x, active, tail, mine);
  });
}

void SupernodalFactor::backward(MatrixXd& x, std::span<const int> active, const Fill& fill) const {
  const Impl& m = *impl_;
  m.reserve_memory();
  each_share(x.rows(), [&](const LoadRange& mine) {
    for (int s = m.n_supernodes() - 1; s >= 0; --s) m.backward(s, x, active, fill, mine);
  });
}

void SupernodalFactor::Impl::forward(int s, MatrixXd& x, std::span<const int> active, int tail,
                                     const LoadRange& mine) const {
  const auto at = static_cast<std::size_t>(s);
  const LoadRange reached = reaching(active, front.blocks().first[at], mine);
  if (reached.count == 0) return;
  const LoadRange zero = reaching(active, front.blocks().first[at + 1] + tail - 1, mine);
  const int count = reached.count - zero.count;
  if (count == 0) return;
  const int load = reached.first + (zero.first == reached.first ? zero.count : 0);
  const LoadBlock b = block(s, x, load, count);
  if (x.rows() > 1) return forward_loads(b);
  double* y = gather(b);
  forward_block(b.block, b.width, b.height, y);
  for (int r = 0; r < b.height; ++r) *b.row(r) = y[r];
}

void SupernodalFactor::Impl::backward(int s, MatrixXd& x, std::span<const int> active,
                                      const Fill& fill, const LoadRange& mine) const {
  const auto at = static_cast<std::size_t>(s);
  const int first = front.blocks().first[at], last = front.blocks().first[at + 1];
  const auto [load, count] = reaching(active, first, mine);
  const int end = mine.first + mine.count;
  x.block(mine.first, first, load - mine.first, last - first).setZero();
  x.block(load + count, first, end - load - count, last - first).setZero();
  if (count == 0) return;
  if (fill) fill_by_units(fill, first, last, {load, count});
  // Lᵀ is upper triangular: entries behind the active block that start as zero stay zero.
  for (int l = load; l < load + count; ++l) {
    const int kept = active[static_cast<std::size_t>(l)];
    for (int k = kept; k < last; ++k) x(l, k) = 0;
  }
  const LoadBlock b = block(s, x, load, count);
  if (x.rows() > 1) return backward_loads(b);
  double* y = gather(b);
  backward_block(b.block, b.width, b.height, y);
  for (int r = 0; r < b.width; ++r) *b.row(r) = y[r];
}

}  // namespace flexmorph::fem
