#include "optim/mma_subproblem.h"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "optim/predictor_corrector.h"

namespace flexmorph::optim {
namespace {

constexpr double kLastEpsilon = 1e-9;
constexpr double kMaxKktResidual = 1e-6;  // largest KKT residual of a solved subproblem
constexpr int kNewtonSteps = 60;          // per value of ε; about 5 are typical
constexpr int kHalvings = 50;
constexpr int kManyConstraints = 8;         // from here on Newton steps take milliseconds
constexpr double kTowardsBound = 1 / 1.01;  // fraction of the distance to the nearest bound

/// Returns the largest -Δ/v over all positive variables v with steps Δ.
double fastest_decrease(const VectorXd& step, const VectorXd& v) {
  return v.size() == 0 ? 0 : (-step.array() / v.array()).maxCoeff();
}

}  // namespace

void MmaVariables::resize(int n, int m) {
  for (VectorXd* v : {&x, &xi, &eta}) *v = VectorXd::Zero(n);
  for (VectorXd* v : {&y, &mu, &lambda, &s}) *v = VectorXd::Zero(m);
}

void MmaVariables::set(const MmaVariables& from, double t, const MmaVariables& step) {
  x = from.x + t * step.x;
  xi = from.xi + t * step.xi;
  eta = from.eta + t * step.eta;
  y = from.y + t * step.y;
  mu = from.mu + t * step.mu;
  lambda = from.lambda + t * step.lambda;
  s = from.s + t * step.s;
  z = from.z + t * step.z;
  zeta = from.zeta + t * step.zeta;
}

MmaSolver::MmaSolver(int n, int m) : n_(n), m_(m), factor_(m) {
  for (MmaVariables* v : {&at_, &from_, &step_}) v->resize(n, m);
  for (Eigen::ArrayXd* w : {&to_upp_, &to_low_, &to_beta_, &to_alpha_, &plam_, &qlam_, &slope_,
                            &dx_, &diagonal_, &work_}) {
    *w = Eigen::ArrayXd::Zero(n);
  }
  values_ = r_m_ = inverse_y_ = VectorXd::Zero(m);
  G_ = weighted_ = MatrixXd::Zero(n, m);
  normal_ = MatrixXd::Zero(m, m);
  if (m >= kManyConstraints) predictor_corrector_ = std::make_unique<PredictorCorrector>(n, m);
}

MmaSolver::~MmaSolver() = default;

void MmaSolver::begin(const MmaSubproblem& p) {
  at_.x = 0.5 * (p.alpha + p.beta);
  at_.xi = (at_.x - p.alpha).cwiseInverse().cwiseMax(1);
  at_.eta = (p.beta - at_.x).cwiseInverse().cwiseMax(1);
  at_.y.setOnes();
  at_.lambda.setOnes();
  at_.s.setOnes();
  at_.mu = (0.5 * p.c).cwiseMax(1);
  at_.z = at_.zeta = 1;
}

/// Updates all quantities that depend on x and λ alone.
void MmaSolver::refresh(const MmaSubproblem& p) {
  to_upp_ = (p.upp - at_.x).array().inverse();
  to_low_ = (at_.x - p.low).array().inverse();
  to_beta_ = (p.beta - at_.x).array().inverse();
  to_alpha_ = (at_.x - p.alpha).array().inverse();
  plam_ = p.p0.array();
  qlam_ = p.q0.array();
  if (m_ > 0) {
    plam_.matrix().noalias() += p.P * at_.lambda;
    qlam_.matrix().noalias() += p.Q * at_.lambda;
    values_.noalias() = p.P.transpose() * to_upp_.matrix();
    values_.noalias() += p.Q.transpose() * to_low_.matrix();
  }
  slope_ = plam_ * to_upp_.square() - qlam_ * to_low_.square();
}

/// Returns the residual of the relaxed KKT conditions at `at_`.
MmaSolver::Residual MmaSolver::residual(const MmaSubproblem& p, double epsilon) {
  Residual r;
  double sum = 0;
  const auto take = [&](const auto& entries) {
    if (entries.size() == 0) return;
    sum += entries.square().sum();
    r.largest = std::max(r.largest, entries.abs().maxCoeff());
  };
  const auto take_vector = [&](const auto& expression) {
    work_ = expression;
    take(work_);
  };
  take_vector(slope_ - at_.xi.array() + at_.eta.array());
  take_vector(at_.xi.array() / to_alpha_ - epsilon);
  take_vector(at_.eta.array() / to_beta_ - epsilon);
  const auto take_small = [&](const auto& expression) {
    r_m_ = expression;
    take(r_m_.array());
  };
  take_small(p.c + p.d.cwiseProduct(at_.y) - at_.mu - at_.lambda);
  take_small(values_ - p.a * at_.z - at_.y + at_.s - p.b);
  take_small((at_.mu.array() * at_.y.array() - epsilon).matrix());
  take_small((at_.lambda.array() * at_.s.array() - epsilon).matrix());
  const double in_z = p.a0 - at_.zeta - p.a.dot(at_.lambda);
  const double product_z = at_.zeta * at_.z - epsilon;
  sum += in_z * in_z + product_z * product_z;
  r.largest = std::max({r.largest, std::abs(in_z), std::abs(product_z)});
  r.norm = std::sqrt(sum);
  return r;
}

/// Computes Newton's direction `step_` by elimination of all variables except λ:
///
///   (S/Λ + (d + μ/y)^-1 + Gᵀ D^-1 G + a aᵀ z/ζ) Δλ = r
///
/// G (n x m) holds the gradients of the constraints, D (n) the second derivatives in x including
/// the barrier of the bounds. All terms of the matrix are positive semidefinite; the first one is
/// definite.
void MmaSolver::newton_direction(const MmaSubproblem& p, double epsilon) {
  dx_ = slope_ - epsilon * to_alpha_ + epsilon * to_beta_;
  diagonal_ = 2 * (plam_ * to_upp_.cube() + qlam_ * to_low_.cube()) + at_.xi.array() * to_alpha_ +
              at_.eta.array() * to_beta_;
  diagonal_ = diagonal_.inverse();
  const double dz = p.a0 - p.a.dot(at_.lambda) - epsilon / at_.z;
  const double z_over_zeta = at_.z / at_.zeta;

  if (m_ > 0) {
    for (int i = 0; i < m_; ++i) {
      G_.col(i).array() =
          p.P.col(i).array() * to_upp_.square() - p.Q.col(i).array() * to_low_.square();
      weighted_.col(i).array() = G_.col(i).array() * diagonal_;
    }
    inverse_y_ = (p.d.array() + at_.mu.array() / at_.y.array()).inverse();
    // Right-hand sides for y and λ of the reduced system.
    step_.y = p.c + p.d.cwiseProduct(at_.y) - at_.lambda - epsilon * at_.y.cwiseInverse();
    r_m_ = values_ - p.a * at_.z - at_.y - p.b + epsilon * at_.lambda.cwiseInverse();
    r_m_ += step_.y.cwiseProduct(inverse_y_) + p.a * (dz * z_over_zeta);
    r_m_.noalias() -= weighted_.transpose() * dx_.matrix();

    normal_.noalias() = weighted_.transpose() * G_;
    normal_.noalias() += p.a * (z_over_zeta * p.a.transpose());
    normal_.diagonal().array() += at_.s.array() / at_.lambda.array() + inverse_y_.array();
    factor_.compute(normal_);
    step_.lambda = r_m_;
    factor_.solveInPlace(step_.lambda);

    dx_.matrix().noalias() += G_ * step_.lambda;
    step_.y = (step_.lambda - step_.y).cwiseProduct(inverse_y_);
    step_.mu.array() =
        (epsilon - at_.mu.array() * step_.y.array()) / at_.y.array() - at_.mu.array();
    step_.s.array() =
        (epsilon - at_.s.array() * step_.lambda.array()) / at_.lambda.array() - at_.s.array();
  }
  step_.x.array() = -dx_ * diagonal_;
  step_.z = (p.a.dot(step_.lambda) - dz) * z_over_zeta;
  step_.zeta = (epsilon - at_.zeta * step_.z) / at_.z - at_.zeta;
  step_.xi.array() = (epsilon - at_.xi.array() * step_.x.array()) * to_alpha_ - at_.xi.array();
  step_.eta.array() = (epsilon + at_.eta.array() * step_.x.array()) * to_beta_ - at_.eta.array();
}

/// Returns the longest step, at most 1, after which all positive variables are still positive.
double MmaSolver::longest_step() const {
  double fastest = kTowardsBound;
  for (const auto& [step, v] : {std::pair{&step_.xi, &at_.xi},
                                {&step_.eta, &at_.eta},
                                {&step_.y, &at_.y},
                                {&step_.mu, &at_.mu},
                                {&step_.lambda, &at_.lambda},
                                {&step_.s, &at_.s}}) {
    fastest = std::max(fastest, fastest_decrease(*step, *v));
  }
  fastest = std::max(fastest, (-step_.x.array() * to_alpha_).maxCoeff());
  fastest = std::max(fastest, (step_.x.array() * to_beta_).maxCoeff());
  fastest = std::max({fastest, -step_.z / at_.z, -step_.zeta / at_.zeta});
  return kTowardsBound / fastest;
}

/// Runs Newton's method at one ε until the largest residual falls below 0.9 ε.
void MmaSolver::stage(const MmaSubproblem& p, double epsilon) {
  Residual r = residual(p, epsilon);
  for (int step = 0; step < kNewtonSteps; ++step) {
    if (r.largest <= 0.9 * epsilon) return;
    newton_direction(p, epsilon);
    from_ = at_;
    ++solution_.newton_steps;
    double t = longest_step();
    if (!std::isfinite(t)) return;
    Residual next;
    for (int halving = 0; halving < kHalvings; ++halving, t *= 0.5) {
      at_.set(from_, t, step_);
      refresh(p);
      next = residual(p, epsilon);
      if (next.norm <= r.norm) break;
    }
    if (!(next.norm <= r.norm)) {
      at_ = from_;
      refresh(p);
      return;
    }
    r = next;
  }
}

void MmaSolver::follow_barrier(const MmaSubproblem& p) {
  begin(p);
  refresh(p);
  for (double epsilon = 1; epsilon > 0.5 * kLastEpsilon; epsilon *= 0.1) {
    stage(p, epsilon);  // a stage that fails still provides a start for the next one
  }
  measure_kkt(p);
}

void MmaSolver::measure_kkt(const MmaSubproblem& p) {
  solution_.kkt = residual(p, 0).largest;
  solution_.solved = solution_.kkt <= kMaxKktResidual;
}

const MmaSolution& MmaSolver::solve(const MmaSubproblem& p) {
  assert(p.p0.size() == n_ && p.P.rows() == n_ && p.P.cols() == m_ && p.b.size() == m_);
  assert(((p.alpha - p.low).array() > 0).all() && ((p.upp - p.beta).array() > 0).all());
  assert(((p.beta - p.alpha).array() > 0).all());
  solution_.newton_steps = 0;
  solution_.solved = false;
  if (predictor_corrector_) {
    solution_.newton_steps = predictor_corrector_->solve(p, at_);
    refresh(p);
    measure_kkt(p);
  }
  if (!solution_.solved) follow_barrier(p);
  solution_.x = at_.x;
  solution_.y = at_.y;
  solution_.z = at_.z;
  solution_.lambda = at_.lambda;
  return solution_;
}

}  // namespace flexmorph::optim
