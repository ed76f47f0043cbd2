#include "fem/model/model_link.h"

namespace flexmorph::fem {

ModelLink::ModelLink(std::unique_ptr<Link> l)
    : link(std::move(l)),
      mean(dynamic_cast<const MeanForceLink*>(link.get())),
      turning(dynamic_cast<TurningLink*>(link.get())),
      scaled(dynamic_cast<ScaledLoad*>(link.get())) {}

const MeanForceLink& ModelLink::with_mean_force() const {
  if (!mean) refuse_mean_force(link->name());
  return *mean;
}

}  // namespace flexmorph::fem
