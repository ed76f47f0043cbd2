#pragma once

#include <span>

#include "geometry/components/component.h"

namespace flexmorph::mmc {

/// What the outline of a design says without a state: how much it encloses, and constraints g <= 0.
class ShapeLimits {
 public:
  struct Values {
    double volume = 0;  ///< of the crisp design, a part of the domain [-]
    VectorXd g;         ///< (count)
    MatrixXd dg;        ///< by the parameters of components (count x 7 N)
  };

  virtual ~ShapeLimits() = default;
  virtual int count() const = 0;
  /// @throws Error (numerical) where the outlines cannot be united.
  virtual void evaluate(std::span<const Component> components, Values& out) = 0;
};

}  // namespace flexmorph::mmc
