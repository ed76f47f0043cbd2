#include "fem/dynamics/total_momentum.h"

namespace flexmorph::fem {
namespace {

/// Returns all vector unknowns rotated by 90 degrees; entries of scalar unknowns are zero.
VectorXd turning(const Model& model, const VectorXd& q) {
  VectorXd out = VectorXd::Zero(q.size());
  for (const Body& b : model.bodies()) {
    if (b.element->dim() != 2)
      throw Error::input("momentum of all bodies: '" + b.name + "' is not in the plane");
    for (int at = b.first_dof; at < b.first_scalar(); at += 2) {
      out[at] = -q[at + 1];
      out[at + 1] = q[at];
    }
  }
  return out;
}

/// Returns the kinetic energy at the velocities v. Elastic terms are skipped because they have
/// none.
double kinetic_energy(const Model& model, const State& x, const VectorXd& v) {
  double out = 0;
  Local local;
  for (const Body& b : model.bodies())
    for (int e = 0; e < b.element->n_elements(); ++e) {
      const auto vectors = b.element->vectors(e);
      for (LocalRows* rows : {&local.q, &local.v, &local.a})
        rows->setZero(static_cast<Eigen::Index>(vectors.size()), 2);
      for (size_t k = 0; k < vectors.size(); ++k) {
        const int at = b.first_dof + 2 * vectors[k];
        local.q.row(static_cast<Eigen::Index>(k)) = x.q.segment<2>(at);
        local.v.row(static_cast<Eigen::Index>(k)) = v.segment<2>(at);
      }
      for (const BodyTerm& term : b.terms)
        if (!term.elastic) out += term->kinetic_energy(e, local);
    }
  return out;
}

}  // namespace

TotalMomentum total_momentum(Workspace& model, const State& x) {
  TotalMomentum out;
  out.linear = model.momentum(x).head<2>();  // prepares the model
  const VectorXd w = turning(model, x.q);
  const double v = x.v.norm(), r = w.norm(), speed = v > 0 && r > 0 ? v / r : 1;
  out.angular =
      (kinetic_energy(model, x, x.v + speed * w) - kinetic_energy(model, x, x.v - speed * w)) /
      (2 * speed);
  return out;
}

}  // namespace flexmorph::fem
