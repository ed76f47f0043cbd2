#pragma once

#include <span>
#include <vector>

#include "optim/mmc/problem/goal.h"
#include "optim/mmc/problem/response.h"

namespace flexmorph::mmc {

/// A number of the motion of a mechanism: a row of the table, and the designed body it is of.
struct MotionRow {
  const ResponseRow* row = nullptr;
  size_t body = 0;    ///< among the designed ones
  double weight = 1;  ///< of an objective, which is a sum

  /// Is it the same number? (Of rows that are of no body the body does not count.)
  bool same_as(const MotionRow& other) const {
    return row == other.row && (body == other.body || !row->of_body);
  }
};

/// What the goals of all designed bodies minimize, each number once: J is their weighted sum.
std::vector<MotionRow> motion_objectives(std::span<const Goal* const> goals);

/// What design problems ask of the motion of a mechanism.
class MotionResponse {
 public:
  virtual ~MotionResponse() = default;

  struct Value {
    double f = 0;
    std::vector<CellFactors> slopes;  ///< df/dstiffness, df/dmass of every designed body (n_cells)
  };
  /// One motion and one adjoint for all rows.
  /// @param factors  of every designed body, those of the design problem: the void of motions is
  ///                 added to them
  /// @throws Error (numerical) when the motion fails.
  virtual std::vector<Value> evaluate(std::span<const MotionRow> rows,
                                      std::span<const CellFactors> factors) = 0;
  /// The same numbers of a sharp picture: a motion alone.
  /// @param fractions  of material of every designed body (n_cells)
  virtual std::vector<double> sharp(std::span<const MotionRow> rows,
                                    std::span<const VectorXd> fractions) = 0;
  virtual int motions() const = 0;  ///< so far, gradients included
};

/// The motion of a mechanism at the designs of its bodies, moved once for all who ask.
class MotionState {
 public:
  /// @param motion  lives longer   @param goals  of the motion, of every designed body
  MotionState(MotionResponse& motion, std::span<const Goal* const> goals);

  /// The factors of a body.
  void announce(size_t body, const CellFactors& factors);
  /// J, or a limit's number, with the derivatives by the factors of that body.
  /// @param out  d_parameters stays as it is
  /// @throws Error (numerical) as MotionResponse::evaluate(), or where J is not positive.
  void value(const ResponseRow& row, size_t body, Values& out);
  /// The derivatives of a limited number of `body` by the factors of another one.
  const CellFactors& limit_slopes(const ResponseRow& row, size_t body, size_t by);

 private:
  struct Range {
    size_t first, last;
  };
  Range rows_behind(const ResponseRow& row, size_t body) const;
  void move();

  MotionResponse& motion_;
  std::vector<MotionRow> rows_;  // the objectives, each once, then the limits
  size_t n_objectives_ = 0;
  std::vector<const ResponseRow*> objective_of_;  // every body
  std::vector<CellFactors> factors_;
  std::vector<MotionResponse::Value> values_;  // of rows_; none: not moved yet
};

/// Where a body sits in a mechanism.
struct MotionSeat {
  MotionState* state = nullptr;
  size_t body = 0;
};

}  // namespace flexmorph::mmc
