#pragma once

#include <limits>

#include "optim/mmc/loads/compliance_evaluator.h"
#include "optim/mmc/problem/ersatz.h"

namespace flexmorph::mmc {

/// m values of a response, with their derivatives by the factors of the cells (m x n_cells) and by
/// the parameters of the components directly (m x 7 N). Without entries they are zero.
struct Values : ComplianceEvaluator::Each {
  MatrixXd d_parameters;
};

/// The state of a design under its loads for all responses that ask for it: it is factored once,
/// and not at all when none asks.
class DesignState {
 public:
  /// @param loads  lives longer
  explicit DesignState(ComplianceEvaluator& loads) : loads_(loads) {}

  /// Another design: nothing is solved yet.
  void begin() { solved_ = false; }

  /// The weighted compliance, or every load's. @param out  d_parameters stays as it is
  /// @throws Error (numerical) when the state cannot be solved, or a compliance is not positive.
  void sum(const CellFactors& factors, Values& out);
  void each(const CellFactors& factors, Values& out);

  /// What the first of them saw, of many loads the worst: NaN when nothing was solved.
  const ComplianceEvaluator::Value& value() const { return value_; }

  int n_loads() const { return loads_.n_loads(); }
  ComplianceEvaluator& loads() { return loads_; }
  const ComplianceEvaluator& loads() const { return loads_; }
  /// CPU seconds since clear_seconds().
  ComplianceEvaluator::Seconds seconds() const { return seconds_; }
  void clear_seconds() { seconds_ = {}; }

 private:
  void finish(ComplianceEvaluator::Value& value);

  ComplianceEvaluator& loads_;
  ComplianceEvaluator::Value value_{std::numeric_limits<double>::quiet_NaN(), {}, {}, {}}, other_;
  ComplianceEvaluator::Seconds seconds_;
  bool solved_ = false;
};

}  // namespace flexmorph::mmc
