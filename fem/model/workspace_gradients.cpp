#include "fem/model/workspace.h"

/// Derivatives of forces and of the strain energy by the scale factors of designs.
namespace flexmorph::fem {
namespace {

LocalRows rows_of(const Body& b, int e, const VectorXd& all) {
  const auto vectors = b.element->vectors(e);
  const int dim = b.element->dim();
  LocalRows out(static_cast<Eigen::Index>(vectors.size()), dim);
  for (Eigen::Index k = 0; k < out.rows(); ++k)
    out.row(k) = all.segment(b.first_dof + dim * vectors[static_cast<size_t>(k)], dim);
  return out;
}

}  // namespace

std::vector<ScaleFactorGradient> Workspace::zero_scale_factor_gradients() const {
  std::vector<ScaleFactorGradient> out(bodies_.size());
  for (size_t b = 0; b < out.size(); ++b)
    if (!bodies_[b].factors.uniform()) out[b].set_zero(bodies_[b].factors.stiffness.size());
  return out;
}

void Workspace::add_scale_factor_gradient(const State& x, const VectorXd& psi,
                                          std::vector<ScaleFactorGradient>& out) {
  prepare(x);
  Local local;
  for (size_t i = 0; i < bodies_.size(); ++i) {
    const Body& b = bodies_[i];
    if (b.factors.uniform()) continue;
    for (int e = 0; e < b.element->n_elements(); ++e) {
      gather(b, e, x, local);
      const LocalRows own = rows_of(b, e, psi);
      for (const BodyTerm& term : b.terms)
        if (term.designed) term.designed->add_scale_factor_gradient(e, local, own, out[i]);
    }
  }
}

void Workspace::add_strain_energy_gradient(const State& x, double weight, VectorXd& by_q,
                                           std::vector<ScaleFactorGradient>& d_factors) {
  prepare(x);
  Local local;
  for (size_t i = 0; i < bodies_.size(); ++i) {
    const Body& b = bodies_[i];
    const int dim = b.element->dim();
    for (const BodyTerm& term : b.terms) {
      if (!term.elastic) continue;
      for (int e = 0; e < b.element->n_elements(); ++e) {
        gather(b, e, x, local);
        LocalRows force = LocalRows::Zero(local.q.rows(), dim);
        term->add_force(e, local, force);
        const auto vectors = b.element->vectors(e);
        for (Eigen::Index k = 0; k < force.rows(); ++k)
          by_q.segment(b.first_dof + dim * vectors[static_cast<size_t>(k)], dim) +=
              weight * force.row(k);
        if (!b.factors.uniform()) term.elastic->add_energy_gradient(e, local, weight, d_factors[i]);
      }
    }
  }
}

VectorXd Workspace::constraint_curvature(const State& x, const VectorXd& lambda,
                                         const VectorXd& along) {
  prepare(x);
  State at;
  at.t = x.t;
  at.q = x.q;
  at.lambda = lambda;
  joint_stiffness(at, stiffness_);
  VectorXd out = VectorXd::Zero(n_dofs());
  for (const auto& entry : stiffness_) out[entry.row()] += entry.value() * along[entry.col()];
  return out;
}

}  // namespace flexmorph::fem
