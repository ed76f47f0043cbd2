#pragma once

#include "fem/link.h"

namespace flexmorph::fem {

/// A force on y = (p_a, e_a, p_b, e_b) of two markers, and its derivatives.
struct PairForce {
  using Values = MarkerPair::Values;
  Values s = Values::Zero();       ///< work on δy, on the left side
  Values stored = Values::Zero();  ///< its part that is the derivative of an energy
  MarkerPair::Square s_y = MarkerPair::Square::Zero(), s_rate = MarkerPair::Square::Zero();
};

/// A link whose force depends on two markers, y = Y(t) q + y₀(t):
///
///   f = Yᵀ s(y, ẏ),   f_q = Yᵀ (s_y Y + s_ẏ Ẏ),   f_v = Yᵀ s_ẏ Y
///   power that enters: s · y_t - (s - stored) · ẏ
class PairLink : public Link {
 public:
  std::string name() const override { return name_; }
  void bind(std::span<const BodyView> bodies) override;
  void add_force(const State& x, VectorXd& out) const override;
  void add_pattern(std::vector<Eigen::Triplet<double>>& out) const override;
  void add_tangent(const State& x, const Weights& w,
                   std::vector<Eigen::Triplet<double>>& out) const override;
  double power(const State& x) const override;

 protected:
  using Values = MarkerPair::Values;
  using Part = MarkerPair::Part;

  /// @param parts   of y that the force works on
  /// @param varies  does the force depend on the state?
  PairLink(std::string name, MarkerPlace a, MarkerPlace b, std::vector<Part> parts, bool varies);

  /// The force at a state, where the markers are at (y, ẏ), into a PairForce that is zero.
  virtual void fill(const State& x, const Values& y, const Values& rate, PairForce& out) const = 0;

  const MarkerPair& pair() const { return pair_; }
  /// Adds Yᵀ s as the last pair().evaluate() found Y.
  void add_to(const Values& s, VectorXd& out) const;
  /// Appends Yᵀ (by_y Y + by_rate Ẏ) likewise, at the places of add_pattern().
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
