#pragma once

#include <vector>

#include "geometry/component.h"
#include "geometry/grid.h"

namespace flexmorph::mmc {

/// Sizes that scale the parameters of components and bound them.
struct DesignScale {
  double half_length = 0.025;    ///< of the initial components [m]
  double min_thickness = 0.005;  ///< c_min, lower bound of c1, c2, c3 [m]
  double max_thickness = 0.03;   ///< upper bound of c1, c2, c3 [m]
};

/// Components <-> scaled design vector (7 per component, order of P (27)).
///
///   X0, Y0, L in 2 half_length (a component's size), θ in π, c1..c3 in half_length
///
/// so that a step of 0.05 is a cell or so in place and a twentieth of a component in shape:
/// scaled by the domain instead, one step would move a component by many cells (optim/README.md,
/// Components). Bounds: centres inside the domain, L up to eight times its start and never below
/// c_min (a component shorter than thick is a thin one the other way round), θ within a turn of its
/// start.
class Design {
 public:
  Design(const Grid& domain, std::vector<Component> start, const DesignScale& scale);

  /// The same domain and sizes with other components; bounds widen where they lie outside of them.
  Design with(std::vector<Component> components) const;

  double shortest() const;  ///< lower bound of a half-length [m]
  int n_components() const { return n_variables() / Component::kParameters; }
  int n_variables() const { return static_cast<int>(x_.size()); }
  const VectorXd& x() const { return x_; }
  const VectorXd& lower() const { return lower_; }
  const VectorXd& upper() const { return upper_; }
  const DesignScale& scale() const { return scale_; }

  /// Components of a design vector.
  void components(const VectorXd& x, std::vector<Component>& out) const;
  std::vector<Component> components() const;

  /// Gradient by parameters (7 N) -> gradient by x, in place.
  void scale_gradient(VectorXd& g) const;
  void scale_gradients(MatrixXd& rows) const;  ///< the same for rows of gradients (n x 7 N)

  /// Takes x as the design. @return largest |change| of a variable.
  double move_to(const VectorXd& x);

 private:
  Grid domain_;
  DesignScale scale_;
  VectorXd x_, lower_, upper_, unit_;  // unit: parameter per unit of x
};

}  // namespace flexmorph::mmc
