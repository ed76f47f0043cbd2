#pragma once

#include <optional>
#include <span>
#include <vector>

#include "optim/mmc/length_scale/outline_limits.h"
#include "optim/mmc/problem/body_problem.h"
#include "optim/mmc/problem/crisp_picture.h"
#include "optim/mmc/problem/motion_response.h"
#include "optim/mmc/problem/shared_problem.h"

namespace flexmorph::mmc {

/// A body and the loads that it is designed under. Both must outlive the objects made from them.
struct LoadedBody {
  BodyProblem& problem;        ///< Design problem of the body.
  ComplianceEvaluator& loads;  ///< Loads of the body.
};

/// One of the bodies that are designed together, with the data that all its designs use.
struct Subproblem {
  BodyProblem& problem;        ///< Design problem of the body.
  ComplianceEvaluator& loads;  ///< Loads of the body.
  Plate plate;                 ///< Plate of the body, independent of the design.
  Ersatz ersatz;               ///< Map from the TDF to the scale factors of the cells.

  /// Creates a part from a body and its loads.
  explicit Subproblem(const LoadedBody& body)
      : problem(body.problem),
        loads(body.loads),
        plate(plate_of(problem)),
        ersatz(ersatz_of(problem)) {}
};

/// Specifies how a design problem evaluates the design of a body.
struct Formulation {
  TdfSettings tdf;  ///< Settings of the TDF: band and erosion.

  /// Required widths of the crisp outline. If present, they are constraints, and the limit on the
  /// volume applies to the volume that the outline encloses. If absent, that limit applies to the
  /// volume of the regularized design. Limits on responses of the loads apply to the crisp design
  /// in both cases, except with the TDF of the paper.
  std::optional<MinimumWidths> outline = {};
  bool crisp = false;  ///< True if the outlines define the cells exactly, see CrispPicture.
};

/// Returns the formulation with nominal stiffness, without erosion, at a band of the continuation.
Formulation nominal(const BodyProblem& problem, size_t band);
/// Returns the formulation with the stiffness of the eroded design at the last band.
Formulation eroded(const BodyProblem& problem);
/// Returns the formulation of the last stage, which also gives the reported numbers of a design:
/// nominal stiffness at the last band with limits of the outline; eroded() if no widths are
/// required.
Formulation last_formulation(const BodyProblem& problem);

/// Returns the present designs of the bodies, in the order of the parts.
std::vector<Design> designs_of(std::span<const Subproblem> parts);

/// Tells whether the goal limits a response of the loads, whose regularized and crisp values
/// differ.
bool limits_state(const BodyProblem& problem);

/// The combined problem of all parts at given designs: the problem of the part if there is only
/// one, otherwise a SharedProblem.
class CombinedProblem {
 public:
  /// Creates the combined problem under the loads of the parts.
  CombinedProblem(std::span<const Subproblem> parts, std::vector<Design> designs,
                  std::span<const Formulation> formulations)
      : CombinedProblem(parts, std::move(designs), formulations, goals_of_loads(parts), nullptr) {}
  /// Creates the combined problem for the motion of the mechanism that contains the parts.
  /// @param motion  must outlive the new object
  CombinedProblem(std::span<const Subproblem> parts, std::vector<Design> designs,
                  std::span<const Formulation> formulations, MotionState& motion);
  /// Returns the combined problem under the loads of the parts with goals that mmc::smooth() has
  /// made differentiable.
  static CombinedProblem smooth(std::span<const Subproblem> parts, std::vector<Design> designs,
                                std::span<const Formulation> formulations);

  CombinedProblem(const CombinedProblem&) = delete;

  /// Returns the combined problem.
  optim::Problem& problem() {
    if (shared_) return *shared_;
    return states.front();
  }
  /// Returns the variables of body k, taken from the variables x of the combined problem.
  VectorXd part_of(const VectorXd& x, size_t k) const {
    return shared_ ? shared_->part_of(x, k) : x;
  }
  /// Returns the designs of all bodies for the variables x of the combined problem.
  std::vector<Design> designs_at(const VectorXd& x) const;
  /// Returns the designs of all bodies that the combined problem was created with.
  const std::vector<Design>& designs() const { return designs_; }

  /// Returns the row of the combined constraints that a limit of a body has.
  int row_of(size_t body, size_t limit) const {
    const int own = states[body].row_of(limit);
    return shared_ ? shared_->row_of(body, own) : own;
  }

 private:
  CombinedProblem(std::span<const Subproblem> parts, std::vector<Design> designs,
                  std::span<const Formulation> formulations, const std::vector<Goal>& goals,
                  MotionState* motion);
  static std::vector<Goal> goals_of_loads(std::span<const Subproblem> parts);

  std::vector<Design> designs_;
  std::vector<std::optional<OutlineLimits>> outlines_;
  std::vector<std::optional<CrispPicture>> crisp_, limited_;
  std::vector<CoupledMotion> couplings_;
  std::optional<SharedProblem> shared_;

 public:
  std::vector<MmcProblem> states;  ///< Subproblems of the bodies, in the order of the parts.
};

}  // namespace flexmorph::mmc
