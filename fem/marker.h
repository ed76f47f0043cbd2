#pragma once

#include <functional>
#include <span>
#include <string>
#include <vector>

#include "fem/joint.h"

namespace flexmorph::fem {

/// A place on a body, or on the ground, with axes: said by names, found in a model by a Marker.
struct MarkerPlace {
  std::string body{};  ///< empty: the ground
  Vec2 point{0, 0};    ///< rigid body, ground: in its axes; plate: material coordinates (m, n) [m]
  double angle = 0;    ///< of axis 1 in the axes of the body, counter-clockwise; no plates [rad]
  /// Shifts the point along axis 1 by this [m]; its rates are those of the value. Rigid bodies and
  /// ground only; empty: not at all.
  std::function<Motion(double t)> along{};
};

/// A marker at one state: p [m], then e [-].
struct MarkerMotion {
  Eigen::Vector4d y;           ///< (p, e)
  Eigen::Vector4d y_t;         ///< ∂y/∂t at fixed q
  Eigen::Vector4d rate;        ///< ẏ
  Eigen::Vector4d convective;  ///< ÿ at q̈ = 0
};

/// A place that was found in a model: position p and axis 1 e, both linear in the unknowns,
///
///   p = P(t) q + p₀(t),   e = E q + e₀            (the second axis is e turned by +90 degrees)
///
/// rigid body  p = r + X u + Y v, e = cos(angle) u + sin(angle) v, with (X, Y) moving along axis 1
/// ground      p = p₀(t), e = e₀: no unknowns
/// plate       p = Σ N_k q_k at a fixed material point; it has no axes
///
/// P has a time derivative where the point moves in its body (`along`), and only there.
class Marker {
 public:
  /// Entries of p, then of e, by the unknowns of dofs().
  using Block = Eigen::Matrix<double, 4, Eigen::Dynamic, 0, 4, 2 * kMaxShapes>;

  explicit Marker(MarkerPlace place) : place_(std::move(place)) {}

  /// Looks up the body; called again after every change of a mesh.
  /// @param user       begins messages: "joint 'hinge'", "link 'damper'"
  /// @param with_axis  will its axis be asked for?
  /// @throws Error (input) for a body that does not exist, that lives in space, for the axis or the
  ///         shift of a plate's point, for a point outside the plate or in an element whose
  ///         material lines move, and for numbers that are not finite.
  void bind(std::span<const BodyView> bodies, const std::string& user, bool with_axis);

  const MarkerPlace& place() const { return place_; }
  std::span<const int> dofs() const { return dofs_; }  ///< unknowns of the model, each once
  bool is_rigid() const { return rigid_; }  ///< is it on a rigid body (and not on the ground)?
  bool shifts() const { return static_cast<bool>(place_.along); }
  /// Can entry i (0, 1: of p; 2, 3: of e) depend on the unknown dofs()[k]?
  bool depends(int i, size_t k) const { return (depends_[k] >> i & 1U) != 0; }

  /// Where it is; puts the blocks at that time.
  MarkerMotion evaluate(double t, const VectorXd& q, const VectorXd& v) const;
  /// At the time of the last evaluate(): the blocks [P; E] and [Ṗ; 0], which is zero
  /// unless shifts().
  const Block& block() const { return block_; }
  const Block& block_rate() const { return block_rate_; }

 private:
  void bind_rigid(int first_dof);
  void bind_plate(const BodyView& body, const std::string& user, bool with_axis);
  void place_at(const Vec2& point, double position, Block& block, Eigen::Vector4d& offset) const;

  MarkerPlace place_;
  bool rigid_ = false;
  std::vector<int> dofs_;
  std::vector<unsigned> depends_;  // bits by entries
  mutable Block block_, block_rate_, block_acceleration_;
  mutable Eigen::Vector4d offset_, offset_rate_, offset_acceleration_;  // (p₀, e₀)
};

/// Two markers a and b side by side: y = (p_a, e_a, p_b, e_b) = Y(t) q + y₀(t).
class MarkerPair {
 public:
  using Values = Eigen::Matrix<double, 8, 1>;
  using Square = Eigen::Matrix<double, 8, 8>;
  /// First entries of the four vectors in y.
  enum Part { kPositionA = 0, kAxisA = 2, kPositionB = 4, kAxisB = 6 };

  MarkerPair(MarkerPlace a, MarkerPlace b) : a_(std::move(a)), b_(std::move(b)) {}

  /// @throws Error (input) as Marker::bind(), and for two places on the ground or on the same rigid
  ///         body.
  void bind(std::span<const BodyView> bodies, const std::string& user, bool axis_a, bool axis_b);
  const Marker& a() const { return a_; }
  const Marker& b() const { return b_; }

  /// Unknowns of a, then of b; one may be listed twice where both are on one body.
  std::span<const int> dofs() const { return dofs_; }
  /// Can y_i depend on the unknown dofs()[k]?
  bool depends(int i, size_t k) const;

  /// Evaluates what follows.
  void evaluate(double t, const VectorXd& q, const VectorXd& v) const;
  const Values& y() const { return y_; }
  const Values& y_t() const { return y_t_; }                ///< ∂y/∂t at fixed q
  const Values& rate() const { return rate_; }              ///< ẏ
  const Values& convective() const { return convective_; }  ///< ÿ at q̈ = 0

  /// Column k of Y and of its time derivative.
  Values column(size_t k) const;
  Values column_rate(size_t k) const;
  bool shifts() const { return a_.shifts() || b_.shifts(); }

 private:
  Marker a_, b_;
  std::vector<int> dofs_;
  mutable Values y_, y_t_, rate_, convective_;
};

}  // namespace flexmorph::fem
