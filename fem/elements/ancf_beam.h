#pragma once

#include <functional>

#include "fem/element.h"

namespace flexmorph::fem {

/// Reference values of one node of a beam.
struct BeamNode {
  Vec2 r{0, 0};               ///< position X [m]
  Vec2 r_x{1, 0}, r_y{0, 1};  ///< ∂X/∂x, ∂X/∂y [-]
};

/// Planar, shear-deformable, fully parameterized ANCF beam elements: two nodes with r, r_x, r_y.
///
///   r(x, y) = Σ_k s_k(ξ, η) q_k,   ξ = x/l, η = y/l                           T (A.1), (A.2)
///   s₁ = 1 - 3ξ² + 2ξ³,   s₂ = l (ξ - 2ξ² + ξ³),   s₃ = l η (1 - ξ)
///   s₄ = 3ξ² - 2ξ³,       s₅ = l (ξ³ - ξ²),        s₆ = l ξ η
///
/// x from the root [m], y in [-h/2, h/2] across the axis: the material coordinates (m, n) of the
/// seam, those of the straight beam. The reference configuration X(x, y) has nodal values of its
/// own: it may be curved, tapered or sheared. Its position gradients are J_o = ∂X/∂x. Tables give
///
///   weight      dx dy det J_o              reference area [m²]
///   N_m, N_n    J_o⁻ᵀ (∂N/∂x, ∂N/∂y)       derivatives by the Cartesian reference coordinates X
///
/// so that (r_m r_n) is F = J J_o⁻¹, the identity in the reference, and terms need not know J_o.
/// But for these, gradients are by x and y: the unknowns themselves, NodeVectors::r_m, r_n.
///
/// The number of points across the height is three at most (an elastic energy has degree 4 in y),
/// one more where the reference is not straight: there J_o⁻¹ is rational.
///
/// Beams take no factors of a design: tabulate() throws Error (input) for factors that are not
/// uniform.
///
/// Source: T, Shabana et al., appendix; Omar & Shabana (2001), J. Sound Vib. 243, 565-576.
class AncfBeam final : public Element, public ShapeElement {
 public:
  /// A straight beam along the first axis, root at the origin, with elements of equal length.
  /// @throws Error (input) unless length and height are positive and n_elements >= 1.
  AncfBeam(double length, double height, int n_elements);

  /// @param x          of the nodes, increasing from x[0] [m]
  /// @param height     h [m], to be multiplied by |r_y| of the reference
  /// @param reference  a node each; empty: straight, r = (x, 0)
  /// @throws Error (input) unless two nodes at least, x increasing, all numbers finite and
  /// det J_o > 0 between y = -h/2 and h/2.
  AncfBeam(std::vector<double> x, double height, std::vector<BeamNode> reference = {});

  std::unique_ptr<Element> clone() const override { return std::make_unique<AncfBeam>(*this); }
  std::span<const int> vectors(int e) const override;
  double scale(int k) const override;
  bool is_position(int k) const override { return k % 3 == 0; }
  MatrixXd reference() const override { return reference_; }
  /// One node each: "root", "free_end", "line k" (node k).
  std::vector<NodeVectors> edge(const std::string& name) const override;
  std::vector<NodeVectors> nodes() const override;
  void tabulate(int e, int degree, Tabulate what, const Factors& factors, FactorKind kind,
                ShapeTable& out) const override;
  int locate(const Vec2& material, Tabulate what, ShapeTable& out) const override;

  std::array<std::vector<double>, 2> lines() const override {
    return {x_, {-0.5 * height_, 0.5 * height_}};
  }

  double height() const { return height_; }
  bool straight() const { return straight_; }

 private:
  double length(int e) const;
  void resize(Eigen::Index n_points, Tabulate what, ShapeTable& out) const;
  /// Row p at (ξ, y); weight 1 · det J_o.
  void fill(int e, double xi, double y, Eigen::Index p, ShapeTable& out) const;
  void check_reference() const;

  std::vector<double> x_;
  double height_;
  bool straight_;
  MatrixXd reference_;        // (n_vectors, 2)
  std::vector<int> vectors_;  // six numbers per element
};

/// Point of a centre line with its derivative by x there, and |r_y|: part of the beam's height.
struct CentreLine {
  Vec2 point{0, 0}, tangent{1, 0};
  double height_ratio = 1;
};

/// Reference values at nodes x: r and r_x as the centre line says, r_y at right angles to r_x.
/// @throws Error (input) for a tangent of no length.
std::vector<BeamNode> curve_reference(const std::function<CentreLine(double x)>& curve,
                                      const std::vector<double>& x);

/// Reference values of a circular arc of the given length of axis [m] through an angle [rad]: from
/// the origin along the first axis, to the left where the angle is positive; unit gradients at the
/// nodes, which are x = length k / n_elements.
/// @throws Error (input) unless length is positive and n_elements >= 1.
std::vector<BeamNode> arc_reference(double length, double angle, int n_elements);

/// n_elements + 1 nodes evenly spaced on [0, length].
std::vector<double> even_nodes(double length, int n_elements);

}  // namespace flexmorph::fem
