#pragma once

#include <memory>

#include "fem/force_element.h"

namespace flexmorph::fem {

/// A force element of a model with the interfaces that its class has, which are looked up once,
/// when the force element is added.
struct ModelForceElement {
  /// Creates the entry of a force element.
  explicit ModelForceElement(std::unique_ptr<ForceElement> force_element);

  /// Returns a pointer to the force element.
  ForceElement* operator->() const { return force_element.get(); }
  /// Returns a reference to the force element itself.
  ForceElement& operator*() const { return *force_element; }
  /// Returns true if the force element counts an angle over whole turns.
  bool counts_turns() const { return turning != nullptr && turning->counts_turns(); }
  /// Returns the interface for a mean force.
  /// @throws Error (input) where the force element has none
  const MeanForceElement& with_mean_force() const;

  std::unique_ptr<ForceElement> force_element;  ///< The force element itself.
  // Interfaces of the force element, null where its class lacks the interface.
  const MeanForceElement* mean;  ///< Mean force of a step.
  TurningForceElement* turning;  ///< Counting of an angle over whole turns.
  ScaledLoad* scaled;            ///< Load factor.
};

}  // namespace flexmorph::fem
