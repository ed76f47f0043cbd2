#pragma once

#include <functional>

#include "fem/element.h"

namespace flexmorph::fem {

/// Reference values of one node of a beam.
struct BeamNode {
  Vec2 r{0, 0};               ///< Position X [m].
  Vec2 r_x{1, 0}, r_y{0, 1};  ///< Position gradients ∂X/∂x and ∂X/∂y [-].
};

/// Planar, shear-deformable, fully parameterized ANCF beam elements: two nodes with r, r_x, r_y.
///
///   r(x, y) = Σ_k s_k(ξ, η) q_k,   ξ = x/l, η = y/l                           T (A.1), (A.2)
///   s₁ = 1 - 3ξ² + 2ξ³,   s₂ = l (ξ - 2ξ² + ξ³),   s₃ = l η (1 - ξ)
///   s₄ = 3ξ² - 2ξ³,       s₅ = l (ξ³ - ξ²),        s₆ = l ξ η
///
/// x is the coordinate from the root [m] and y in [-h/2, h/2] the coordinate across the axis. They
/// are the material coordinates (m, n) of ShapeElement, and those of the straight beam. The
/// reference configuration X(x, y) has nodal values of its own; therefore it may be curved, tapered
/// or sheared. Its position gradients are J_o = ∂X/∂x. Tables contain
///
///   weight      dx dy det J_o              reference area [m²]
///   N_m, N_n    J_o⁻ᵀ (∂N/∂x, ∂N/∂y)       derivatives by the Cartesian reference coordinates X
///
/// Therefore (r_m r_n) is F = J J_o⁻¹, the identity in the reference configuration, and terms do
/// not need J_o. Only these tables use X; all other gradients, the unknowns NodeVectors::r_m, r_n,
/// are derivatives by x and y.
///
/// There are at most three quadrature points across the height (an elastic energy has degree 4 in
/// y), and one more where the reference is not straight, because J_o⁻¹ is rational there.
///
/// Beams have no scale factors of a design: tabulate() throws Error (input) for factors that are
/// not uniform.
///
/// Source: T, Shabana et al., appendix; Omar & Shabana (2001), J. Sound Vib. 243, 565-576.
class AncfBeam final : public Element, public ShapeElement {
 public:
  /// Creates a straight beam along the first axis, with the root at the origin and elements of
  /// equal length.
  /// @throws Error (input) unless length and height are positive and n_elements >= 1.
  AncfBeam(double length, double height, int n_elements);

  /// Creates a beam with given nodes and reference configuration.
  /// @param x          material coordinates of the nodes, increasing from x[0] [m]
  /// @param height     height h [m], which is multiplied by |r_y| of the reference
  /// @param reference  reference values, one per node; empty for a straight beam, r = (x, 0)
  /// @throws Error (input) unless there are at least two nodes, x increases, all numbers are finite
  /// and det J_o > 0 between y = -h/2 and h/2.
  AncfBeam(std::vector<double> x, double height, std::vector<BeamNode> reference = {});

  std::unique_ptr<Element> clone() const override { return std::make_unique<AncfBeam>(*this); }
  std::span<const int> vectors(int e) const override;
  double scale(int k) const override;
  bool is_position(int k) const override { return k % 3 == 0; }
  MatrixXd reference() const override { return reference_; }
  /// Returns one node: of "root", of "free_end", or of "line k" (node k).
  std::vector<NodeVectors> edge(const std::string& name) const override;
  std::vector<NodeVectors> nodes() const override;
  void tabulate(int e, int degree, Tabulate what, const ScaleFactors& factors, ScaleFactorKind kind,
                ShapeTable& out) const override;
  int locate(const Vec2& material, Tabulate what, ShapeTable& out) const override;

  std::array<std::vector<double>, 2> lines() const override {
    return {x_, {-0.5 * height_, 0.5 * height_}};
  }

  /// Returns the height h [m].
  double height() const { return height_; }
  /// Returns true if the reference configuration is straight.
  bool straight() const { return straight_; }

 private:
  double length(int e) const;
  void resize(Eigen::Index n_points, Tabulate what, ShapeTable& out) const;
  /// Fills row p of the tables at (ξ, y), with the weight 1 · det J_o.
  void fill(int e, double xi, double y, Eigen::Index p, ShapeTable& out) const;
  void check_reference() const;

  std::vector<double> x_;
  double height_;
  bool straight_;
  MatrixXd reference_;        // (n_vectors, 2)
  std::vector<int> vectors_;  // six numbers per element
};

/// A point of the centre line of a beam with the geometry of the section there.
struct CentreLine {
  Vec2 point{0, 0}, tangent{1, 0};  ///< Position [m], and its derivative by x [-].
  double height_ratio = 1;  ///< Length |r_y|: local height divided by the height h of the beam.
};

/// Returns the reference values at nodes x: r and r_x from the centre line, r_y normal to r_x.
/// @throws Error (input) for a tangent of length zero.
std::vector<BeamNode> curve_reference(const std::function<CentreLine(double x)>& curve,
                                      const std::vector<double>& x);

/// Returns the reference values of a circular arc with the given length of the axis [m] and angle
/// [rad]. It starts at the origin along the first axis and turns to the left for a positive angle.
/// The position gradients at the nodes x = length k / n_elements are unit vectors.
/// @throws Error (input) unless length is positive and n_elements >= 1.
std::vector<BeamNode> arc_reference(double length, double angle, int n_elements);

/// Returns the coordinates of n_elements + 1 nodes evenly spaced on [0, length] [m].
std::vector<double> uniform_nodes(double length, int n_elements);

}  // namespace flexmorph::fem
