#include "fem/dynamics/generalized_alpha.h"

#include <cmath>
#include <cstdio>

namespace flexmorph::fem {

GeneralizedAlpha::GeneralizedAlpha(Model& model, const AlphaSettings& settings)
    : model_(model), settings_(settings) {
  const double rho = settings.rho_inf;
  if (!(rho >= 0 && rho <= 1)) throw Error::input("generalized_alpha: rho_inf lies in [0, 1]");
  alpha_m_ = (2 * rho - 1) / (rho + 1);
  alpha_f_ = rho / (rho + 1);
  gamma_ = 0.5 + alpha_f_ - alpha_m_;
  beta_ = 0.25 * (gamma_ + 0.5) * (gamma_ + 0.5);
}

void GeneralizedAlpha::factorize(const State& x, const Constraints& c, const Weights& w,
                                 double scale) {
  if (scaled_version_ != model_.pattern_version()) {
    scales_ = model_.scales();
    const State reference = model_.reference();
    size_ = 0;
    for (Eigen::Index i = 0; i < reference.q.size(); ++i)
      if (scales_[i] == 1) size_ = std::max(size_, std::abs(reference.q[i]));
    if (size_ == 0) size_ = 1;
    scaled_version_ = model_.pattern_version();
  }
  model_.kkt(x, c, w, scale, kkt_);
  // Unknown i is solved as the displacement scales_i Δq_i; its equation as a virtual work on it.
  for (int column = 0; column < kkt_.cols(); ++column)
    for (SparseMatrix::InnerIterator entry(kkt_, column); entry; ++entry) {
      if (column < model_.n_dofs()) entry.valueRef() /= scales_[column];
      if (entry.row() < model_.n_dofs()) entry.valueRef() /= scales_[entry.row()];
    }
  if (analysed_version_ != model_.pattern_version()) {
    solver_.analyze(kkt_);
    analysed_version_ = model_.pattern_version();
  }
  solver_.factorize(kkt_);
  ++counts_.factorizations;
}

void GeneralizedAlpha::make_consistent(State& x) {
  model_.prepare(x.t);
  model_.constraints(x, constraints_);
  x.a.setZero(model_.n_dofs());
  model_.force(x, residual_);
  factored_h_ = 0;
  factorize(x, constraints_, {0, 0, 1}, 1);
  right_.resize(kkt_.rows());
  right_.head(model_.n_dofs()) = -residual_.cwiseQuotient(scales_);
  right_.tail(model_.n_constraints()) = constraints_.acceleration;
  solver_.solve(kkt_, right_, solution_);
  x.a = solution_.head(model_.n_dofs()).cwiseQuotient(scales_);
  x.lambda = solution_.tail(model_.n_constraints());
  x.alpha = x.a;
}

void GeneralizedAlpha::project_velocity(State& x) {
  model_.prepare(x.t);
  model_.constraints(x, constraints_);
  factored_h_ = 0;
  factorize(x, constraints_, {0, 0, 1}, 1);
  right_.setZero(kkt_.rows());
  right_.tail(model_.n_constraints()) = -constraints_.rate;
  for (const auto& entry : constraints_.jacobian)
    right_[model_.n_dofs() + entry.row()] -= entry.value() * x.v[entry.col()];
  solver_.solve(kkt_, right_, solution_);
  x.v += solution_.head(model_.n_dofs()).cwiseQuotient(scales_);
}

bool GeneralizedAlpha::try_step(State& x, double h) {
  State next = x;
  next.t = x.t + h;
  // Start of the iteration: the true acceleration stays what it was.
  next.alpha = ((1 - alpha_f_) * x.a + alpha_f_ * x.a - alpha_m_ * x.alpha) / (1 - alpha_m_);
  next.q += h * x.v + h * h * ((0.5 - beta_) * x.alpha + beta_ * next.alpha);
  next.v += h * ((1 - gamma_) * x.alpha + gamma_ * next.alpha);
  try {
    model_.prepare(next.t);
    if (!newton(next, h)) {
      factored_h_ = 0;
      return false;
    }
  } catch (const Error& error) {
    if (error.kind() != Error::Kind::numerical) throw;
    history_ += error.what();
    factored_h_ = 0;
    return false;
  }
  // The algorithmic acceleration that belongs to the true one.
  next.alpha = ((1 - alpha_f_) * next.a + alpha_f_ * x.a - alpha_m_ * x.alpha) / (1 - alpha_m_);
  x = std::move(next);
  return true;
}

bool GeneralizedAlpha::newton(State& x, double h) {
  const double beta_prime = (1 - alpha_m_) / (h * h * beta_ * (1 - alpha_f_));
  const double gamma_prime = gamma_ / (h * beta_);
  const double scale = beta_ * h * h;
  // A kept tangent that contracts less, or takes longer, is replaced.
  constexpr double kContraction = 0.2;
  constexpr int kPatience = 6;
  double last = 0;
  bool fresh = false;
  history_.clear();
  for (int iteration = 1; iteration <= settings_.max_iterations; ++iteration) {
    model_.constraints(x, constraints_);
    model_.force(x, residual_);
    model_.add_constraint_force(constraints_, x.lambda, residual_);
    if (std::abs(factored_h_ / h - 1) > 1e-6 || analysed_version_ != model_.pattern_version()) {
      factorize(x, constraints_, {1, gamma_prime, beta_prime}, scale);
      factored_h_ = h;
      fresh = true;
    }
    right_.resize(kkt_.rows());
    right_.head(model_.n_dofs()) = -scale * residual_.cwiseQuotient(scales_);
    right_.tail(model_.n_constraints()) = -constraints_.value;
    const double r = right_.lpNorm<Eigen::Infinity>();
    if (!std::isfinite(r)) return false;
    solver_.solve(kkt_, right_, solution_, false);
    const VectorXd dq = solution_.head(model_.n_dofs()).cwiseQuotient(scales_);
    const double correction = solution_.head(model_.n_dofs()).lpNorm<Eigen::Infinity>() / size_;
    x.q += dq;
    x.v += gamma_prime * dq;
    x.a += beta_prime * dq;
    x.lambda += solution_.tail(model_.n_constraints()) / scale;
    ++counts_.newton;
    char text[80];
    std::snprintf(text, sizeof text, "%d: |r| %.1e, |dq| %.1e; ", iteration, r, correction);
    history_ += text;
    if (!std::isfinite(correction)) return false;

    const double contraction = iteration > 1 ? correction / last : 1;
    const double error =
        contraction < 1 ? correction * contraction / (1 - contraction) : correction;
    if (correction <= settings_.tolerance || error <= 0.01 * settings_.tolerance) return true;
    if (fresh && iteration > 3 && contraction > 2) return false;  // diverges with its own tangent
    if (iteration > 1 && (contraction > kContraction || iteration >= kPatience)) factored_h_ = 0;
    last = correction;
  }
  return false;
}

void GeneralizedAlpha::advance(State& x, double t_end,
                               const std::function<void(const State&)>& accepted) {
  const double whole = t_end - x.t;
  double h = whole;
  int halvings = 0;
  while (x.t < t_end) {
    if (x.t + h > t_end - 1e-9 * whole) h = t_end - x.t;
    if (try_step(x, h)) {
      if (std::abs(x.t - t_end) <= 1e-9 * whole) x.t = t_end;
      ++counts_.steps;
      accepted(x);
      if (halvings > 0) {
        h *= 2;
        --halvings;
      }
      continue;
    }
    ++counts_.rejected;
    if (++halvings > settings_.max_halvings) {
      char text[200];
      std::snprintf(text, sizeof text,
                    "generalized_alpha: no convergence at t = %.6g s, step %d, step size %.2e s after "
                    "%d halvings, smallest area ratio %.2e (",
                    x.t, counts_.steps + 1, h, settings_.max_halvings, model_.smallest_area_ratio(x));
      throw Error::numerical(text + history_ +
                             "). A smaller time.step or a smaller rho_inf often helps; an area "
                             "ratio near zero means that the material has collapsed.");
    }
    h *= 0.5;
  }
}

}  // namespace flexmorph::fem
