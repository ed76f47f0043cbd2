#pragma once

#include <span>

#include "geometry/component.h"

namespace flexmorph::mmc {

/// Constraints g <= 0 of the shape of a design alone: no state is solved for them.
class ShapeLimits {
 public:
  virtual ~ShapeLimits() = default;
  virtual int count() const = 0;
  /// @param g   (count)
  /// @param dg  by the parameters of components (count x 7 N)
  virtual void evaluate(std::span<const Component> components, VectorXd& g, MatrixXd& dg) = 0;
};

}  // namespace flexmorph::mmc
