#pragma once

#include <Eigen/SparseCore>
#include <optional>
#include <string>
#include <vector>

#include "geometry/components/component.h"
#include "geometry/grid.h"

namespace flexmorph::mmc {

/// Sizes that scale the parameters of components and bound them.
struct DesignScale {
  double half_length = 0.025;    ///< of the initial components [m]
  double min_thickness = 0.005;  ///< c_min, lower bound of c1, c2, c3 [m]
  double max_thickness = 0.03;   ///< upper bound of c1, c2, c3 [m]
};

/// Lines that a design is its own mirror image in.
struct Symmetry {
  std::optional<double> x, y;  ///< of the vertical line, of the horizontal one [m]
  bool any() const { return x || y; }
};

/// "x", "y", "both" or "none": the values of `design.symmetry`.
std::string to_string(const Symmetry& symmetry);

/// The components of the lower (left) side; what lies on the other one is taken for an image. Of
/// two that are one another's images there is one.
std::vector<Component> one_side(const std::vector<Component>& all, const Symmetry& symmetry);

/// Is the image of every component one of them?
bool is_symmetric(const std::vector<Component>& all, const Symmetry& symmetry);

/// Components <-> scaled design vector (7 per component, order of P (27)).
///
///   X0, Y0, L in 2 half_length (a component's size), θ in π, c1..c3 in half_length
///
/// so that a step of 0.05 is a cell or so in place and a twentieth of a component in shape:
/// scaled by the domain instead, one step would move a component by many cells (optim/README.md,
/// Components). Bounds: centres inside the domain, L up to eight times its start and never below
/// c_min (a component shorter than thick is a thin one the other way round), θ within a turn of its
/// start.
///
/// A symmetric design has variables of the components of one side only; the others are their images
/// and follow them in the list, in the same order.
class Design {
 public:
  /// @param start  one_side() of it
  Design(const Grid& domain, const std::vector<Component>& start, const DesignScale& scale,
         const Symmetry& symmetry = {});

  /// The same domain, sizes and symmetry with other components; bounds widen where they lie outside
  /// of them.
  Design with(const std::vector<Component>& components) const;
  const Symmetry& symmetry() const { return symmetry_; }

  double shortest() const;  ///< lower bound of a half-length [m]
  /// Images included.
  int n_components() const {
    return static_cast<int>(to_parameters_.rows()) / Component::kParameters;
  }
  size_t n_images() const {
    return static_cast<size_t>((symmetry_.x ? 2 : 1) * (symmetry_.y ? 2 : 1));
  }
  int n_variables() const { return static_cast<int>(x_.size()); }
  const VectorXd& x() const { return x_; }
  const VectorXd& lower() const { return lower_; }
  const VectorXd& upper() const { return upper_; }
  const DesignScale& scale() const { return scale_; }

  /// Components of a design vector.
  void components(const VectorXd& x, std::vector<Component>& out) const;
  std::vector<Component> components() const;

  /// Gradient by parameters (7 N) -> gradient by x, in place, of another length where there are
  /// images.
  void scale_gradient(VectorXd& g) const;
  void scale_gradients(MatrixXd& rows) const;  ///< the same for rows of gradients (n x 7 N)

  /// Takes x as the design. @return largest |change| of a variable.
  double move_to(const VectorXd& x);

 private:
  void add_images(Eigen::Index n, const VectorXd& unit);

  Grid domain_;
  DesignScale scale_;
  Symmetry symmetry_;
  VectorXd x_, lower_, upper_;
  Eigen::SparseMatrix<double> to_parameters_;  // 7 N x variables
  VectorXd offset_;                            // parameters of x = 0
};

}  // namespace flexmorph::mmc
