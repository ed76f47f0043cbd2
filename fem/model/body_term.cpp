#include "fem/model/body_term.h"

namespace flexmorph::fem {
BodyTerm::BodyTerm(std::unique_ptr<Term> t)
    : term(std::move(t)),
      batch(dynamic_cast<const BatchTerm*>(term.get())),
      mean(dynamic_cast<const MeanForceTerm*>(term.get())),
      eulerian_lines(dynamic_cast<const EulerianLineTerm*>(term.get())),
      designed(dynamic_cast<const DesignedTerm*>(term.get())),
      elastic(dynamic_cast<const ElasticEnergy*>(term.get())),
      flow(dynamic_cast<const FlowTerm*>(term.get())),
      dissipative(dynamic_cast<const DissipativeTerm*>(term.get())),
      scaled(dynamic_cast<ScaledLoad*>(term.get())),
      load(dynamic_cast<LoadTerm*>(term.get())),
      strain(dynamic_cast<StrainTerm*>(term.get())),
      heated(dynamic_cast<HeatedTerm*>(term.get())) {}

void BodyTerm::add_forces(const Batch& x, Pack* force) const {
  if (batch) return batch->add_forces(x, force);
  for (int lane = 0; lane < x.count; ++lane) add_force_of_lane(*term, x, lane, force);
}

void BodyTerm::add_tangents(const Batch& x, const Weights& w, Pack* tangent) const {
  if (batch) return batch->add_tangents(x, w, tangent);
  for (int lane = 0; lane < x.count; ++lane) add_tangent_of_lane(*term, x, lane, w, tangent);
}

const EulerianLineTerm& BodyTerm::with_eulerian_lines() const {
  if (!eulerian_lines)
    throw Error::input("the term '" + term->name() + "' does not support free material lines");
  return *eulerian_lines;
}

const MeanForceTerm& BodyTerm::with_mean_force() const {
  if (!mean)
    throw Error::input(
        "the term '" + term->name() +
        "' does not support integrator \"energy_momentum\"; use \"generalized_alpha\"");
  return *mean;
}

}  // namespace flexmorph::fem
