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

/// A body and the loads it is designed under. Both live longer than what is made of them.
struct LoadedBody {
  BodyProblem& problem;
  ComplianceEvaluator& loads;
};

/// One of the bodies that are designed together, with what every design of it needs.
struct Part {
  BodyProblem& problem;
  ComplianceEvaluator& loads;
  Plate plate;
  Ersatz ersatz;

  explicit Part(const LoadedBody& body)
      : problem(body.problem),
        loads(body.loads),
        plate(plate_of(problem)),
        ersatz(ersatz_of(problem)) {}
};

/// How a design problem sees the design of a body.
struct Formulation {
  TdfSettings tdf;
  /// Widths of the crisp outline are limited, and the limit on the volume is on what it encloses;
  /// absent: that limit is on the volume of the regularized design. (Limits on responses of the
  /// loads are on those of the crisp design always, but with the TDF of the paper.)
  std::optional<Widths> outline = {};
  bool crisp = false;  ///< the design is seen as its outlines enclose it, see CrispPicture
};

/// The TDF at a band of the continuation: without erosion.
Formulation nominal(const BodyProblem& problem, size_t band);
/// The last band, with the stiffness of the eroded design.
Formulation eroded(const BodyProblem& problem);
/// The last stage's, which delivered designs are measured by: nominal stiffness at the last band
/// and limits of the outline; eroded() where no widths are wanted.
Formulation last_formulation(const BodyProblem& problem);

/// Returns the designs of the bodies as they are now, in the order of the parts.
std::vector<Design> designs_of(std::span<const Part> parts);

/// Tells whether a limit speaks of a response of the loads, whose regularized and crisp values
/// differ.
bool limits_state(const BodyProblem& problem);

/// The problem of all parts at given designs: that of the only one, or the shared one.
class Whole {
 public:
  Whole(std::span<const Part> parts, std::vector<Design> designs,
        std::span<const Formulation> formulations)
      : Whole(parts, std::move(designs), formulations, goals_of_loads(parts), nullptr) {}
  /// For the motion of the mechanism that they are parts of.
  /// @param motion  lives longer
  Whole(std::span<const Part> parts, std::vector<Design> designs,
        std::span<const Formulation> formulations, MotionState& motion);
  /// For loads, with goals that have derivatives: smooth().
  static Whole smooth(std::span<const Part> parts, std::vector<Design> designs,
                      std::span<const Formulation> formulations);

  Whole(const Whole&) = delete;

  optim::Problem& problem() {
    if (shared_) return *shared_;
    return states.front();
  }
  VectorXd part_of(const VectorXd& x, size_t k) const {
    return shared_ ? shared_->part_of(x, k) : x;
  }
  /// The designs of a vector of variables.
  std::vector<Design> designs_at(const VectorXd& x) const;
  const std::vector<Design>& designs() const { return designs_; }

  /// The constraint that a limit of a body has become.
  int row_of(size_t body, size_t limit) const {
    const int own = states[body].row_of(limit);
    return shared_ ? shared_->row_of(body, own) : own;
  }

 private:
  Whole(std::span<const Part> parts, std::vector<Design> designs,
        std::span<const Formulation> formulations, const std::vector<Goal>& goals,
        MotionState* motion);
  static std::vector<Goal> goals_of_loads(std::span<const Part> parts);

  std::vector<Design> designs_;
  std::vector<std::optional<OutlineLimits>> outlines_;
  std::vector<std::optional<CrispPicture>> crisp_, limited_;
  std::vector<MotionSeat> seats_;
  std::optional<SharedProblem> shared_;

 public:
  std::vector<MmcProblem> states;
};

}  // namespace flexmorph::mmc
