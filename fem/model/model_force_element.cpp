#include "fem/model/model_force_element.h"

namespace flexmorph::fem {

ModelForceElement::ModelForceElement(std::unique_ptr<ForceElement> l)
    : force_element(std::move(l)),
      mean(dynamic_cast<const MeanForceElement*>(force_element.get())),
      turning(dynamic_cast<TurningForceElement*>(force_element.get())),
      scaled(dynamic_cast<ScaledLoad*>(force_element.get())) {}

const MeanForceElement& ModelForceElement::with_mean_force() const {
  if (!mean) refuse_mean_force(force_element->name());
  return *mean;
}

}  // namespace flexmorph::fem
