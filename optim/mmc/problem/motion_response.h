#pragma once

#include <span>
#include <vector>

#include "optim/mmc/problem/goal.h"
#include "optim/mmc/problem/response.h"

namespace flexmorph::mmc {

/// A response of the motion of a mechanism for one of its designed bodies.
struct MotionRow {
  const ResponseRow* row = nullptr;  ///< Row of the table of responses.
  size_t body = 0;                   ///< Index of the designed body.
  double weight = 1;                 ///< Weight of the response in the objective, which is a sum.

  /// Returns true if both have equal values. The body matters only for responses that belong to one
  /// body (ResponseRow::of_body).
  bool same_as(const MotionRow& other) const {
    return row == other.row && (body == other.body || !row->of_body);
  }
};

/// Returns the responses that the goals of all designed bodies minimize, each once. The objective J
/// is their weighted sum.
std::vector<MotionRow> motion_objectives(std::span<const Goal* const> goals);

/// The interface between design problems and the motion of a mechanism.
class MotionResponse {
 public:
  virtual ~MotionResponse() = default;

  /// The value of a response and its derivatives.
  struct Value {
    double f = 0;  ///< Value, in the unit of the response.

    /// Derivatives df/dstiffness and df/dmass for every designed body (n_cells each).
    std::vector<CellScaleFactors> slopes;
  };
  /// Computes all responses by one motion and one adjoint computation.
  /// @param factors  scale factors of every designed body from its design problem; the scale
  ///                 factors of void in motions are added to them
  /// @throws Error (numerical) when the motion fails.
  virtual std::vector<Value> evaluate(std::span<const MotionRow> rows,
                                      std::span<const CellScaleFactors> factors) = 0;
  /// Computes all responses of a crisp design by one motion, without derivatives.
  /// @param fractions  area fractions of material of every designed body (n_cells each)
  virtual std::vector<double> crisp(std::span<const MotionRow> rows,
                                    std::span<const VectorXd> fractions) = 0;
  /// Returns the number of motions computed so far, those with gradients included.
  virtual int motions() const = 0;
};

/// The motion of a mechanism at the current designs of its bodies. It is computed once for all
/// responses of all bodies.
class MotionState {
 public:
  /// Creates the state of a motion that is not computed yet.
  /// @param motion  must live longer than the state
  /// @param goals   goals on the motion of every designed body
  MotionState(MotionResponse& motion, std::span<const Goal* const> goals);

  /// Sets the scale factors of a body; the motion is invalidated if they have changed.
  void notify(size_t body, const CellScaleFactors& factors);
  /// Computes the objective J if `row` is the objective of the body, otherwise a limited response,
  /// with the derivatives by the scale factors of the body.
  /// @param out  receives the result; d_parameters stays unchanged
  /// @throws Error (numerical) as MotionResponse::evaluate(), or where the value is not positive.
  void value(const ResponseRow& row, size_t body, Values& out);
  /// Returns the derivatives of a limited response of `body` by the scale factors of the body `by`.
  const CellScaleFactors& limit_gradient(const ResponseRow& row, size_t body, size_t by);

 private:
  struct Range {
    size_t first, last;
  };
  Range rows_behind(const ResponseRow& row, size_t body) const;
  void move();

  MotionResponse& motion_;
  std::vector<MotionRow> rows_;  // the objectives, each once, then the limited responses
  size_t n_objectives_ = 0;
  std::vector<const ResponseRow*> objective_of_;  // objective of every body
  std::vector<CellScaleFactors> factors_;
  std::vector<MotionResponse::Value> values_;  // values of rows_; empty: not computed yet
};

/// The body index in the coupled problem of a mechanism, with the motion of the mechanism.
struct CoupledMotion {
  MotionState* state = nullptr;  ///< Motion of the mechanism, shared by all its designed bodies.
  size_t body = 0;               ///< Index of the designed body.
};

}  // namespace flexmorph::mmc
