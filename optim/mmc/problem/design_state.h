#pragma once

#include <limits>

#include "optim/mmc/loads/compliance_evaluator.h"
#include "optim/mmc/problem/ersatz.h"

namespace flexmorph::mmc {

/// The m values of a response, with their derivatives by the scale factors of the cells (m x
/// n_cells) and directly by the component parameters (m x 7 N). An empty matrix stands for zeros.
struct Values : ComplianceEvaluator::Each {
  MatrixXd d_parameters;  ///< Direct derivatives by the component parameters (m x 7 N).
};

/// The state of a design under its loads, shared by all responses that need it. K is factored once
/// per design, and not at all when no response needs the state.
class DesignState {
 public:
  /// Creates a state that is not solved yet.
  /// @param loads  must live longer than the state
  explicit DesignState(ComplianceEvaluator& loads) : loads_(loads) {}

  /// Marks the state as unsolved, because the design has changed.
  void begin() { solved_ = false; }

  /// Computes the weighted sum of the compliances and its derivatives.
  /// @param out  receives them; d_parameters stays unchanged
  /// @throws Error (numerical) when the state cannot be solved, or a compliance is not positive.
  void sum(const CellScaleFactors& factors, Values& out);
  /// Computes the compliance of every load and its derivatives.
  /// @param out  receives them; d_parameters stays unchanged
  /// @throws Error (numerical) when the state cannot be solved, or a compliance is not positive.
  void each(const CellScaleFactors& factors, Values& out);

  /// Returns the result of the first evaluation after begin(): of each() the largest compliance.
  /// The compliance is NaN until anything has been solved.
  const ComplianceEvaluator::Value& value() const { return value_; }

  /// Returns the number of loads.
  int n_loads() const { return loads_.n_loads(); }
  /// Returns the evaluator of the loads.
  ComplianceEvaluator& loads() { return loads_; }
  /// Returns the evaluator of the loads.
  const ComplianceEvaluator& loads() const { return loads_; }
  /// Returns the CPU seconds of all evaluations since clear_seconds().
  ComplianceEvaluator::Seconds seconds() const { return seconds_; }
  /// Resets the CPU seconds to zero.
  void clear_seconds() { seconds_ = {}; }

 private:
  void finish(ComplianceEvaluator::Value& value);

  ComplianceEvaluator& loads_;
  ComplianceEvaluator::Value value_{std::numeric_limits<double>::quiet_NaN(), {}, {}, {}}, other_;
  ComplianceEvaluator::Seconds seconds_;
  bool solved_ = false;
};

}  // namespace flexmorph::mmc
