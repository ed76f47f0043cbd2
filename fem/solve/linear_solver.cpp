#include "fem/solve/linear_solver.h"

#include <dlfcn.h>
#include <umfpack.h>

#include <string>
#include <utility>

#include "fem/solve/factorization/bordered_cholesky.h"

namespace flexmorph::fem {
namespace {

/// Size below which factoring the whole matrix costs no more than updating the border.
constexpr size_t kMinRenewedUnknowns = 1500;

}  // namespace

struct DirectSolver::Impl {
  void* symbolic = nullptr;
  void* numeric = nullptr;
  double control[UMFPACK_CONTROL];
  VectorXd analysed;  // values of the matrix that UMFPACK analysed; empty: none
  double miss = 0;    // allowed error of the last factorization
  BorderedCholesky bordered;
  bool may_border = false, is_bordered = false;
  std::vector<TurnedVectors> turns;  // rotations since the last factorization
  VectorXd remainder, correction;

  Impl() { umfpack_di_defaults(control); }
  ~Impl() {
    release_numeric();
    if (symbolic) umfpack_di_free_symbolic(&symbolic);
  }
  void release_numeric() {
    if (numeric) umfpack_di_free_numeric(&numeric);
  }
  void analyze(const SparseMatrix& a, const double* values);
  void solve(const SparseMatrix& a, const VectorXd& b, VectorXd& x, bool refine, bool transposed);
};

DirectSolver::DirectSolver() : impl_(std::make_unique<Impl>()) {}
DirectSolver::~DirectSolver() = default;
DirectSolver::DirectSolver(DirectSolver&&) noexcept = default;
DirectSolver& DirectSolver::operator=(DirectSolver&&) noexcept = default;

namespace {

void check(int status, const char* what) {
  if (status == UMFPACK_OK) return;
  if (status == UMFPACK_WARNING_singular_matrix)
    throw Error::numerical(
        std::string("linear solver: the matrix is singular (") + what +
        "); a body may be insufficiently fixed, or a constraint may be redundant");
  throw Error::numerical(std::string("linear solver: UMFPACK failed in ") + what + " with status " +
                         std::to_string(status));
}

}  // namespace

void DirectSolver::Impl::analyze(const SparseMatrix& a, const double* values) {
  analysed = Eigen::Map<const VectorXd>(values, a.nonZeros());
  check(
      umfpack_di_symbolic(static_cast<int>(a.rows()), static_cast<int>(a.cols()), a.outerIndexPtr(),
                          a.innerIndexPtr(), analysed.data(), &symbolic, control, nullptr),
      "analysis");
}

void DirectSolver::analyze(const SparseMatrix& a) {
  impl_->release_numeric();
  // UMFPACK analyses the pattern only when it is used.
  if (impl_->symbolic) umfpack_di_free_symbolic(&impl_->symbolic);
  impl_->analysed.resize(0);
  impl_->is_bordered = false;
  impl_->may_border = impl_->bordered.analyze(a);
}

void DirectSolver::factorize(const SparseMatrix& a, double miss) {
  if (!Eigen::Map<const VectorXd>(a.valuePtr(), a.nonZeros()).allFinite())
    throw Error::numerical("linear solver: the matrix contains numbers that are not finite");
  impl_->miss = miss;
  impl_->turns.clear();
  impl_->release_numeric();
  impl_->is_bordered = impl_->may_border && impl_->bordered.factorize(a, miss);
  if (impl_->is_bordered) return;
  if (!impl_->symbolic) impl_->analyze(a, a.valuePtr());
  check(umfpack_di_numeric(a.outerIndexPtr(), a.innerIndexPtr(), a.valuePtr(), impl_->symbolic,
                           &impl_->numeric, impl_->control, nullptr),
        "factorization");
}

void DirectSolver::solve(const SparseMatrix& a, const VectorXd& b, VectorXd& x, bool refine) const {
  impl_->solve(a, b, x, refine, false);
}

void DirectSolver::solve_transposed(const SparseMatrix& a, const VectorXd& b, VectorXd& x,
                                    bool refine) const {
  impl_->solve(a, b, x, refine, true);
}

void DirectSolver::Impl::solve(const SparseMatrix& a, const VectorXd& b, VectorXd& x, bool refine,
                               bool transposed) {
  if (is_bordered) {
    bordered.solve(b, x, transposed);
    if (!refine || !turns.empty()) return;
    remainder = b;
    if (transposed)
      remainder.noalias() -= a.transpose() * x;
    else
      remainder.noalias() -= a * x;
    bordered.solve(remainder, correction, transposed);
    x += correction;
    return;
  }
  x.resize(b.size());
  control[UMFPACK_IRSTEP] = refine ? 1 : 0;
  check(umfpack_di_solve(transposed ? UMFPACK_At : UMFPACK_A, a.outerIndexPtr(), a.innerIndexPtr(),
                         a.valuePtr(), x.data(), b.data(), numeric, control, nullptr),
        "solution");
}

const std::vector<char>& DirectSolver::border() const {
  static const std::vector<char> kEmptyBorder;
  const std::vector<char>& border = impl_->bordered.border();
  return impl_->is_bordered && border.size() >= kMinRenewedUnknowns ? border : kEmptyBorder;
}

bool DirectSolver::renew_border(const SparseMatrix& a, std::vector<TurnedVectors> turns) {
  impl_->is_bordered = impl_->is_bordered && impl_->bordered.renew_border(a, turns);
  impl_->turns = std::move(turns);
  return impl_->is_bordered;
}

SparseMatrix DirectSolver::as_solved(const SparseMatrix& a) const {
  if (impl_->turns.empty()) return a;
  std::vector<Eigen::Triplet<double>> q;
  std::vector<char> turned(static_cast<size_t>(a.rows()), 0);
  for (const TurnedVectors& t : impl_->turns)
    for (int k = t.first; k < t.last; k += 2) {
      q.emplace_back(k, k, t.cosine);
      q.emplace_back(k, k + 1, -t.sine);
      q.emplace_back(k + 1, k, t.sine);
      q.emplace_back(k + 1, k + 1, t.cosine);
      turned[static_cast<size_t>(k)] = turned[static_cast<size_t>(k + 1)] = 1;
    }
  for (int k = 0; k < a.rows(); ++k)
    if (!turned[static_cast<size_t>(k)]) q.emplace_back(k, k, 1.0);
  SparseMatrix turn(a.rows(), a.cols()), inner = a, among = a;
  turn.setFromTriplets(q.begin(), q.end());
  const std::vector<char>& at = border();
  const auto in_border = [&](Eigen::Index row, Eigen::Index column, double) {
    return at[static_cast<size_t>(row)] && at[static_cast<size_t>(column)];
  };
  among.prune(in_border);
  inner.prune([&](auto row, auto column, double x) { return !in_border(row, column, x); });
  return SparseMatrix(turn * inner) * SparseMatrix(turn.transpose()) + among;
}

void DirectSolver::archive(Archive& memory, const SparseMatrix& a) {
  bool is_factored = impl_->is_bordered || impl_->numeric != nullptr;
  VectorXd values = impl_->analysed;
  double miss = impl_->miss;
  std::vector<TurnedVectors> turns = impl_->turns;
  memory(is_factored, values, miss, turns);
  if (memory.is_restoring()) analyze(a);
  impl_->bordered.archive(memory);
  if (!memory.is_restoring()) return;
  if (values.size() > 0 && values.size() == a.nonZeros()) impl_->analyze(a, values.data());
  if (is_factored) factorize(a, miss);
  if (!turns.empty()) renew_border(a, std::move(turns));
}

bool DirectSolver::is_cholesky() const { return impl_->is_bordered; }

std::string blas_kernel() {
  auto* name = reinterpret_cast<char* (*)()>(dlsym(RTLD_DEFAULT, "openblas_get_corename"));
  return name ? name() : "unknown";
}

}  // namespace flexmorph::fem
