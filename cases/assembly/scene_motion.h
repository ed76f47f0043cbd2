#pragma once

#include "cases/assembly/prepared_case.h"
#include "fem/dynamics/gradients/motion_gradient.h"
#include "optim/mmc/problem/motion_response.h"

namespace flexmorph::cases {

/// The motion of a scene on the cells of its designs, or on coarser ones, with its exact gradient.
class SceneMotion final : public mmc::MotionResponse {
 public:
  struct Settings {
    double cell = 0;  ///< of the motion [m]; 0: those of the designs
    double step = 0;  ///< [s]
    int checkpoints = 0;
  };
  /// @param prepared  lives longer
  /// @param go_on  asked at every step; false ends a motion with StoppedMotion
  SceneMotion(const PreparedCase& prepared, const Settings& settings, std::function<bool()> go_on);

  std::vector<Value> evaluate(std::span<const mmc::MotionRow> rows,
                              std::span<const mmc::CellFactors> factors) override;
  std::vector<double> sharp(std::span<const mmc::MotionRow> rows,
                            std::span<const VectorXd> fractions) override;
  int motions() const override { return motions_; }

  /// What the last evaluate() spent.
  const fem::MotionGradients& last() const { return last_; }

 private:
  fem::MotionObjective objective_of(const mmc::MotionRow& row, const Mechanism& mechanism) const;
  Mechanism mechanism_with(std::span<const mmc::CellFactors> factors) const;
  int coarse(size_t design) const;

  const PreparedCase& prepared_;
  const Scene& scene_;
  Settings settings_;
  std::function<bool()> go_on_;
  int motions_ = 0;
  fem::MotionGradients last_;
};

/// The user wants no more, in the midst of a motion.
struct StoppedMotion {};

}  // namespace flexmorph::cases
