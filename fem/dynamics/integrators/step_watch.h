#pragma once

#include <optional>
#include <string>
#include <vector>

#include "fem/model/model.h"
#include "geometry/archive.h"

namespace flexmorph::fem {

/// Record of a constraint whose multiplier alternates from step to step.
struct Alternation {
  double time = 0;    ///< Time at which the alternation began [s].
  std::string joint;  ///< Name of the joint whose row alternates most.
  double part = 0;    ///< Largest amplitude, relative to the largest multiplier of the row.
};

/// Saves or restores the record of an alternation (geometry/archive.h).
void archive(Archive& memory, Alternation& alternation);

/// Check for alternating multipliers. In index-3 equations the algorithmic component of λ obeys
/// λ_{n+1} = -ρ_∞ λ_n + ...: for ρ_∞ = 1 a disturbance by a step or a drive is never damped. It
/// grows if constraints are not linear, until Newton's method fails and steps are halved.
///
/// A row alternates if its second differences λ_{n+1} - 2 λ_n + λ_{n-1} change sign from step to
/// step and are not small relative to its largest multiplier, in kSteps consecutive steps. With ρ_∞
/// = 0.95 less than a hundredth of any disturbance remains after kSteps steps. Axial waves that a
/// step does not resolve alternate for some tens of steps at a start and are then damped.
///
/// Source: Cardona & Géradin (1989), Comput. Struct. 33, 801-820; Arnold & Brüls (2007), Multibody
/// Syst. Dyn. 18, 185-202.
class MultiplierWatch {
 public:
  static constexpr int kSteps = 100;         ///< Number of consecutive steps of equal length.
  static constexpr double kNoticed = 0.005;  ///< Limit of Alternation::part.

  /// Checks the multipliers after an accepted step of length h that ended at x.
  void see(const Model& model, const State& x, double h);
  /// Returns the strongest alternation so far, if any.
  const std::optional<Alternation>& found() const { return found_; }
  /// Saves or restores the state of the check (geometry/archive.h).
  void archive(Archive& memory, const Model& model);

 private:
  void begin(const Model& model, const State& x, double h);

  int version_ = -1, steps_ = 0;
  double h_ = 0;
  VectorXd last_, before_, difference_, largest_;
  std::vector<int> in_a_row_;
  std::optional<Alternation> found_;
};

/// Record of equal steps that were shortened because Newton's method failed.
struct CutSteps {
  int number = 0;       ///< Number of accepted steps that are shorter than intended.
  double since = 0;     ///< Time at which the first shortened step began [s].
  double shortest = 0;  ///< Length of the shortest step [s].
};

}  // namespace flexmorph::fem
