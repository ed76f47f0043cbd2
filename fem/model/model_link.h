#pragma once

#include <memory>

#include "fem/link.h"

namespace flexmorph::fem {

/// A force element of a model, and what it can do besides: asked for once, when it is added.
struct ModelLink {
  explicit ModelLink(std::unique_ptr<Link> link);

  Link* operator->() const { return link.get(); }
  Link& operator*() const { return *link; }
  /// Tells whether it follows an angle over whole turns.
  bool counts_turns() const { return turning != nullptr && turning->counts_turns(); }
  /// Returns it as one with a mean force. @throws Error (input) where it has none
  const MeanForceLink& with_mean_force() const;

  std::unique_ptr<Link> link;
  // The force element as what it is besides, null where it is not.
  const MeanForceLink* mean;
  TurningLink* turning;
  ScaledLoad* scaled;
};

}  // namespace flexmorph::fem
