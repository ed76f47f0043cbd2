#include "fem/dynamics/generalized_alpha.h"

namespace flexmorph::fem {

GeneralizedAlpha::GeneralizedAlpha(Model& model, const AlphaSettings& settings)
    : StepSolver(model, settings, "generalized_alpha",
                 "A smaller time.step or a smaller rho_inf often helps.") {
  const double rho = settings.rho_inf;
  if (!(rho >= 0 && rho <= 1)) throw Error::input("generalized_alpha: rho_inf lies in [0, 1]");
  alpha_m_ = (2 * rho - 1) / (rho + 1);
  alpha_f_ = rho / (rho + 1);
  gamma_ = 0.5 + alpha_f_ - alpha_m_;
  beta_ = 0.25 * (gamma_ + 0.5) * (gamma_ + 0.5);
}

void GeneralizedAlpha::begin(const State& x, double h) {
  h_ = h;
  next_ = x;
  next_.t = x.t + h;
  // Start of the iteration: the true acceleration stays what it was.
  next_.alpha = ((1 - alpha_f_) * x.a + alpha_f_ * x.a - alpha_m_ * x.alpha) / (1 - alpha_m_);
  next_.q += h * x.v + h * h * ((0.5 - beta_) * x.alpha + beta_ * next_.alpha);
  next_.v += h * ((1 - gamma_) * x.alpha + gamma_ * next_.alpha);
  model().prepare(next_);
}

Weights GeneralizedAlpha::weights() const {
  return {1, gamma_ / (h_ * beta_), (1 - alpha_m_) / (h_ * h_ * beta_ * (1 - alpha_f_))};
}

void GeneralizedAlpha::residual(VectorXd& force, VectorXd& constraint) {
  if (model().has_free_lines()) model().prepare(next_);
  model().constraints(next_, constraints_);
  model().force(next_, force);
  model().add_constraint_force(constraints_, next_.lambda, force);
  constraint = constraints_.value;
}

void GeneralizedAlpha::tangent(SparseMatrix& out) {
  model().kkt(next_, constraints_, weights(), scale(), out);
}

void GeneralizedAlpha::correct(const VectorXd& dq, const VectorXd& dlambda) {
  const Weights w = weights();
  next_.q += dq;
  next_.v += w.v * dq;
  next_.a += w.a * dq;
  next_.lambda += dlambda;
}

void GeneralizedAlpha::finish(State& x) {
  // The algorithmic acceleration that belongs to the true one.
  next_.alpha = ((1 - alpha_f_) * next_.a + alpha_f_ * x.a - alpha_m_ * x.alpha) / (1 - alpha_m_);
  x = next_;
}

}  // namespace flexmorph::fem
