#include "optim/kkt.h"

#include <Eigen/Cholesky>
#include <limits>
#include <vector>

#include "optim/optimizer.h"

namespace flexmorph::optim {
namespace {

constexpr double kEps = std::numeric_limits<double>::epsilon();

/// Solves G_PP λ_P = h_P for the passive set P. A diagonal term of the size of round-off keeps the
/// matrix regular if constraints are linearly dependent.
VectorXd solve_passive(const MatrixXd& G, const VectorXd& h, const std::vector<int>& passive) {
  MatrixXd G_pp = G(passive, passive);
  G_pp.diagonal().array() += kEps * (G_pp.trace() + std::numeric_limits<double>::min());
  return G_pp.ldlt().solve(h(passive));
}

/// The vector P(df + dgᵀ λ). Half its squared norm is convex and once differentiable in λ.
class ProjectedGradient {
 public:
  ProjectedGradient(const ProblemValues& r, const VectorXd& x, const VectorXd& lower,
                    const VectorXd& upper, double tolerance)
      : at_lower_((x.array() <= lower.array() + tolerance)),
        at_upper_((x.array() >= upper.array() - tolerance)),
        df_(r.df) {}

  VectorXd operator()(const MatrixXd& A, const VectorXd& lambda) const {
    VectorXd r = df_;
    if (lambda.size() > 0) r.noalias() += A.transpose() * lambda;
    for (Eigen::Index j = 0; j < r.size(); ++j) {
      if ((at_lower_[j] && r[j] > 0) || (at_upper_[j] && r[j] < 0)) r[j] = 0;
    }
    return r;
  }

 private:
  Eigen::Array<bool, Eigen::Dynamic, 1> at_lower_, at_upper_;
  const VectorXd& df_;
};

/// Returns the multipliers of the rows of A that minimize |P(df + Aᵀ λ)|, by Newton's method on a
/// piecewise quadratic function. Each step solves a non-negative least-squares problem over the
/// entries that P keeps at the present λ.
VectorXd multipliers(const MatrixXd& A, const VectorXd& df, const ProjectedGradient& projected) {
  VectorXd lambda = VectorXd::Zero(A.rows());
  VectorXd r = projected(A, lambda);
  for (int step = 0; step < 30; ++step) {
    // An entry that is zero although P keeps it is left out here; it takes part in the next step.
    const VectorXd counted = (r.array() != 0).cast<double>();
    const MatrixXd weighted = A * counted.asDiagonal();
    const VectorXd target = nonnegative_minimum(weighted * A.transpose(), -(weighted * df));
    const double before = r.squaredNorm();
    double t = 1;
    VectorXd trial, r_trial;
    for (; t > 1e-6; t *= 0.5) {
      trial = lambda + t * (target - lambda);
      r_trial = projected(A, trial);
      if (r_trial.squaredNorm() < before) break;
    }
    if (!(r_trial.squaredNorm() < before)) break;
    lambda = trial;
    r = r_trial;
    if (before - r.squaredNorm() <= 1e-14 * before) break;
  }
  return lambda;
}

}  // namespace

VectorXd nonnegative_minimum(const MatrixXd& G, const VectorXd& h) {
  const int m = static_cast<int>(h.size());
  VectorXd lambda = VectorXd::Zero(m);
  if (m == 0) return lambda;
  const double tolerance = 100 * kEps * h.cwiseAbs().maxCoeff();
  std::vector<bool> is_passive(m, false);
  for (int sweep = 0; sweep < 3 * m + 10; ++sweep) {
    const VectorXd gain = h - G * lambda;
    int entering = -1;
    for (int i = 0; i < m; ++i) {
      if (!is_passive[i] && gain[i] > tolerance && (entering < 0 || gain[i] > gain[entering])) {
        entering = i;
      }
    }
    if (entering < 0) break;
    is_passive[entering] = true;
    for (int inner = 0; inner <= m; ++inner) {
      std::vector<int> passive;
      for (int i = 0; i < m; ++i) {
        if (is_passive[i]) passive.push_back(i);
      }
      const VectorXd target = solve_passive(G, h, passive);
      double t = 1;
      for (size_t k = 0; k < passive.size(); ++k) {
        const double from = lambda[passive[k]];
        if (target[k] <= 0) t = std::min(t, from / (from - target[k] + 1e-300));
      }
      for (size_t k = 0; k < passive.size(); ++k) {
        double& value = lambda[passive[k]];
        value += t * (target[k] - value);
        if (target[k] <= 0 && value <= kEps * lambda.maxCoeff()) {
          value = 0;
          is_passive[passive[k]] = false;
        }
      }
      if (t == 1) break;
    }
  }
  return lambda;
}

KktPoint kkt_point(const ProblemValues& r, const VectorXd& x, const VectorXd& lower,
                   const VectorXd& upper, double active_tolerance) {
  std::vector<int> active;
  VectorXd scale(r.g.size());
  for (Eigen::Index i = 0; i < r.g.size(); ++i) {
    const double length = r.dg.row(i).norm();
    if (r.g[i] < -active_tolerance || length == 0) continue;
    scale[active.size()] = 1 / length;
    active.push_back(static_cast<int>(i));
  }
  scale.conservativeResize(static_cast<Eigen::Index>(active.size()));
  MatrixXd A(active.size(), x.size());
  for (size_t k = 0; k < active.size(); ++k) A.row(k) = scale[k] * r.dg.row(active[k]);

  const ProjectedGradient projected(r, x, lower, upper, active_tolerance);
  KktPoint point;
  point.lambda = VectorXd::Zero(r.g.size());
  VectorXd lambda = VectorXd::Zero(static_cast<Eigen::Index>(active.size()));
  if (!active.empty()) lambda = multipliers(A, r.df, projected);
  point.residual = projected(A, lambda).lpNorm<Eigen::Infinity>();
  for (size_t k = 0; k < active.size(); ++k) point.lambda[active[k]] = scale[k] * lambda[k];
  return point;
}

double kkt_residual(const ProblemValues& r, const VectorXd& x, const VectorXd& lower,
                    const VectorXd& upper, double active_tolerance) {
  return kkt_point(r, x, lower, upper, active_tolerance).residual;
}

}  // namespace flexmorph::optim
