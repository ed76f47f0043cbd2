#pragma once

#include <limits>

#include "optim/mmc/ersatz.h"
#include "optim/mmc/load_response.h"

namespace flexmorph::mmc {

/// m values of a response, with their derivatives by the factors of the cells (m x n_cells) and by
/// the parameters of the components directly (m x 7 N). Without entries they are zero.
struct Values : LoadResponse::Each {
  MatrixXd d_parameters;
};

/// The state of a design under its loads for all responses that ask for it: it is factored once,
/// and not at all when none asks.
class DesignState {
 public:
  /// @param loads  lives longer
  explicit DesignState(LoadResponse& loads) : loads_(loads) {}

  /// Another design: nothing is solved yet.
  void begin() { solved_ = false; }

  /// The weighted compliance, or every load's. @param out  d_parameters stays as it is
  /// @throws Error (numerical) when the state cannot be solved, or a compliance is not positive.
  void sum(const CellFactors& factors, Values& out);
  void each(const CellFactors& factors, Values& out);

  /// What the first of them saw, of many loads the worst: NaN when nothing was solved.
  const LoadResponse::Value& value() const { return value_; }

  int n_loads() const { return loads_.n_loads(); }
  LoadResponse& loads() { return loads_; }
  const LoadResponse& loads() const { return loads_; }
  /// CPU seconds since clear_seconds().
  LoadResponse::Seconds seconds() const { return seconds_; }
  void clear_seconds() { seconds_ = {}; }

 private:
  void finish(LoadResponse::Value& value);

  LoadResponse& loads_;
  LoadResponse::Value value_{std::numeric_limits<double>::quiet_NaN(), {}, {}, {}}, other_;
  LoadResponse::Seconds seconds_;
  bool solved_ = false;
};

}  // namespace flexmorph::mmc
