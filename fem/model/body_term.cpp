#include "fem/model/body_term.h"

namespace flexmorph::fem {
BodyTerm::BodyTerm(std::unique_ptr<Term> t)
    : term(std::move(t)),
      batch(dynamic_cast<const BatchTerm*>(term.get())),
      mean(dynamic_cast<const MeanForceTerm*>(term.get())),
      free_lines(dynamic_cast<const FreeLineTerm*>(term.get())),
      designed(dynamic_cast<const DesignedTerm*>(term.get())),
      elastic(dynamic_cast<const ElasticEnergy*>(term.get())),
      flow(dynamic_cast<const FlowTerm*>(term.get())),
      scaled(dynamic_cast<ScaledLoad*>(term.get())),
      load(dynamic_cast<LoadTerm*>(term.get())),
      strain(dynamic_cast<StrainTerm*>(term.get())),
      heated(dynamic_cast<HeatedTerm*>(term.get())) {}

void BodyTerm::add_forces(const Batch& x, Lanes* force) const {
  if (batch) return batch->add_forces(x, force);
  for (int lane = 0; lane < x.count; ++lane) add_force_of_lane(*term, x, lane, force);
}

void BodyTerm::add_tangents(const Batch& x, const Weights& w, Lanes* tangent) const {
  if (batch) return batch->add_tangents(x, w, tangent);
  for (int lane = 0; lane < x.count; ++lane) add_tangent_of_lane(*term, x, lane, w, tangent);
}

const FreeLineTerm& BodyTerm::with_free_lines() const {
  if (!free_lines)
    throw Error::input("the term '" + term->name() + "' does not know free material lines");
  return *free_lines;
}

const MeanForceTerm& BodyTerm::with_mean_force() const {
  if (!mean)
    throw Error::input("the term '" + term->name() +
                       "' has no mean force: integrator \"energy_momentum\" cannot take it, "
                       "\"generalized_alpha\" can");
  return *mean;
}

}  // namespace flexmorph::fem
