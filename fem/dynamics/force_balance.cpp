#include "fem/dynamics/force_balance.h"

#include <cmath>

#include "fem/dynamics/mesh_changes/moving_root.h"
#include "fem/solve/scaled_constraints.h"
#include "geometry/text.h"

namespace flexmorph::fem {

double separating_frequency(const Body& body) {
  const LineGrid& grid = grid_of(body);
  const double length = grid.line_m(grid.n_m()).value - grid.line_m(0).value;
  return std::sqrt(body.section->youngs_modulus / body.section->density) / length;
}

namespace {

/// The equations of balance_forces(). Unknowns are scaled to displacements, as in StepSolver.
class Balance {
 public:
  Balance(Workspace& model, State& x, double frequency, DirectSolver& solver, SparseMatrix& matrix)
      : model_(model),
        x_(x),
        stiffness_(frequency * frequency),
        scales_(model.scales()),
        kkt_(matrix),
        solver_(solver) {}

  void solve() {
    constexpr int kMaxIterations = 20;
    constexpr double kContraction = 0.1;  // limit above which a kept factorization is replaced
    // Corrections relative to the size of the model: converged, and round-off that no longer falls.
    constexpr double kTolerance = 1e-14, kRoundOff = 1e-11;
    const double size = undeformed_size(model_, scales_);
    double last = 0;
    bool factored = false;
    std::string history;
    for (int k = 1; k <= kMaxIterations; ++k) {
      evaluate();
      if (!factored) factorize(k == 1);
      const double now = correct() / size;
      history += formatted("%d: %.1e; ", k, now);
      if (!std::isfinite(now)) break;
      const bool contracts = k > 1 && now < kContraction * last;
      if (now <= kTolerance || (k > 1 && now <= kRoundOff && !contracts)) return;
      factored = k == 1 || contracts;
      last = now;
    }
    throw Error::numerical(
        formatted("The forces could not be balanced after the change of the mesh at t = %.6g s. "
                  "Corrections relative to the size of the model: ",
                  x_.t) +
        history + "use more elements or a larger body.flow.max_length.");
  }

 private:
  void evaluate() {
    model_.constraints(x_, constraints_);
    model_.force(x_, force_);
    Workspace::add_constraint_force(constraints_, x_.lambda, force_);
  }

  void factorize(bool analyze) {
    model_.kkt(x_, constraints_, {1, 0, stiffness_}, 1 / stiffness_, kkt_);
    const int n = model_.n_dofs();
    for (int column = 0; column < kkt_.cols(); ++column)
      for (SparseMatrix::InnerIterator entry(kkt_, column); entry; ++entry) {
        if (column < n) entry.valueRef() /= scales_[column];
        if (entry.row() < n) entry.valueRef() /= scales_[entry.row()];
      }
    if (analyze) solver_.analyze(kkt_);
    constexpr double kFactorError =
        0.02;  // Newton's method removes this error of the factorization
    solver_.factorize(kkt_, kFactorError);
  }

  /// Corrects the state. @returns the largest displacement of the correction [m].
  double correct() {
    const int n = model_.n_dofs(), m = model_.n_constraints();
    right_.resize(n + m);
    right_ << -force_.cwiseQuotient(scales_) / stiffness_, -constraints_.value;
    solver_.solve(kkt_, right_, solution_, false);
    const VectorXd dq = solution_.head(n).cwiseQuotient(scales_);
    x_.q += dq;
    x_.a += stiffness_ * dq;
    x_.lambda += stiffness_ * solution_.tail(m);
    return solution_.head(n).lpNorm<Eigen::Infinity>();
  }

  Workspace& model_;
  State& x_;
  double stiffness_;  // ω²
  VectorXd scales_, force_, right_, solution_;
  Constraints constraints_;
  SparseMatrix& kkt_;
  DirectSolver& solver_;
};

}  // namespace

VectorXd balance_forces(Workspace& model, State& x, double frequency, DirectSolver& solver,
                        SparseMatrix& matrix) {
  const VectorXd before = x.a;
  Balance(model, x, frequency, solver, matrix).solve();
  return x.a - before;
}

VectorXd balance_forces(Workspace& model, State& x, double frequency) {
  DirectSolver solver;
  SparseMatrix matrix;
  return balance_forces(model, x, frequency, solver, matrix);
}

}  // namespace flexmorph::fem
