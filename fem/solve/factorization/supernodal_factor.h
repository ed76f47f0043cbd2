#pragma once

#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "geometry/base.h"

namespace flexmorph::fem {

/// Cholesky factor K = L Lᵀ of a sparse matrix in its given (natural) order.
///
/// The unknowns are not reordered. Therefore the leading block of L is the factor of the leading
/// block of K, and one factor serves every system that keeps the first `active` unknowns and holds
/// the others. CHOLMOD analyses the pattern once. The factorization is multifrontal (Duff and Reid
/// 1983): every block of columns passes one dense update to its parent in the elimination tree,
/// three products of dense matrices per block, however many blocks follow. The substitutions run
/// over the same blocks, with right-hand sides stored as (n_loads x n), the values of all loads at
/// one unknown next to each other.
class SupernodalFactor {
 public:
  /// Analyses a pattern.
  /// @param starts, rows  lower triangle by compressed columns, rows ascending, diagonal first.
  SupernodalFactor(std::vector<int> starts, std::vector<int> rows);
  ~SupernodalFactor();
  SupernodalFactor(SupernodalFactor&&) noexcept;

  /// Returns the number of unknowns.
  int size() const;

  /// Returns the entries of K in the order of the pattern; write them, then call factorize().
  std::span<double> values();

  /// Factors K with its present values.
  /// @returns the column at which K is found not to be positive definite or not finite, or -1.
  int factorize();

  /// Returns condition_estimate() of K with its present values.
  double condition() const;

  /// Solves Ys L_sᵀ = Xs of the leading blocks s: the first `active[l]` entries of load l become
  /// L⁻¹ x, the others are meaningless. `active` (n_loads) is monotone, in either direction.
  void forward(MatrixXd& x, std::span<const int> active) const { forward(x, active, size()); }
  /// Solves for loads that are zero except for the last `tail` of their active entries; the entries
  /// before them are skipped.
  void forward(MatrixXd& x, std::span<const int> active, int tail) const;

  /// Function that writes the entries [first, last) of the right-hand sides [load, load + count)
  /// into x, just before backward() reads them.
  using Fill = std::function<void(int first, int last, int load, int count)>;

  /// Solves X L_s = Y of the leading blocks: x = L_s⁻ᵀ y in the first `active[l]` entries of load
  /// l, zero behind. Entries of y behind the active block are ignored.
  /// @param fill  when given, writes the entries of y; otherwise x contains them.
  void backward(MatrixXd& x, std::span<const int> active, const Fill& fill = {}) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace flexmorph::fem
