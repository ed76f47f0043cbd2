#pragma once

#include "fem/force_element.h"

namespace flexmorph::fem {

/// A generalized force on y = (p_a, e_a, p_b, e_b) of two markers, and its derivatives.
struct PairForce {
  /// Vector of the entries of y.
  using Values = MarkerPair::Values;
  /// Force s with the virtual work s · δy, on the left side of M q̈ + F = 0.
  Values s = Values::Zero();
  Values conservative = Values::Zero();  ///< Component of s that is the derivative of an energy.

  /// Derivatives ∂s/∂y and ∂s/∂ẏ.
  MarkerPair::Square s_y = MarkerPair::Square::Zero(), s_rate = MarkerPair::Square::Zero();
};

/// A force element whose force depends on two markers, y = Y(t) q + y₀(t):
///
///   f = Yᵀ s(y, ẏ),   f_q = Yᵀ (s_y Y + s_ẏ Ẏ),   f_v = Yᵀ s_ẏ Y
///   power that enters the model: s · y_t - (s - conservative) · ẏ
class PairForceElement : public ForceElement {
 public:
  std::string name() const override { return name_; }
  void bind(std::span<const BodyView> bodies) override;
  void add_force(const State& x, VectorXd& out) const override;
  void add_pattern(std::vector<Eigen::Triplet<double>>& out) const override;
  void add_tangent(const State& x, const Weights& w,
                   std::vector<Eigen::Triplet<double>>& out) const override;
  double power(const State& x) const override;

 protected:
  /// Vector of the entries of y.
  using Values = MarkerPair::Values;
  /// First entry of one of the four vectors in y.
  using Part = MarkerPair::Part;

  /// Creates a force element between two markers.
  /// @param parts   vectors of y on which the force does work
  /// @param varies  true if the force depends on the state
  PairForceElement(std::string name, MarkerLocation a, MarkerLocation b, std::vector<Part> parts,
                   bool varies);

  /// Fills the force at a state in which the markers are at (y, ẏ); all entries of `out` are zero
  /// before.
  virtual void fill(const State& x, const Values& y, const Values& rate, PairForce& out) const = 0;

  /// Returns the two markers.
  const MarkerPair& pair() const { return pair_; }
  /// Adds Yᵀ s with the Y of the last pair().evaluate().
  void add_to(const Values& s, VectorXd& out) const;
  /// Appends Yᵀ (by_y Y + by_rate Ẏ) with the Y of the last pair().evaluate(), at the positions of
  /// add_pattern().
  void append(const MarkerPair::Square& by_y, const MarkerPair::Square& by_rate,
              std::vector<Eigen::Triplet<double>>& out) const;

 private:
  std::string name_;
  MarkerPair pair_;
  std::vector<Part> parts_;
  bool varies_;
  std::vector<size_t> columns_;  // of dofs() on which the force works
};

}  // namespace flexmorph::fem
