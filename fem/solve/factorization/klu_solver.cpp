#include "fem/solve/factorization/klu_solver.h"

#include <klu.h>

#include <limits>

namespace flexmorph::fem {
namespace {

/// Reciprocal pivot growth below which reused pivots lose three digits and new ones are selected.
constexpr double kPivotGrowth = 1e-3;

}  // namespace

struct KluSolver::Impl {
  mutable klu_common common;
  klu_symbolic* symbolic = nullptr;
  klu_numeric* numeric = nullptr;
  VectorXd pivoted;           // values of the matrix for which the pivots were selected
  bool keeps_pivots = false;  // true if the last factorization reused the pivots

  Impl() {
    klu_defaults(&common);
    common.scale = 0;  // callers scale the matrix, and the condition refers to their scaling
  }
  ~Impl() { release(); }
  void release() {
    if (numeric) klu_free_numeric(&numeric, &common);
    if (symbolic) klu_free_symbolic(&symbolic, &common);
  }
};

KluSolver::KluSolver() : impl_(std::make_unique<Impl>()) {}
KluSolver::~KluSolver() = default;
KluSolver::KluSolver(KluSolver&&) noexcept = default;
KluSolver& KluSolver::operator=(KluSolver&&) noexcept = default;

namespace {

// KLU reads patterns and values only, but its interface has no const.
int* starts(const SparseMatrix& a) { return const_cast<int*>(a.outerIndexPtr()); }
int* rows(const SparseMatrix& a) { return const_cast<int*>(a.innerIndexPtr()); }
double* values(const SparseMatrix& a) { return const_cast<double*>(a.valuePtr()); }

[[noreturn]] void fail(int status) {
  if (status == KLU_SINGULAR)
    throw Error::numerical(
        "KLU: the matrix is singular; a body may be insufficiently fixed, or a constraint may be "
        "redundant");
  throw Error::numerical("KLU failed with status " + std::to_string(status));
}

}  // namespace

void KluSolver::analyze(const SparseMatrix& a) {
  impl_->release();
  if (a.rows() == 0) return;
  impl_->symbolic = klu_analyze(static_cast<int>(a.rows()), starts(a), rows(a), &impl_->common);
  if (!impl_->symbolic) fail(impl_->common.status);
  if (impl_->common.structural_rank >= 0 && impl_->common.structural_rank < a.rows())
    fail(KLU_SINGULAR);
}

void KluSolver::factorize(const SparseMatrix& a) {
  Impl& s = *impl_;
  if (a.rows() == 0) return;
  if (!Eigen::Map<const VectorXd>(a.valuePtr(), a.nonZeros()).allFinite())
    throw Error::numerical("KLU: the matrix contains numbers that are not finite");
  if (s.numeric) {
    if (klu_refactor(starts(a), rows(a), values(a), s.symbolic, s.numeric, &s.common) &&
        s.common.status == KLU_OK &&
        klu_rgrowth(starts(a), rows(a), values(a), s.symbolic, s.numeric, &s.common) &&
        s.common.rgrowth > kPivotGrowth) {
      s.keeps_pivots = true;
      return;
    }
    klu_free_numeric(&s.numeric, &s.common);
  }
  s.pivoted = Eigen::Map<const VectorXd>(a.valuePtr(), a.nonZeros());
  s.keeps_pivots = false;
  s.numeric = klu_factor(starts(a), rows(a), values(a), s.symbolic, &s.common);
  if (s.numeric && s.common.status == KLU_OK) return;
  const int status = s.common.status;
  if (s.numeric) klu_free_numeric(&s.numeric, &s.common);
  fail(status);
}

void KluSolver::archive(Archive& memory, const SparseMatrix& a) {
  bool is_factored = impl_->numeric != nullptr, keeps_pivots = impl_->keeps_pivots;
  VectorXd pivoted = impl_->pivoted;
  memory(is_factored, keeps_pivots, pivoted);
  if (!memory.is_restoring()) return;
  analyze(a);
  if (!is_factored || pivoted.size() != a.nonZeros()) return;
  SparseMatrix first = a;
  first.coeffs() = pivoted.array();
  factorize(first);
  if (keeps_pivots) factorize(a);
}

void KluSolver::solve(VectorXd& b) const {
  if (b.size() == 0) return;
  const auto n = static_cast<int>(b.size());
  if (!klu_solve(impl_->symbolic, impl_->numeric, n, 1, b.data(), &impl_->common))
    fail(impl_->common.status);
}

double KluSolver::condition(const SparseMatrix& a) const {
  if (a.rows() == 0) return 1;
  if (!klu_condest(starts(a), values(a), impl_->symbolic, impl_->numeric, &impl_->common))
    return std::numeric_limits<double>::infinity();
  return impl_->common.condest;
}

}  // namespace flexmorph::fem
