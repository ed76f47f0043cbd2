#include "tests/support/ida.h"

#include <ida/ida.h>
#include <nvector/nvector_serial.h>
#include <sunlinsol/sunlinsol_klu.h>
#include <sunmatrix/sunmatrix_sparse.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <type_traits>

namespace flexmorph::testing {
namespace {

using fem::Constraints;
using fem::SparseMatrix;
using fem::State;
using fem::Workspace;
using Triplets = std::vector<Eigen::Triplet<double>>;

template <class T, void (*destroy)(T)>
struct Free {
  using pointer = T;
  void operator()(T it) const { destroy(it); }
};
void free_context(SUNContext c) { SUNContext_Free(&c); }
void free_solver(SUNLinearSolver s) { SUNLinSolFree(s); }
void free_ida(void* m) { IDAFree(&m); }
using Context = std::unique_ptr<std::remove_pointer_t<SUNContext>, Free<SUNContext, free_context>>;
using Vector = std::unique_ptr<_generic_N_Vector, Free<N_Vector, N_VDestroy>>;
using Matrix = std::unique_ptr<_generic_SUNMatrix, Free<SUNMatrix, SUNMatDestroy>>;
using Solver = std::unique_ptr<_generic_SUNLinearSolver, Free<SUNLinearSolver, free_solver>>;
using Ida = std::unique_ptr<void, Free<void*, free_ida>>;

void require(int flag, const char* what) {
  if (flag >= 0) return;
  throw Error::numerical(std::string("IDA: ") + what + " failed with code " + std::to_string(flag));
}

/// The four equations of the stabilized index-2 form and their derivative; y = (q, v, λ, μ).
class Equations {
 public:
  explicit Equations(Workspace& model)
      : model_(model), n_(model.n_dofs()), m_(model.n_constraints()) {}

  Eigen::Index size() const { return 2 * (n_ + m_); }

  void residual(double t, const double* y, const double* rate, double* out) {
    const Eigen::Map<const VectorXd> mu(y + 2 * n_ + m_, m_), q_rate(rate, n_);
    Eigen::Map<VectorXd> kinematic(out, n_), dynamic(out + n_, n_), at_rate(out + 2 * n_, m_),
        at_value(out + 2 * n_ + m_, m_);
    put(t, y, rate);
    model_.force(x_, force_);
    model_.add_constraint_force(c_, x_.lambda, force_);
    dynamic = force_;
    force_.setZero();
    model_.add_constraint_force(c_, mu, force_);
    kinematic = q_rate - x_.v + force_;
    at_value = c_.value;
    at_rate = rate_of(x_);
  }

  /// Returns J = ∂F/∂y + c ∂F/∂ẏ.
  SparseMatrix jacobian(double t, double c, const double* y, const double* rate) {
    put(t, y, rate);
    Triplets out;
    for (int i = 0; i < n_; ++i) {
      out.emplace_back(i, i, c);
      out.emplace_back(i, n_ + i, -1);
    }
    model_.kkt(x_, c_, {1, 0, 0}, 1, kkt_);
    add_block(0, out);
    model_.kkt(x_, c_, {0, 1, c}, 1, kkt_);
    add_block(n_, out);
    for (const auto& e : c_.jacobian) {
      out.emplace_back(e.col(), 2 * n_ + m_ + e.row(), e.value());
      out.emplace_back(n_ + e.col(), 2 * n_ + e.row(), e.value());
      out.emplace_back(2 * n_ + e.row(), n_ + e.col(), e.value());
      out.emplace_back(2 * n_ + m_ + e.row(), e.col(), e.value());
    }
    add_rate_stiffness(out);
    SparseMatrix all(size(), size());
    all.setFromTriplets(out.begin(), out.end());
    all.makeCompressed();
    return all;
  }

  State state(double t, const double* y, const double* rate) {
    put(t, y, rate);
    return x_;
  }

 private:
  void put(double t, const double* y, const double* rate) {
    x_.t = t;
    x_.q = Eigen::Map<const VectorXd>(y, n_);
    x_.v = Eigen::Map<const VectorXd>(y + n_, n_);
    x_.a = Eigen::Map<const VectorXd>(rate + n_, n_);
    x_.lambda = Eigen::Map<const VectorXd>(y + 2 * n_, m_);
    if (!(t == prepared_)) model_.prepare(t);
    prepared_ = t;
    model_.constraints(x_, c_);
  }

  /// Returns Φ_q q̇ + Φ_t with the constraints in c_.
  VectorXd rate_of(const State& x) const {
    VectorXd out = c_.rate;
    for (const auto& e : c_.jacobian) out[e.row()] += e.value() * x.v[e.col()];
    return out;
  }

  /// Adds the entries of kkt_ in the rows and columns of the unknowns as derivatives of the dynamic
  /// equations by q (column 0) or v (column n_).
  void add_block(int column, Triplets& out) const {
    for (int j = 0; j < n_; ++j)
      for (SparseMatrix::InnerIterator it(kkt_, j); it; ++it)
        if (it.row() < n_)
          out.emplace_back(n_ + static_cast<int>(it.row()), column + j, it.value());
  }

  /// Adds (Φ_q q̇ + Φ_t)_q by forward differences, for the unknowns that occur in constraints.
  /// Where Φ is linear the differences vanish, but the entries are kept so that the sparsity
  /// pattern does not change.
  void add_rate_stiffness(Triplets& out) {
    std::vector<std::vector<int>> rows(static_cast<size_t>(n_));
    for (const auto& e : c_.jacobian) rows[static_cast<size_t>(e.col())].push_back(e.row());
    const VectorXd here = rate_of(x_);
    for (int j = 0; j < n_; ++j) {
      if (rows[static_cast<size_t>(j)].empty()) continue;
      const double kept = x_.q[j], d = 1e-7 * (1 + std::abs(kept));
      x_.q[j] += d;
      model_.constraints(x_, c_);
      const VectorXd change = (rate_of(x_) - here) / d;
      for (const int i : rows[static_cast<size_t>(j)]) out.emplace_back(2 * n_ + i, j, change[i]);
      x_.q[j] = kept;
    }
    model_.constraints(x_, c_);
  }

  Workspace& model_;
  int n_, m_;
  State x_;
  Constraints c_;
  VectorXd force_;
  SparseMatrix kkt_;
  double prepared_ = std::nan("");
};

int residual(sunrealtype t, N_Vector y, N_Vector rate, N_Vector out, void* equations) {
  auto& e = *static_cast<Equations*>(equations);
  try {
    e.residual(t, N_VGetArrayPointer(y), N_VGetArrayPointer(rate), N_VGetArrayPointer(out));
  } catch (const Error&) {
    return 1;  // IDA repeats with a shorter step
  }
  const double* r = N_VGetArrayPointer(out);
  return std::all_of(r, r + e.size(), [](double x) { return std::isfinite(x); }) ? 0 : 1;
}

int jacobian(sunrealtype t, sunrealtype c, N_Vector y, N_Vector rate, N_Vector, SUNMatrix out,
             void* equations, N_Vector, N_Vector, N_Vector) {
  auto& e = *static_cast<Equations*>(equations);
  const SparseMatrix j = e.jacobian(t, c, N_VGetArrayPointer(y), N_VGetArrayPointer(rate));
  std::copy(j.outerIndexPtr(), j.outerIndexPtr() + j.cols() + 1, SM_INDEXPTRS_S(out));
  std::copy(j.innerIndexPtr(), j.innerIndexPtr() + j.nonZeros(), SM_INDEXVALS_S(out));
  std::copy(j.valuePtr(), j.valuePtr() + j.nonZeros(), SM_DATA_S(out));
  return 0;
}

/// Sets the allowed error of each unknown. The multipliers are no part of the local error; their
/// size at the start scales them in the convergence test of Newton's method only.
void set_allowed(const fem::Model& model, const State& start, const IdaSettings& s,
                 N_Vector allowed) {
  const VectorXd unit = model.scales().cwiseInverse();
  const int n = model.n_dofs(), m = model.n_constraints();
  Eigen::Map<VectorXd> out(N_VGetArrayPointer(allowed), 2 * (n + m));
  const double force = m > 0 ? std::max(start.lambda.lpNorm<Eigen::Infinity>(), 1e-3) : 1.0;
  out << s.tolerance * s.size * unit, s.tolerance * s.speed * unit,
      VectorXd::Constant(m, std::sqrt(s.tolerance) * force),
      VectorXd::Constant(m, std::sqrt(s.tolerance) * s.speed);
}

}  // namespace

std::vector<State> solve_by_ida(Workspace& model, const State& start, std::span<const double> times,
                                const IdaSettings& settings, IdaCounts* counts) {
  const int n = model.n_dofs(), m = model.n_constraints();
  Equations equations(model);
  const auto size = static_cast<sunindextype>(equations.size());
  SUNContext made = nullptr;
#if SUNDIALS_VERSION_MAJOR >= 7
  require(SUNContext_Create(SUN_COMM_NULL, &made), "SUNContext_Create");
#else
  require(SUNContext_Create(nullptr, &made), "SUNContext_Create");
#endif
  const Context context(made);
  const auto vector = [&] { return Vector(N_VNew_Serial(size, made)); };
  const Vector y = vector(), rate = vector(), allowed = vector(), differential = vector();
  Eigen::Map<VectorXd>(N_VGetArrayPointer(y.get()), size) << start.q, start.v, start.lambda,
      VectorXd::Zero(m);
  Eigen::Map<VectorXd>(N_VGetArrayPointer(rate.get()), size) << start.v, start.a,
      VectorXd::Zero(2 * m);
  Eigen::Map<VectorXd>(N_VGetArrayPointer(differential.get()), size) << VectorXd::Ones(2 * n),
      VectorXd::Zero(2 * m);
  set_allowed(model, start, settings, allowed.get());

  const auto entries = static_cast<sunindextype>(
      equations.jacobian(start.t, 1, N_VGetArrayPointer(y.get()), N_VGetArrayPointer(rate.get()))
          .nonZeros());
  const Matrix matrix(SUNSparseMatrix(size, size, entries, CSC_MAT, made));
  const Solver solver(SUNLinSol_KLU(y.get(), matrix.get(), made));
  const Ida ida(IDACreate(made));
  void* it = ida.get();
  require(IDAInit(it, residual, start.t, y.get(), rate.get()), "IDAInit");
  require(IDASVtolerances(it, 0, allowed.get()), "IDASVtolerances");
  // IDA prints nothing, because its codes are part of the messages of this file.
#if SUNDIALS_VERSION_MAJOR >= 7
  require(SUNContext_ClearErrHandlers(context.get()), "SUNContext_ClearErrHandlers");
#else
  require(IDASetErrFile(it, nullptr), "IDASetErrFile");
#endif
  require(IDASetUserData(it, &equations), "IDASetUserData");
  require(IDASetId(it, differential.get()), "IDASetId");
  require(IDASetSuppressAlg(it, SUNTRUE), "IDASetSuppressAlg");
  require(IDASetMaxOrd(it, settings.max_order), "IDASetMaxOrd");
  require(IDASetMaxNumSteps(it, settings.max_steps), "IDASetMaxNumSteps");
  require(IDASetStopTime(it, times.back()), "IDASetStopTime");
  require(IDASetLinearSolver(it, solver.get(), matrix.get()), "IDASetLinearSolver");
  require(IDASetJacFn(it, jacobian), "IDASetJacFn");

  std::vector<State> out;
  for (const double t : times) {
    double reached = start.t;
    require(IDASolve(it, t, &reached, y.get(), rate.get(), IDA_NORMAL), "IDASolve");
    out.push_back(equations.state(t, N_VGetArrayPointer(y.get()), N_VGetArrayPointer(rate.get())));
  }
  if (counts) {
    IDAGetNumSteps(it, &counts->steps);
    IDAGetNumResEvals(it, &counts->residuals);
    IDAGetNumJacEvals(it, &counts->jacobians);
    IDAGetLastOrder(it, &counts->order);
  }
  return out;
}

}  // namespace flexmorph::testing
