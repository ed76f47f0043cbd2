#pragma once

#include <span>

#include "geometry/components/component.h"

namespace flexmorph::mmc {

/// Constraints on the outline of a design, which need no state, and the volume that it encloses.
class ShapeLimits {
 public:
  /// The volume and the constraints of one design.
  struct Values {
    double volume = 0;  ///< Volume fraction of the crisp design in the domain [-].
    VectorXd g;         ///< Constraints g <= 0 (count).
    MatrixXd dg;        ///< Derivatives of g by the component parameters (count x 7 N).
  };

  virtual ~ShapeLimits() = default;
  /// Returns the number of constraints.
  virtual int count() const = 0;
  /// Computes the volume and the constraints of a design.
  /// @throws Error (numerical) where the outlines cannot be united.
  virtual void evaluate(std::span<const Component> components, Values& out) = 0;
};

}  // namespace flexmorph::mmc
