#pragma once

#include <utility>

#include "fem/marker.h"

namespace flexmorph::fem {

/// One constraint row f(y, t) of y = (p_a, e_a, p_b, e_b), with its derivatives.
struct PairRow {
  /// Vector of the entries of y.
  using Values = MarkerPair::Values;
  double f = 0, f_t = 0, f_tt = 0;  ///< Value f, and partial derivatives ∂f/∂t and ∂²f/∂t².

  /// Gradient ∂f/∂y, and its partial derivative by t.
  Values f_y = Values::Zero(), f_yt = Values::Zero();
  MarkerPair::Square f_yy = MarkerPair::Square::Zero();  ///< Second derivatives ∂²f/∂y².
};

/// A joint whose rows are functions of two markers, y = Y(t) q + y₀(t):
///
///   Φ = f(y, t),   Φ_q = f_yᵀ Y,   Φ_t = f_t + f_y · y_t
///   right side of the acceleration = -(ẏᵀ f_yy ẏ + 2 f_yt · ẏ + f_tt + f_y · ÿ|q̈=0)
///   (Φ_qᵀ λ)_q = Yᵀ (Σ λ f_yy) Y
class PairJoint : public Joint {
 public:
  std::string name() const override { return name_; }
  int size() const override { return static_cast<int>(rows_.size()); }
  void bind(std::span<const BodyView> bodies) override;
  void evaluate(double t, const VectorXd& q, const VectorXd& v,
                ConstraintRows& rows) const override;
  void add_stiffness(double t, const VectorXd& q, const VectorXd& lambda,
                     std::vector<Eigen::Triplet<double>>& out) const override;

 protected:
  /// Vector of the entries of y.
  using Values = MarkerPair::Values;
  /// First entry of one of the four vectors in y.
  using Part = MarkerPair::Part;

  /// Structure of the rows.
  struct Shape {
    std::vector<unsigned> reads;  ///< Entries of y that each row depends on, as bits (size()).

    /// Pairs of vectors in y between which the rows have second derivatives.
    std::vector<std::pair<Part, Part>> couples{};
  };
  /// Returns the bits of the entries of the given vectors in y.
  static unsigned bits(std::initializer_list<Part> parts);

  /// Creates a joint with the given structure of its rows.
  PairJoint(std::string name, MarkerLocation a, MarkerLocation b, Shape shape);

  /// Fills the rows at (y, t). Entries that the function never sets are zero.
  virtual void fill(double t, const Values& y, std::vector<PairRow>& rows) const = 0;

 private:
  std::string name_;
  MarkerPair pair_;
  Shape shape_;
  struct Entry {
    int row;
    size_t column;  // of dofs()
  };
  std::vector<Entry> entries_;                      // of Φ_q
  std::vector<std::pair<size_t, size_t>> coupled_;  // of (Φ_qᵀ λ)_q, columns of dofs()
  mutable std::vector<PairRow> rows_;
};

}  // namespace flexmorph::fem
