#pragma once

#include <optional>
#include <utility>
#include <vector>

#include "optim/mmc/body_design.h"
#include "optim/mmc/crisp_picture.h"
#include "optim/mmc/motion_response.h"
#include "optim/mmc/shared_problem.h"
#include "optim/mmc/width_limits.h"

/// Bodies that are designed together, while they are: what body_design.cpp and mended_parts.cpp
/// share.
namespace flexmorph::mmc {

/// One of the bodies that are designed together.
struct Part {
  BodyProblem& problem;
  ComplianceEvaluator& loads;
  Plate plate;
  Ersatz ersatz;
  const TdfSettings* tdf = nullptr;   // of the stage
  std::optional<Turnover> turnover;   // of the stage
  std::optional<WidthLimits> widths;  // limits of the stage, once the design was mended
  Figures crisp_ratios;  // of limited responses: of the crisp design by the blurred one
  std::optional<CrispPicture> crisp;  // the design is seen as its outlines enclose it
  BodyOutcome outcome;
  optim::Stop stopped = optim::Stop::failed;  // the optimizer, last
  Design next;                                // when a list of components changed: where to go on

  explicit Part(const LoadedBody& body)
      : problem(body.problem),
        loads(body.loads),
        plate(plate_of(problem)),
        ersatz(ersatz_of(problem)),
        next(problem.design) {}

  MmcProblem state() { return state(problem.goal, nullptr); }
  /// With another goal, which may ask for the motion.
  MmcProblem state(const Goal& goal, const MotionSeat* seat) {
    return {{plate, problem.design, ersatz, loads, widths ? &*widths : nullptr, seat,
             crisp ? &*crisp : nullptr},
            *tdf,
            blurred(goal, crisp_ratios),
            problem.places};
  }
};

/// Tells whether a limit speaks of a response of the loads, whose blurred and crisp values differ.
bool limits_state(const Part& p);
/// Figures of the crisp design under the loads; without its outlines and what hangs together.
SharpDesign crisp_figures(const Part& p);
/// Makes limits hold of the crisp design: see blurred().
void follow_crisp(Part& p);

/// Computes the blurred figures of a design into its outcome.
void measure(Part& p);
/// Computes the sharp design of an outcome and its figures under the loads.
void finish_outcome(Part& p, bool condition);

/// The problem of all parts at their designs: that of the only one, or the shared one.
class Whole {
 public:
  explicit Whole(std::vector<Part>& parts) : Whole(parts, goals_of_loads(parts), nullptr) {}
  /// For the motion of the mechanism that they are parts of.
  /// @param motion  lives longer
  Whole(std::vector<Part>& parts, MotionState& motion)
      : Whole(parts, goals_of_motion(parts), &motion) {}
  /// For loads, with goals that have derivatives: smooth().
  static Whole smooth(std::vector<Part>& parts) {
    std::vector<Goal> goals = goals_of_loads(parts);
    for (Goal& goal : goals) goal = mmc::smooth(std::move(goal));
    return {parts, goals, nullptr};
  }

 private:
  Whole(std::vector<Part>& parts, const std::vector<Goal>& goals, MotionState* motion) {
    states.reserve(parts.size());
    seats_.reserve(parts.size());
    for (size_t k = 0; k < parts.size(); ++k) {
      seats_.push_back({motion, k});
      states.push_back(parts[k].state(goals[k], motion ? &seats_.back() : nullptr));
    }
    if (parts.size() == 1) return;
    std::vector<SharedProblem::Part> all;
    for (size_t k = 0; k < parts.size(); ++k)
      all.push_back({&states[k], parts[k].plate.full_mass(), parts[k].problem.shares_mass});
    shared_.emplace(std::move(all));
  }

 public:
  Whole(const Whole&) = delete;

  optim::Problem& problem() {
    if (shared_) return *shared_;
    return states.front();
  }
  VectorXd part_of(const VectorXd& x, size_t k) const {
    return shared_ ? shared_->part_of(x, k) : x;
  }

  /// The constraint that a limit of a body has become.
  int row_of(size_t body, size_t limit) const {
    const int own = states[body].row_of(limit);
    return shared_ ? shared_->row_of(body, own) : own;
  }

  std::vector<MmcProblem> states;

 private:
  static std::vector<Goal> goals_of_loads(const std::vector<Part>& parts) {
    std::vector<Goal> out;
    for (const Part& p : parts) out.push_back(p.problem.goal);
    return out;
  }
  static std::vector<Goal> goals_of_motion(const std::vector<Part>& parts) {
    std::vector<Goal> out;
    for (const Part& p : parts) out.push_back(p.problem.motion_goal);
    return out;
  }

  std::vector<MotionSeat> seats_;
  std::optional<SharedProblem> shared_;
};

}  // namespace flexmorph::mmc
