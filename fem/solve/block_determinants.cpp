#include "fem/solve/block_determinants.h"

#include <klu.h>

#include <Eigen/LU>
#include <Eigen/SparseLU>
#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

namespace flexmorph::fem {
namespace {

constexpr int kMaxDense = 100;  // largest block that is factored as a dense matrix

/// Returns the determinant of a triangular matrix with this diagonal, times a sign.
template <class Diagonal>
Determinant product(const Diagonal& diagonal, double sign) {
  Determinant out{sign > 0 ? 1 : -1, 0};
  for (Eigen::Index i = 0; i < diagonal.size(); ++i) {
    const double each = diagonal[i];
    if (!(std::abs(each) > 0)) return {0, -std::numeric_limits<double>::infinity()};
    if (each < 0) out.sign = -out.sign;
    out.logarithm += std::log(std::abs(each));
  }
  return out;
}

Determinant determinant(const MatrixXd& a) {
  const Eigen::PartialPivLU<MatrixXd> lu(a);
  return product(lu.matrixLU().diagonal(), static_cast<double>(lu.permutationP().determinant()));
}

Determinant determinant(const SparseMatrix& a) {
  Eigen::SparseLU<SparseMatrix> lu(a);
  if (lu.info() != Eigen::Success) return {0, -std::numeric_limits<double>::infinity()};
  return {lu.signDeterminant() > 0 ? 1 : -1, lu.logAbsDeterminant()};
}

}  // namespace

int block_near_other_branch(const std::vector<Determinant>& start,
                            const std::vector<Determinant>& middle,
                            const std::vector<Determinant>& end) {
  const double near = std::log(0.3);
  for (size_t b = 0; b < start.size(); ++b) {
    if (start[b].sign == 0) continue;
    if (start[b].sign != end[b].sign || start[b].sign != middle[b].sign ||
        middle[b].logarithm < near + std::min(start[b].logarithm, end[b].logarithm))
      return static_cast<int>(b);
  }
  return -1;
}

void BlockDeterminants::analyze(const SparseMatrix& a) {
  const auto n = static_cast<size_t>(a.rows());
  klu_common common;
  klu_defaults(&common);
  // KLU reads the pattern only, but its interface has no const.
  klu_symbolic* found = klu_analyze(static_cast<int>(n), const_cast<int*>(a.outerIndexPtr()),
                                    const_cast<int*>(a.innerIndexPtr()), &common);
  if (!found) throw Error::numerical("KLU failed with status " + std::to_string(common.status));
  rows_.assign(found->P, found->P + n);
  columns_.assign(found->Q, found->Q + n);
  first_.assign(found->R, found->R + found->nblocks + 1);
  klu_free_symbolic(&found, &common);
  index_of_row_.assign(n, 0);
  for (size_t k = 0; k < n; ++k) index_of_row_[static_cast<size_t>(rows_[k])] = static_cast<int>(k);
}

std::vector<int> BlockDeterminants::rows_of(int block) const {
  const auto k = static_cast<size_t>(block);
  return {rows_.begin() + first_[k], rows_.begin() + first_[k + 1]};
}

std::vector<Determinant> BlockDeterminants::of(const SparseMatrix& a) const {
  std::vector<Determinant> out;
  std::vector<Eigen::Triplet<double>> entries;
  for (size_t b = 0; b + 1 < first_.size(); ++b) {
    const int begin = first_[b], end = first_[b + 1], n = end - begin;
    entries.clear();
    for (int k = begin; k < end; ++k)
      for (SparseMatrix::InnerIterator it(a, columns_[static_cast<size_t>(k)]); it; ++it)
        if (const int row = index_of_row_[static_cast<size_t>(it.row())]; row >= begin && row < end)
          entries.emplace_back(row - begin, k - begin, it.value());
    if (n <= kMaxDense) {
      MatrixXd block = MatrixXd::Zero(n, n);
      for (const auto& entry : entries) block(entry.row(), entry.col()) += entry.value();
      out.push_back(determinant(block));
    } else {
      SparseMatrix block(n, n);
      block.setFromTriplets(entries.begin(), entries.end());
      out.push_back(determinant(block));
    }
  }
  return out;
}

}  // namespace flexmorph::fem
