#pragma once

#include <memory>

#include "fem/link.h"

namespace flexmorph::fem {

/// A force element of a model with the interfaces that its class has, which are looked up once,
/// when the force element is added.
struct ModelLink {
  /// Creates the entry of a force element.
  explicit ModelLink(std::unique_ptr<Link> link);

  /// Returns a pointer to the force element.
  Link* operator->() const { return link.get(); }
  /// Returns a reference to the force element itself.
  Link& operator*() const { return *link; }
  /// Returns true if the force element counts an angle over whole turns.
  bool counts_turns() const { return turning != nullptr && turning->counts_turns(); }
  /// Returns the interface for a mean force.
  /// @throws Error (input) where the force element has none
  const MeanForceLink& with_mean_force() const;

  std::unique_ptr<Link> link;  ///< The force element itself.
  // Interfaces of the force element, null where its class lacks the interface.
  const MeanForceLink* mean;  ///< Mean force of a step.
  TurningLink* turning;       ///< Counting of an angle over whole turns.
  ScaledLoad* scaled;         ///< Load factor.
};

}  // namespace flexmorph::fem
