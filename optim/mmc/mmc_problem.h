#pragma once

#include <limits>

#include "geometry/tdf.h"
#include "optim/mmc/design.h"
#include "optim/mmc/ersatz.h"
#include "optim/mmc/responses.h"
#include "optim/problem.h"

namespace flexmorph::mmc {

/// The design problem over fixed ESL sets, P (34) in the variables of a Design:
///
///   minimize  log f(b)   subject to  V(b)/V_max - 1 <= 0,  bounds
///
/// f is the compliance of all loads, V the mean of the cells' mass factors. The logarithm, because
/// f spans decades in the first iterations. One state solve serves values and gradients.
class MmcProblem final : public optim::Problem {
 public:
  MmcProblem(const Grid& grid, const Design& design, const Ersatz& ersatz, Compliance& compliance,
             const TdfSettings& tdf, double max_volume);

  int n_variables() const override { return design_.n_variables(); }
  int n_constraints() const override { return 1; }
  VectorXd lower() const override { return design_.lower(); }
  VectorXd upper() const override { return design_.upper(); }
  VectorXd start() const override { return design_.x(); }
  optim::Response evaluate(const VectorXd& x) override;
  /// Does one piece of material, blurred links included, reach from root to free end, or does the
  /// design carry its loads about as well as the best one all the same?
  bool acceptable(const VectorXd& x) override;

  // What the last evaluate() saw.
  const VectorXd& x() const { return x_; }
  const Compliance::Value& value() const { return value_; }
  double compliance() const { return value_.f; }
  double volume() const { return volume_; }
  const std::vector<Component>& components() const { return components_; }
  const CellFactors& factors() const { return factors_; }
  const VectorXd& phi() const { return tdf_.phi(); }
  double band() const { return tdf_.settings().band; }
  double seconds_tdf() const { return seconds_tdf_; }  ///< CPU, TDF and chain rule
  Compliance::Seconds seconds() const { return seconds_; }

 private:
  Grid grid_;
  const Design& design_;
  const Ersatz& ersatz_;
  Compliance& compliance_;
  UnionTdf tdf_;
  double max_volume_;
  std::vector<Component> components_;
  CellFactors factors_;
  Compliance::Value value_;
  Compliance::Seconds seconds_;
  VectorXd x_, d_h_, d_eroded_, d_x_, zero_, ones_;
  double volume_ = 0, seconds_tdf_ = 0;
  double lowest_ = std::numeric_limits<double>::infinity();  // compliance of acceptable designs
};

/// CPU seconds of this process.
double cpu_seconds();

}  // namespace flexmorph::mmc
