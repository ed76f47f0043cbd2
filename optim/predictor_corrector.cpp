#include "optim/predictor_corrector.h"

#include <cblas.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>

namespace flexmorph::optim {
namespace {

constexpr int kSteps = 40;      // about 14 are typical
constexpr double kGoal = 1e-9;  // largest residual at convergence
// Complementarity products at the start, tried one after the other. Small products save steps with
// the usual scaling of f and g. Constraints that cannot be met have multipliers c and need larger
// products.
constexpr double kStarts[] = {0.01, 1, 100};
constexpr double kShortStep = 0.1;
constexpr int kMaxShortSteps = 3;    // in sequence; then the next attempt begins
constexpr double kStartSlack = 0.1;  // lower bound of slacks at the start
constexpr double kToBound = 0.9;  // smallest limit of a step, as a fraction of the way to the bound
constexpr double kGrowth = 10;    // largest factor of the infeasibility in one step
constexpr int kHalvings = 10;

constexpr double kClose = 10;             // ratio of E to the coupling below which a row is close
constexpr double kPredictorError = 1e-2;  // relative tolerance of conjugate gradients
constexpr double kCorrectorError = 1e-5;  // a larger tolerance costs steps
constexpr int kMaxIterations = 20;

double fastest_decrease(const VectorXd& step, const VectorXd& v) {
  return (-step.array() / v.array()).maxCoeff();
}

}  // namespace

PredictorCorrector::PredictorCorrector(int n, int m) : n_(n), m_(m) {
  for (Eigen::ArrayXd* w : {&to_upp_, &to_low_, &gap_alpha_, &gap_beta_, &plam_, &qlam_, &up_,
                            &down_, &root_, &h_, &in_x_, &lacking_.xi, &lacking_.eta}) {
    *w = Eigen::ArrayXd::Zero(n);
  }
  for (Eigen::ArrayXd* w : {&in_y_, &in_g_, &lacking_.mu, &lacking_.s, &inverse_y_}) {
    *w = Eigen::ArrayXd::Zero(m);
  }
  for (VectorXd* w : {&values_, &own_, &coupling_, &rhs_, &residual_, &preconditioned_, &conjugate_,
                      &image_, &part_}) {
    *w = VectorXd::Zero(m);
  }
  work_ = VectorXd::Zero(n);
  step_.resize(n, m);
  from_.resize(n, m);
  W_ = W_close_ = MatrixXd::Zero(n, m);
  block_ = MatrixXd::Zero(m, m);
  close_.reserve(m);
}

/// Sets the start: x in the middle of the bounds, slacks that satisfy the constraints if possible.
void PredictorCorrector::begin(const MmaSubproblem& p, double product, MmaVariables& at) {
  at.x = 0.5 * (p.alpha + p.beta);
  at.xi = at.eta = product * (at.x - p.alpha).cwiseInverse().cwiseMax(1);
  at.lambda.setConstant(product);
  at.mu = p.c.cwiseMax(1);
  at.y = product * at.mu.cwiseInverse();
  at.zeta = std::max(1.0, p.a0);
  at.z = product / at.zeta;
  functions(p, at);
  at.s = (p.b - values_).cwiseMax(kStartSlack);
}

/// Updates all quantities that depend on x and λ alone.
void PredictorCorrector::functions(const MmaSubproblem& p, const MmaVariables& at) {
  gap_alpha_ = (at.x - p.alpha).array();
  gap_beta_ = (p.beta - at.x).array();
  to_upp_ = (p.upp - at.x).array().inverse();
  to_low_ = (at.x - p.low).array().inverse();
  plam_ = p.p0.array();
  qlam_ = p.q0.array();
  plam_.matrix().noalias() += p.P * at.lambda;
  qlam_.matrix().noalias() += p.Q * at.lambda;
  values_.noalias() = p.P.transpose() * to_upp_.matrix();
  values_.noalias() += p.Q.transpose() * to_low_.matrix();
}

void PredictorCorrector::residuals(const MmaSubproblem& p, const MmaVariables& at) {
  in_x_ = plam_ * to_upp_.square() - qlam_ * to_low_.square() - at.xi.array() + at.eta.array();
  in_y_ = (p.c + p.d.cwiseProduct(at.y) - at.mu - at.lambda).array();
  in_g_ = (values_ - p.a * at.z - at.y + at.s - p.b).array();
  in_z_ = p.a0 - at.zeta - p.a.dot(at.lambda);
}

double PredictorCorrector::infeasibility() const {
  return std::max(
      {in_x_.abs().maxCoeff(), in_y_.abs().maxCoeff(), in_g_.abs().maxCoeff(), std::abs(in_z_)});
}

/// Sets the residuals of the products for the predictor, whose target is zero.
void PredictorCorrector::predict(const MmaVariables& at) {
  lacking_.xi = -at.xi.array() * gap_alpha_;
  lacking_.eta = -at.eta.array() * gap_beta_;
  lacking_.mu = -at.mu.array() * at.y.array();
  lacking_.s = -at.s.array() * at.lambda.array();
  lacking_.zeta = -at.zeta * at.z;
}

/// Sets the residuals of the products for the corrector, whose target is `target`, including the
/// second-order terms of the predictor `step_`.
void PredictorCorrector::correct(double target) {
  lacking_.xi += target - step_.xi.array() * step_.x.array();
  lacking_.eta += target + step_.eta.array() * step_.x.array();
  lacking_.mu += target - step_.mu.array() * step_.y.array();
  lacking_.s += target - step_.s.array() * step_.lambda.array();
  lacking_.zeta += target - step_.zeta * step_.z;
}

/// Returns the largest product; valid after predict().
double PredictorCorrector::largest_product() const {
  return -std::min({lacking_.xi.minCoeff(), lacking_.eta.minCoeff(), lacking_.mu.minCoeff(),
                    lacking_.s.minCoeff(), lacking_.zeta});
}

/// Returns the mean of the products after a step of t times `step_`.
double PredictorCorrector::mean_product(const MmaVariables& at, double t) const {
  const auto sum = [&](const auto& v, const auto& dv, const auto& w, const auto& dw, double sign) {
    return ((v.array() + t * dv.array()) * (w.array() + sign * t * dw.array())).sum();
  };
  const double total = sum(at.xi, step_.xi, gap_alpha_, step_.x, 1) +
                       sum(at.eta, step_.eta, gap_beta_, step_.x, -1) +
                       sum(at.mu, step_.mu, at.y, step_.y, 1) +
                       sum(at.lambda, step_.lambda, at.s, step_.s, 1) +
                       (at.zeta + t * step_.zeta) * (at.z + t * step_.z);
  return total / (2 * n_ + 2 * m_ + 1);
}

/// Computes D^-½, W and the diagonal of the normal matrix.
void PredictorCorrector::normal_matrix(const MmaSubproblem& p, const MmaVariables& at) {
  up_ = to_upp_.square();
  down_ = to_low_.square();
  root_ = (2 * (plam_ * up_ * to_upp_ + qlam_ * down_ * to_low_) + at.xi.array() / gap_alpha_ +
           at.eta.array() / gap_beta_)
              .sqrt()
              .inverse();
  up_ *= root_;
  down_ *= root_;
  z_over_zeta_ = at.z / at.zeta;
  for (int i = 0; i < m_; ++i) {
    W_.col(i).array() = p.P.col(i).array() * up_ - p.Q.col(i).array() * down_;
    coupling_[i] = W_.col(i).squaredNorm() + z_over_zeta_ * p.a[i] * p.a[i];
  }
  inverse_y_ = (p.d.array() + at.mu.array() / at.y.array()).inverse();
  own_ = (at.s.array() / at.lambda.array() + inverse_y_).matrix();
}

/// Factors the block of all constraints with E < closeness * coupling.
void PredictorCorrector::factor_close(const MmaSubproblem& p, double closeness) {
  close_.clear();
  for (int i = 0; i < m_; ++i) {
    if (own_[i] < closeness * coupling_[i]) close_.push_back(i);
  }
  const int k = static_cast<int>(close_.size());
  if (k == 0) return;
  for (int j = 0; j < k; ++j) {
    W_close_.col(j) = W_.col(close_[j]);
    for (int i = j; i < k; ++i) block_(i, j) = z_over_zeta_ * p.a[close_[i]] * p.a[close_[j]];
    block_(j, j) += own_[close_[j]];
  }
  cblas_dsyrk(CblasColMajor, CblasLower, CblasTrans, k, n_, 1, W_close_.data(), n_, 1,
              block_.data(), m_);
  Eigen::Ref<MatrixXd> block = block_.topLeftCorner(k, k);
  Eigen::LLT<Eigen::Ref<MatrixXd>> factored_in_place(block);
}

/// Applies the preconditioner to residual_; the result is preconditioned_.
void PredictorCorrector::precondition() {
  const int k = static_cast<int>(close_.size());
  preconditioned_ = residual_.cwiseQuotient(own_ + coupling_);
  auto part = part_.head(k);
  for (int i = 0; i < k; ++i) part[i] = residual_[close_[i]];
  const auto factor = block_.topLeftCorner(k, k).triangularView<Eigen::Lower>();
  factor.solveInPlace(part);
  factor.transpose().solveInPlace(part);
  for (int i = 0; i < k; ++i) preconditioned_[close_[i]] = part[i];
}

/// Computes step_.lambda = N^-1 rhs_ by conjugate gradients.
/// @param tolerance  of the residual relative to rhs_, both in the norm of the preconditioner
/// @return true if the tolerance was reached
bool PredictorCorrector::solve_normal(const MmaSubproblem& p, double tolerance) {
  step_.lambda.setZero();
  residual_ = rhs_;
  precondition();
  conjugate_ = preconditioned_;
  double norm = residual_.dot(preconditioned_);
  const double goal = tolerance * tolerance * norm;
  for (int iteration = 0; iteration < kMaxIterations && norm > goal; ++iteration) {
    work_.noalias() = W_ * conjugate_;
    image_ = own_.cwiseProduct(conjugate_) + p.a * (z_over_zeta_ * p.a.dot(conjugate_));
    image_.noalias() += W_.transpose() * work_;
    const double length = norm / conjugate_.dot(image_);
    step_.lambda += length * conjugate_;
    residual_ -= length * image_;
    precondition();
    const double next = residual_.dot(preconditioned_);
    conjugate_ = preconditioned_ + (next / norm) * conjugate_;
    norm = next;
  }
  return norm <= goal;
}

/// Computes `step_` from the residuals of the conditions and of the products, by elimination of all
/// variables except λ.
void PredictorCorrector::direction(const MmaSubproblem& p, const MmaVariables& at,
                                   double tolerance) {
  h_ = (lacking_.xi / gap_alpha_ - lacking_.eta / gap_beta_ - in_x_) * root_;
  const double in_z = lacking_.zeta / at.z - in_z_;
  step_.y.array() = lacking_.mu / at.y.array() - in_y_;
  rhs_.array() = in_g_ - inverse_y_ * step_.y.array() + lacking_.s / at.lambda.array();
  rhs_ -= p.a * (z_over_zeta_ * in_z);
  rhs_.noalias() += W_.transpose() * h_.matrix();
  if (!solve_normal(p, tolerance)) {
    factor_close(p, std::numeric_limits<double>::infinity());
    solve_normal(p, tolerance);
  }
  work_ = h_.matrix();
  work_.noalias() -= W_ * step_.lambda;
  step_.x.array() = root_ * work_.array();
  step_.y.array() = (step_.y + step_.lambda).array() * inverse_y_;
  step_.z = z_over_zeta_ * (p.a.dot(step_.lambda) + in_z);
  step_.xi.array() = (lacking_.xi - at.xi.array() * step_.x.array()) / gap_alpha_;
  step_.eta.array() = (lacking_.eta + at.eta.array() * step_.x.array()) / gap_beta_;
  step_.mu.array() = (lacking_.mu - at.mu.array() * step_.y.array()) / at.y.array();
  step_.s.array() = (lacking_.s - at.s.array() * step_.lambda.array()) / at.lambda.array();
  step_.zeta = (lacking_.zeta - at.zeta * step_.z) / at.z;
}

/// Returns the factor of `step_` at which the first positive variable becomes zero.
double PredictorCorrector::longest_step(const MmaVariables& at) const {
  double fastest = std::numeric_limits<double>::min();
  for (const auto& [step, v] : {std::pair{&step_.xi, &at.xi},
                                {&step_.eta, &at.eta},
                                {&step_.y, &at.y},
                                {&step_.mu, &at.mu},
                                {&step_.lambda, &at.lambda},
                                {&step_.s, &at.s}}) {
    fastest = std::max(fastest, fastest_decrease(*step, *v));
  }
  fastest = std::max(fastest, (-step_.x.array() / gap_alpha_).maxCoeff());
  fastest = std::max(fastest, (step_.x.array() / gap_beta_).maxCoeff());
  fastest = std::max({fastest, -step_.z / at.z, -step_.zeta / at.zeta});
  return 1 / fastest;
}

int PredictorCorrector::solve(const MmaSubproblem& p, MmaVariables& at) {
  int steps = 0;
  for (const double product : kStarts) {
    begin(p, product, at);
    if (attempt(p, at, steps)) break;
  }
  return steps;
}

/// Runs Mehrotra's method from `at` on. @return true if it has converged
bool PredictorCorrector::attempt(const MmaSubproblem& p, MmaVariables& at, int& steps) {
  residuals(p, at);
  int short_ones = 0;
  for (int step = 0; step < kSteps && short_ones < kMaxShortSteps; ++step, ++steps) {
    predict(at);
    const double before = infeasibility();
    if (std::max(before, largest_product()) <= kGoal) return true;
    normal_matrix(p, at);
    factor_close(p, kClose);
    direction(p, at, kPredictorError);
    const double mean = mean_product(at, 0);
    const double ratio = mean_product(at, std::min(1.0, longest_step(at))) / mean;
    // A target far below the goal would only make the last systems ill-conditioned.
    correct(std::max(ratio * ratio * ratio * mean, 0.1 * kGoal));
    direction(p, at, kCorrectorError);
    if (!step_.x.allFinite() || !step_.lambda.allFinite()) return false;
    double t = std::min(1.0, std::max(kToBound, 1 - mean) * longest_step(at));
    short_ones = t < kShortStep ? short_ones + 1 : 0;
    std::swap(from_, at);
    for (int halving = 0; halving < kHalvings; ++halving, t *= 0.5) {
      at.set(from_, t, step_);
      functions(p, at);
      residuals(p, at);
      if (infeasibility() <= kGrowth * std::max(before, mean)) break;
    }
  }
  return false;
}

}  // namespace flexmorph::optim
