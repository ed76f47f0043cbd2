#pragma once

#include <vector>

#include "optim/mmc/problem/mmc_problem.h"

namespace flexmorph::mmc {

/// Designs of several bodies as one problem, with one budget of mass:
///
///   min log Σ_b C_b   s.t.  Σ_b m_b V_b / Σ_b m_b V_max,b - 1 <= 0
///
/// C_b  weighted compliance of body b under its own loads [J]
/// V_b  its volume fraction, V_max,b what it would be allowed by itself [-]
/// m_b  its mass when its domain is full, ρ c A [kg]
///
/// and to all other limits of the bodies, each that of its own. The budget is made of the one limit
/// of each body that is a volume (Limit::volume): of volume or of mass. Bodies may also keep all of
/// their limits to themselves, and have but the objective in common: the sum of their compliances,
/// or a number of the motion of the mechanism that they are parts of.
///
/// Limits of that motion depend on the designs of all bodies, the others on those of their own.
///
/// The variables are those of all bodies, one body after the other, each with its own scales and
/// bounds. A body sees the others through the two sums only: values and gradients are made of the
/// bodies' own, df = Σ (C_b / Σ C) df_b and g = Σ s_b g_b with the shares s_b of the budget.
class SharedProblem final : public optim::Problem {
 public:
  struct Part {
    MmcProblem* problem = nullptr;  ///< lives longer
    double full_mass = 0;           ///< m_b [kg]
    bool shares = true;             ///< the budget
  };
  /// @throws Error (input) for no parts, masses that are not positive, other objectives, and, of
  ///         who shares, not just one limit of volume.
  explicit SharedProblem(std::vector<Part> parts);

  int n_variables() const override { return first_.back(); }
  /// The budget, then the other limits of the bodies, one body after the other.
  int n_constraints() const override { return n_constraints_; }
  VectorXd lower() const override;
  VectorXd upper() const override;
  VectorXd start() const override;
  /// Every part evaluates its own variables once.
  optim::Response evaluate(const VectorXd& x) override;
  /// Only when every body's design is.
  bool acceptable(const VectorXd& x) override;

  /// The variables of one body.
  VectorXd part_of(const VectorXd& x, size_t body) const {
    return x.segment(first_[body], first_[body + 1] - first_[body]);
  }
  /// The constraint that a constraint of one body has become.
  int row_of(size_t body, int own) const;

 private:
  void add_slopes_of_others(optim::Response& out);
  template <class Of>
  VectorXd joined(Of&& of) const;

  std::vector<Part> parts_;
  std::vector<int> first_;   // variables of each body, and the end
  std::vector<int> budget_;  // its constraint in each body; -1: not of this one
  int n_constraints_ = 0;
  bool of_motion_ = false;  // the objective
  VectorXd shares_;         // s_b of the budget
};

/// The limit of a goal that a budget is made of.
/// @throws Error (input) when there is not just one.
size_t shared_limit(const Goal& goal);

}  // namespace flexmorph::mmc
