#include "fem/dynamics/integrators/energy_momentum.h"

namespace flexmorph::fem {

bool has_mean_forces(const Model& model) {
  const auto has = [](const auto& each) { return each.mean != nullptr; };
  return std::ranges::all_of(model.force_elements(), has) &&
         std::ranges::all_of(model.bodies(),
                             [&](const Body& b) { return std::ranges::all_of(b.terms, has); });
}

EnergyMomentum::EnergyMomentum(Workspace& model, const EnergyMomentumSettings& settings)
    : StepSolver(model, settings, "energy_momentum",
                 "This integrator has no numerical damping. Reduce time.step, or set integrator = "
                 "\"generalized_alpha\".") {}

void EnergyMomentum::begin(const State& x, double h) {
  h_ = h;
  start_ = x;
  model().constraints(start_, at_end_);
  start_rate_ = at_end_.rate;
  end_ = mean_ = x;
  end_.t = x.t + h;
  mean_.t = x.t + 0.5 * h;
  step_ = h * x.v + 0.5 * h * h * x.a;
  set_mean();
}

/// Computes the other variables from the displacement of the step.
void EnergyMomentum::set_mean() {
  end_.q = start_.q + step_;
  mean_.q = start_.q + 0.5 * step_;
  mean_.v = step_ / h_;
  mean_.a = (2 / h_) * (mean_.v - start_.v);
}

void EnergyMomentum::residual(VectorXd& force, VectorXd& constraint) {
  model().constraints(end_, at_end_);
  model().constraints(mean_, at_mean_);
  model().mean_force(mean_, start_.q, end_.q, force);
  model().add_constraint_force(at_mean_, mean_.lambda, force);
  constraint = at_end_.value;
}

void EnergyMomentum::tangent(SparseMatrix& out) {
  model().mean_kkt(mean_, start_.q, end_.q, at_mean_, at_end_, {0.5, 1 / h_, 2 / (h_ * h_)},
                   scale(), out);
}

void EnergyMomentum::correct(const VectorXd& dq, const VectorXd& dlambda) {
  step_ += dq;
  mean_.lambda += dlambda;
  set_mean();
}

void EnergyMomentum::finish(State& x) {
  end_.v = start_.v + h_ * mean_.a;
  follow_drives(!start_rate_.isZero(0));
  end_.a = mean_.a;
  end_.lambda = mean_.lambda;
  x = end_;
}

/// Corrects the velocities of driven joints, with the kept tangent as metric. Where 2 M / h²
/// dominates the tangent this is the projection in the mass norm; stiffer regions follow as in
/// statics. In both cases the momenta change only by the impulse of the joint forces.
void EnergyMomentum::follow_drives(bool was_driven) {
  model().constraints(end_, at_end_);
  if (!was_driven && at_end_.rate.isZero(0)) return;
  none_.setZero(model().n_dofs());
  // The kept Jacobian is at least half a step old; therefore each pass leaves O(h) of the residual.
  constexpr int kPasses = 6;
  for (int pass = 0; pass < kPasses; ++pass) {
    miss_ = -at_end_.rate;
    for (const auto& entry : at_end_.jacobian)
      miss_[entry.row()] -= entry.value() * end_.v[entry.col()];
    if (h_ * miss_.lpNorm<Eigen::Infinity>() <= 1e-15 * size()) return;
    solve_kept(none_, miss_, dv_, mu_);
    end_.v += dv_;
    mean_.lambda += mu_ / h_;
  }
}

}  // namespace flexmorph::fem
