#pragma once

#include <Eigen/SparseCore>
#include <optional>
#include <string>
#include <vector>

#include "geometry/components/component.h"
#include "geometry/grid.h"

namespace flexmorph::mmc {

/// Sizes that scale and bound the parameters of components.
struct DesignScale {
  double half_length = 0.025;    ///< Half-length of the initial components [m].
  double min_thickness = 0.005;  ///< Lower bound c_min of c1, c2, c3 [m].
  double max_thickness = 0.03;   ///< Upper bound of c1, c2, c3 [m].
};

/// The symmetry lines of a design, which is its own mirror image in each of them.
struct Symmetry {
  /// Coordinate x of the vertical line and coordinate y of the horizontal line [m]; absent if there
  /// is no such line.
  std::optional<double> x, y;
  /// Returns true if there is a symmetry line.
  bool any() const { return x || y; }
};

/// Returns "x", "y", "both" or "none": the values of `design.symmetry`.
std::string to_string(const Symmetry& symmetry);

/// Returns the components on the lower (left) side of the symmetry lines. A component on the
/// opposite side is replaced by its mirror image. Of two components that are mirror images of each
/// other one is returned.
std::vector<Component> one_side(const std::vector<Component>& all, const Symmetry& symmetry);

/// Returns true if the mirror images of all components are components of the list, too.
bool is_symmetric(const std::vector<Component>& all, const Symmetry& symmetry);

/// The design variables: components as a scaled vector x (7 entries per component, order of P
/// (27)).
///
///   X0, Y0, L in 2 half_length (a component's size), θ in π, c1..c3 in half_length
///
/// With this scaling a step of 0.05 moves a component by about one cell and changes its shape by a
/// twentieth. If the domain were the unit instead, one step would move a component by many cells
/// (optim/README.md, Components). Bounds: centres stay inside the domain; L is at most eight times
/// the initial half-length and never below c_min (a component that is shorter than thick is a thin
/// one with its axis turned by 90 degrees); θ stays within 2 π of its start.
///
/// A symmetric design has variables for the components of one side only. The mirror images follow
/// them in the list of components, in unchanged order.
class Design {
 public:
  /// Creates the design of the components one_side(start).
  /// @param start  initial components; those on the opposite side of a symmetry line are mirrored
  Design(const Grid& domain, const std::vector<Component>& start, const DesignScale& scale,
         const Symmetry& symmetry = {});

  /// Returns a design of other components with equal domain, sizes and symmetry. Bounds that the
  /// components violate are widened.
  Design with(const std::vector<Component>& components) const;
  /// Returns the symmetry lines of the design.
  const Symmetry& symmetry() const { return symmetry_; }

  /// Returns the lower bound of half-lengths [m].
  double shortest() const;
  /// Returns the number of components N, mirror images included.
  int n_components() const {
    return static_cast<int>(to_parameters_.rows()) / Component::kParameters;
  }
  /// Returns the number of copies of each component, itself included: 1, 2 or 4.
  size_t n_images() const {
    return static_cast<size_t>((symmetry_.x ? 2 : 1) * (symmetry_.y ? 2 : 1));
  }
  /// Returns the number of design variables.
  int n_variables() const { return static_cast<int>(x_.size()); }
  /// Returns the current design vector (n_variables) [-].
  const VectorXd& x() const { return x_; }
  /// Returns the lower bounds of the design vector (n_variables) [-].
  const VectorXd& lower() const { return lower_; }
  /// Returns the upper bounds of the design vector (n_variables) [-].
  const VectorXd& upper() const { return upper_; }
  /// Returns the sizes that scale and bound the variables.
  const DesignScale& scale() const { return scale_; }

  /// Computes the components of a design vector, mirror images included.
  void components(const VectorXd& x, std::vector<Component>& out) const;
  /// Returns the components of the current design vector, mirror images included.
  std::vector<Component> components() const;

  /// Converts a gradient by component parameters (7 N) into the gradient by x, in place. Its length
  /// changes where there are mirror images.
  void scale_gradient(VectorXd& g) const;
  /// Converts rows of gradients by component parameters (n x 7 N) into rows by x, in place.
  void scale_gradients(MatrixXd& rows) const;

  /// Sets the current design vector to x.
  /// @returns the largest |change| of a variable
  double move_to(const VectorXd& x);

 private:
  void add_images(Eigen::Index n, const VectorXd& unit);

  Grid domain_;
  DesignScale scale_;
  Symmetry symmetry_;
  VectorXd x_, lower_, upper_;
  Eigen::SparseMatrix<double> to_parameters_;  // 7 N x variables
  VectorXd offset_;                            // parameters at x = 0
};

}  // namespace flexmorph::mmc
