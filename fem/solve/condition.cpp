#include "fem/solve/condition.h"

#include <cmath>
#include <limits>

#include "fem/solve/factorization/klu_solver.h"

namespace flexmorph::fem {
namespace {

/// Returns the diagonal of D. Rows without an entry on the diagonal are scaled to length 1 after
/// the columns have been scaled.
VectorXd unit_scales(const SparseMatrix& a) {
  VectorXd out = a.diagonal().cwiseAbs(), squares = VectorXd::Zero(a.rows());
  for (Eigen::Index i = 0; i < out.size(); ++i) out[i] = out[i] > 0 ? 1 / std::sqrt(out[i]) : 0;
  for (int column = 0; column < a.outerSize(); ++column)
    for (SparseMatrix::InnerIterator it(a, column); it; ++it)
      squares[it.row()] += std::pow(it.value() * out[column], 2);
  for (Eigen::Index i = 0; i < out.size(); ++i)
    if (out[i] == 0) out[i] = squares[i] > 0 ? 1 / std::sqrt(squares[i]) : 1;
  return out;
}

}  // namespace

double condition_estimate(SparseMatrix a) {
  constexpr double kSingular = std::numeric_limits<double>::infinity();
  if (a.rows() == 0) return 1;
  a.makeCompressed();
  const VectorXd scales = unit_scales(a);
  for (int column = 0; column < a.outerSize(); ++column)
    for (SparseMatrix::InnerIterator it(a, column); it; ++it)
      it.valueRef() *= scales[it.row()] * scales[column];
  try {
    KluSolver solver;
    solver.analyze(a);
    solver.factorize(a);
    const double out = solver.condition(a);
    return out >= 1 ? out : kSingular;  // NaN counts as singular
  } catch (const Error&) {
    return kSingular;
  }
}

}  // namespace flexmorph::fem
