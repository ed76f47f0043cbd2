#pragma once

#include <functional>
#include <span>
#include <string>
#include <vector>

#include "fem/joint.h"

namespace flexmorph::fem {

/// A location on a body, or on the ground, with axes; it is given by names and looked up in a model
/// by a Marker.
struct MarkerLocation {
  std::string body{};  ///< Name of the body; empty for the ground.

  /// Coordinates in the axes of a rigid body or of the ground, or material coordinates (m, n) of a
  /// plate [m].
  Vec2 point{0, 0};
  /// Angle of axis 1 in the axes of the body, counter-clockwise [rad]; zero for plates.
  double angle = 0;
  /// Displacement of the point along axis 1 as a function of time, with its rates [m]; only for
  /// rigid bodies and the ground. Empty for a fixed point.
  std::function<Motion(double t)> along{};
};

/// Motion of a marker at one state: position p [m], then axis 1 e [-].
struct MarkerMotion {
  Eigen::Vector4d y;           ///< Values (p, e).
  Eigen::Vector4d y_t;         ///< Partial derivatives ∂y/∂t at fixed q.
  Eigen::Vector4d rate;        ///< Total rates ẏ.
  Eigen::Vector4d convective;  ///< Accelerations ÿ for q̈ = 0.
};

/// A location that was looked up in a model: position p and axis 1 e, both linear in the unknowns,
///
///   p = P(t) q + p₀(t),   e = E q + e₀            (the second axis is e turned by +90 degrees)
///
/// rigid body  p = r + X u + Y v, e = cos(angle) u + sin(angle) v, with (X, Y) moving along axis 1
/// ground      p = p₀(t), e = e₀: no unknowns
/// plate       p = Σ N_k q_k at a fixed material point; it has no axes
///
/// P depends on time only where the point moves in its body (`along`).
class Marker {
 public:
  /// Matrix of the coefficients of (p, e), one column per unknown of dofs().
  using Block = Eigen::Matrix<double, 4, Eigen::Dynamic, 0, 4, 2 * kMaxShapes>;

  /// Creates a marker for a location; call bind() before it is evaluated.
  explicit Marker(MarkerLocation location) : location_(std::move(location)) {}

  /// Looks up the body; it is called again after every change of a mesh.
  /// @param user       first words of messages: "joint 'hinge'", "link 'damper'"
  /// @param with_axis  true if the axis is needed
  /// @throws Error (input) for a body that does not exist or is in space, for the axis or the shift
  /// of a point of a plate, for a point outside the plate or in an element whose material lines
  /// move, and for numbers that are not finite.
  void bind(std::span<const BodyView> bodies, const std::string& user, bool with_axis);

  /// Returns the location as it was given.
  const MarkerLocation& location() const { return location_; }
  /// Returns the unknowns of the model that the marker depends on, each once.
  std::span<const int> dofs() const { return dofs_; }
  /// Returns true if the marker is on a rigid body (and not on the ground).
  bool is_rigid() const { return rigid_; }
  /// Returns true if the point moves in its body.
  bool shifts() const { return static_cast<bool>(location_.along); }
  /// Returns true if entry i (0, 1: of p; 2, 3: of e) can depend on the unknown dofs()[k].
  bool depends(int i, size_t k) const { return (depends_[k] >> i & 1U) != 0; }

  /// Returns the motion of the marker at a state, and updates block() and block_rate() to time t.
  MarkerMotion evaluate(double t, const VectorXd& q, const VectorXd& v) const;
  /// Returns the coefficients [P; E] at the time of the last evaluate().
  const Block& block() const { return block_; }
  /// Returns the rates [Ṗ; 0] at the time of the last evaluate(); zero unless shifts().
  const Block& block_rate() const { return block_rate_; }

 private:
  void bind_rigid(int first_dof);
  void bind_plate(const BodyView& body, const std::string& user, bool with_axis);
  void location_at(const Vec2& point, double position, Block& block, Eigen::Vector4d& offset) const;

  MarkerLocation location_;
  bool rigid_ = false;
  std::vector<int> dofs_;
  std::vector<unsigned> depends_;  // one bit per entry of (p, e), for each unknown
  mutable Block block_, block_rate_, block_acceleration_;
  mutable Eigen::Vector4d offset_, offset_rate_, offset_acceleration_;  // (p₀, e₀)
};

/// Two markers a and b with their common value vector y = (p_a, e_a, p_b, e_b) = Y(t) q + y₀(t).
class MarkerPair {
 public:
  /// Vector of the entries of y.
  using Values = Eigen::Matrix<double, 8, 1>;
  /// Matrix of second derivatives by y.
  using Square = Eigen::Matrix<double, 8, 8>;
  /// First entries of the four vectors in y.
  enum Part { kPositionA = 0, kAxisA = 2, kPositionB = 4, kAxisB = 6 };

  /// Creates the pair of two locations; call bind() before it is evaluated.
  MarkerPair(MarkerLocation a, MarkerLocation b) : a_(std::move(a)), b_(std::move(b)) {}

  /// Looks up both bodies, see Marker::bind().
  /// @throws Error (input) as Marker::bind(), and for two locations on the ground or on the same
  /// rigid body.
  void bind(std::span<const BodyView> bodies, const std::string& user, bool axis_a, bool axis_b);
  /// Returns the first marker.
  const Marker& a() const { return a_; }
  /// Returns the second marker.
  const Marker& b() const { return b_; }

  /// Returns the unknowns of a, then the unknowns of b; an unknown is listed twice where both
  /// markers are on one body.
  std::span<const int> dofs() const { return dofs_; }
  /// Returns true if y_i can depend on the unknown dofs()[k].
  bool depends(int i, size_t k) const;

  /// Evaluates the values that the functions below return.
  void evaluate(double t, const VectorXd& q, const VectorXd& v) const;
  /// Returns the values y at the last evaluate().
  const Values& y() const { return y_; }
  /// Returns the partial derivatives ∂y/∂t at fixed q.
  const Values& y_t() const { return y_t_; }
  /// Returns the total rates ẏ.
  const Values& rate() const { return rate_; }
  /// Returns the accelerations ÿ for q̈ = 0.
  const Values& convective() const { return convective_; }

  /// Returns column k of the matrix Y = ∂y/∂q.
  Values column(size_t k) const;
  /// Returns column k of the time derivative of the matrix Y = ∂y/∂q.
  Values column_rate(size_t k) const;
  /// Returns true if at least one of the points moves in its body.
  bool shifts() const { return a_.shifts() || b_.shifts(); }

 private:
  Marker a_, b_;
  std::vector<int> dofs_;
  mutable Values y_, y_t_, rate_, convective_;
};

}  // namespace flexmorph::fem
