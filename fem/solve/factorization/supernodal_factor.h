#pragma once

#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "geometry/base.h"

namespace flexmorph::fem {

/// Cholesky factor K = L Lᵀ of a sparse matrix in its given (natural) order.
///
/// No reordering: the leading block of L is the factor of the leading block of K, so that one
/// factor serves every system that keeps the first `active` unknowns and holds the others.
/// CHOLMOD analyses the pattern once. The factor is multifrontal (Duff and Reid 1983): every block
/// of columns hands one dense update to its parent in the tree of eliminations, three products of
/// dense matrices per block however many blocks follow. The substitutions run over the same blocks,
/// with right-hand sides stored (n_loads x n), the values of all loads at one unknown next to each
/// other.
class SupernodalFactor {
 public:
  /// @param starts, rows  lower triangle by compressed columns, rows ascending, diagonal first.
  SupernodalFactor(std::vector<int> starts, std::vector<int> rows);
  ~SupernodalFactor();
  SupernodalFactor(SupernodalFactor&&) noexcept;

  int size() const;

  /// Entries of K in the order of the pattern; write them, then call factorize().
  std::span<double> values();

  /// @returns the column at which K is found not to be positive definite or not finite, or -1.
  int factorize();

  /// condition_estimate() of K as its values are now.
  double condition() const;

  /// Ys L_sᵀ = Xs of the leading blocks s: the first `active[l]` entries of load l become L⁻¹ x,
  /// the others are not meaningful. `active` (n_loads) is monotone, in either direction.
  void forward(MatrixXd& x, std::span<const int> active) const { forward(x, active, size()); }
  /// The same for loads that are zero but for the last `tail` of their active entries: what comes
  /// before is passed over.
  void forward(MatrixXd& x, std::span<const int> active, int tail) const;

  /// Writes entries [first, last) of loads [load, load + count) of the right-hand side, just
  /// before backward() needs them.
  using Fill = std::function<void(int first, int last, int load, int count)>;

  /// X L_s = Y of the leading blocks: x = L_s⁻ᵀ y in the first `active[l]` entries of load l,
  /// zero behind. What y holds behind its active block is ignored.
  /// @param fill  when given, brings the entries of y; else x holds them.
  void backward(MatrixXd& x, std::span<const int> active, const Fill& fill = {}) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace flexmorph::fem
