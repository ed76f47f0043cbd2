#pragma once

#include <vector>

#include "optim/mmc/problem/mmc_problem.h"

namespace flexmorph::mmc {

/// The combined design problem of several bodies, which can share one budget of mass:
///
///   min log Σ_b C_b   s.t.  Σ_b m_b V_b / Σ_b m_b V_max,b - 1 <= 0
///
/// C_b  weighted compliance of body b under its own loads [J]
/// V_b  volume fraction of body b, V_max,b its upper limit in a separate design problem [-]
/// m_b  mass of body b when its domain is full, ρ c A [kg]
///
/// and subject to all other limits of the bodies, each for its own body. The budget replaces the
/// one limit of each body that is equivalent to a volume (Limit::volume): a limit of volume or of
/// mass. Bodies may also keep all of their limits. They then have only the objective in common,
/// which is the sum of their compliances or a response of the motion of their mechanism.
///
/// Limits on responses of the motion depend on the designs of all bodies; every other limit depends
/// on the design of one body.
///
/// The variables are those of all bodies, one body after the other, each with its own scales and
/// bounds. Except for responses of the motion, the bodies are coupled by the two sums only, so that
/// values and gradients follow from the subproblems: df = Σ (C_b / Σ C) df_b and g = Σ s_b g_b with
/// the fractions s_b of the budget.
class SharedProblem final : public optim::Problem {
 public:
  /// The subproblem of one body.
  struct Part {
    MmcProblem* problem = nullptr;  ///< Design problem of the body; it must live longer.
    double full_mass = 0;           ///< Mass m_b of the body when its domain is full [kg].
    bool shares = true;             ///< True if the body takes part in the budget of mass.
  };
  /// Creates the combined problem of several bodies.
  /// @throws Error (input) for no subproblems, for masses that are not positive, for objectives
  ///         other than the sum of compliances or a response of the motion, and when a body that
  ///         takes part in the budget does not have exactly one limit equivalent to a volume.
  explicit SharedProblem(std::vector<Part> parts);

  int n_variables() const override { return first_.back(); }
  /// Returns the number of constraints: the budget, if bodies share one, then the remaining limits
  /// of the bodies, one body after the other.
  int n_constraints() const override { return n_constraints_; }
  VectorXd lower() const override;
  VectorXd upper() const override;
  VectorXd start() const override;
  /// Computes the combined problem by one evaluation of every subproblem.
  optim::ProblemValues evaluate(const VectorXd& x) override;
  /// Returns true if the designs of all bodies are acceptable.
  bool acceptable(const VectorXd& x) override;

  /// Returns the variables of one body.
  VectorXd part_of(const VectorXd& x, size_t body) const {
    return x.segment(first_[body], first_[body + 1] - first_[body]);
  }
  /// Returns the index of a constraint of one body in the combined problem.
  /// @param own  index of the constraint in the subproblem of the body
  int row_of(size_t body, int own) const;

 private:
  void add_gradients_of_others(optim::ProblemValues& out);
  template <class Of>
  VectorXd joined(Of&& of) const;

  std::vector<Part> parts_;
  std::vector<int> first_;   // first variable of each body, and the end
  std::vector<int> budget_;  // index of the limit that the budget replaces in each body; -1: none
  int n_constraints_ = 0;
  bool of_motion_ = false;  // true if the objective is a response of the motion
  VectorXd shares_;         // fractions s_b of the budget
};

/// Returns the index of the limit of a goal that a budget of mass replaces.
/// @throws Error (input) when the goal does not have exactly one upper limit equivalent to a
/// volume.
size_t shared_limit(const Goal& goal);

}  // namespace flexmorph::mmc
