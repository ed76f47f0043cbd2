#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "cases/assembly/scene_motion.h"
#include "optim/mmc/cycles/combined_problem.h"
#include "optim/mmc/cycles/esl_loop.h"

/// Design problems of a case for programs that use optimizers of their own.
namespace flexmorph::cases {

/// Names the formulation of a design problem, as the stages of a design cycle use it.
enum class DesignStage {
  coarse,  ///< First band of the continuation, with nominal stiffness.
  eroded,  ///< Last band, with the stiffness of the eroded design.
  last     ///< Last band, with the widths as constraints, see mmc::last_formulation().
};

/// Settings of a design problem.
struct DesignProblemSettings {
  std::string body = {};                  ///< Designed body; may be empty if the case has only one.
  DesignStage stage = DesignStage::last;  ///< Formulation of the design problem.

  /// True if the responses are those of the motion itself, with their exact gradients, for all
  /// designed bodies together. False if they are those under the loads of the first design cycle.
  bool of_motion = false;
  double cell = 0;  ///< Size of the cells of the motion [m]; 0: that of the design cells.
  double step = 0;  ///< Time step of the motion [s]; 0: that of the scene.

  /// Cancellation callback of motions and stages; false stops. Empty: nothing is cancelled.
  std::function<bool()> keep_running = {};
};

/// The design problem of a body, or of bodies with a common budget of mass, as the first cycle of a
/// run has it: a run of a static plate, or the cycle after the first motion. It owns the loads.
class DesignProblem {
 public:
  /// Creates the problem at the start designs of the case, which takes one motion if bodies move.
  /// @param prepared  case; must live longer
  /// @throws Error (input) for an unknown body, for a case without designs, and for a problem of
  ///         the motion of a case that does not move; Error of the motion; Interrupted
  DesignProblem(const PreparedCase& prepared, const DesignProblemSettings& settings);

  /// Returns the problem under equal loads in another formulation at the design x.
  /// @throws Error (input) if x has another length than the variables
  DesignProblem at(DesignStage stage, const VectorXd& x) const;

  /// Returns the problem that the optimizers of Flexmorph solve. In the stage DesignStage::last,
  /// its limits have the values of the crisp design and the gradients of the regularized one.
  optim::Problem& problem() { return combined_->problem(); }
  /// Returns values and gradients at the design x for optimizers with a line search or a trust
  /// region, which need values and gradients of one function. It differs from problem() in the
  /// limits of DesignStage::last: they hold for the regularized design times the ratio of the crisp
  /// to the regularized value at the start of this problem. At the start the values are those of
  /// problem(); at(stage, x) gives the problem with the ratio of another design.
  /// @throws Error (numerical) if the state cannot be solved at x or at the start
  optim::ProblemValues evaluate(const VectorXd& x);
  /// Returns the names of the bodies, in the order of their variables.
  std::vector<std::string> bodies() const;
  /// Returns the names of the variables, such as "rocker.3.angle"; components count from 1.
  std::vector<std::string> variable_names() const;
  /// Returns the names of the constraints, in the order of optim::ProblemValues::g.
  std::vector<std::string> constraint_names();
  /// Returns the components of every body at the design x, mirror images included.
  std::vector<std::vector<Component>> components(const VectorXd& x) const;
  /// Returns the crisp designs that the outlines of x enclose, one per body.
  std::vector<mmc::CrispDesign> crisp(const VectorXd& x) const;
  /// Returns the violations mmc::crisp_violation() of the limits by crisp designs, one per body.
  std::vector<double> crisp_violations(const std::vector<mmc::CrispDesign>& designs) const;

  /// Designs the bodies from their start designs through all stages of the first cycle of a run.
  /// The problem itself does not change.
  /// @param optimizer  settings of the optimizer
  /// @param observe    called with every iteration; false stops
  std::vector<mmc::BodyOutcome> design(const optim::Settings& optimizer,
                                       const mmc::IterationObserver& observe,
                                       std::vector<mmc::BodyProblem>& designed) const;

 private:
  struct Loaded;
  DesignProblem(std::shared_ptr<const Loaded> loaded, DesignStage stage,
                std::vector<mmc::Design> designs);
  /// A limit with its value for the regularized design.
  struct RegularizedLimit {
    Eigen::Index row;   ///< Row of the constraint.
    double sign;        ///< -1 for a lower bound, 1 for an upper one.
    bool is_logarithm;  ///< True for sign * log(part), false for sign * (part - 1).
    double part;        ///< Value of the regularized response relative to its limit.
  };
  std::vector<RegularizedLimit> regularized_limits() const;

  std::shared_ptr<const Loaded> loaded_;
  std::vector<mmc::Formulation> formulations_;
  std::unique_ptr<mmc::MotionState> motion_;
  std::unique_ptr<mmc::CombinedProblem> combined_;
  DesignStage stage_ = DesignStage::last;
  std::optional<std::vector<double>> ratios_;  // crisp / regularized value of limits at the start
};

}  // namespace flexmorph::cases
