#pragma once

#include "cases/assembly/prepared_case.h"
#include "fem/dynamics/gradients/motion_gradient.h"
#include "optim/mmc/problem/motion_response.h"

namespace flexmorph::cases {

/// The motion of a scene on the cells of its designs, or on coarser cells, with exact gradients of
/// its responses.
class SceneMotion final : public mmc::MotionResponse {
 public:
  /// Settings of the motion and of its adjoint computation.
  struct Settings {
    double cell = 0;      ///< Size of the cells of the motion [m]; 0: that of the design cells.
    double step = 0;      ///< Time step [s]; 0: that of the scene.
    int checkpoints = 0;  ///< Number of checkpoints of the adjoint computation.
  };
  /// Creates the motion of a prepared case.
  /// @param prepared  must live longer
  /// @param keep_running  cancellation callback of evaluate() and crisp(), called at every step;
  ///                      they throw StoppedMotion when it returns false
  SceneMotion(const PreparedCase& prepared, const Settings& settings,
              std::function<bool()> keep_running);

  std::vector<Value> evaluate(std::span<const mmc::MotionRow> rows,
                              std::span<const mmc::CellScaleFactors> factors) override;
  std::vector<double> crisp(std::span<const mmc::MotionRow> rows,
                            std::span<const VectorXd> fractions) override;
  int motions() const override { return motions_; }

  /// Returns the result of the last evaluate() with its computing times.
  const fem::MotionGradients& last() const { return last_; }

 private:
  fem::MotionObjective objective_of(const mmc::MotionRow& row, const Mechanism& mechanism) const;
  Mechanism mechanism_with(std::span<const mmc::CellScaleFactors> factors) const;
  int coarse(size_t design) const;
  void stop_if_cancelled() const;

  const PreparedCase& prepared_;
  const Scene& scene_;
  Settings settings_;
  std::function<bool()> keep_running_;
  int motions_ = 0;
  fem::MotionGradients last_;
};

/// Exception that ends an evaluation when the cancellation callback returns false.
struct StoppedMotion {};

}  // namespace flexmorph::cases
