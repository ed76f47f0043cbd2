#pragma once

#include <optional>
#include <string>
#include <vector>

#include "fem/model/model.h"
#include "geometry/memory.h"

namespace flexmorph::fem {

/// A constraint whose multiplier changes to and fro from step to step.
struct Alternation {
  double time = 0;    ///< since when [s]
  std::string joint;  ///< whose row alternates most
  double part = 0;    ///< largest amplitude met, of the row's largest multiplier
};

void remember(Memory& memory, Alternation& alternation);

/// Watches for multipliers that alternate. In index-3 equations the algorithmic part of λ obeys
/// λ_{n+1} = -ρ_∞ λ_n + ...: what a step or a drive sets off is never damped for ρ_∞ = 1, and
/// grows where constraints are not linear, until Newton's method fails and steps are halved.
///
/// A row alternates while its second differences λ_{n+1} - 2 λ_n + λ_{n-1} change sign from step to
/// step and are not small against its largest multiplier, kSteps steps in a row: with ρ_∞ = 0.95
/// less than a hundredth is left of anything after that many. Axial waves that a step does not
/// resolve alternate for some tens of steps at a start, and are damped.
///
/// Source: Cardona & Géradin (1989), Comput. Struct. 33, 801-820; Arnold & Brüls (2007), Multibody
/// Syst. Dyn. 18, 185-202.
class MultiplierWatch {
 public:
  static constexpr int kSteps = 100;         ///< of equal length
  static constexpr double kNoticed = 0.005;  ///< amplitude, of the row's largest multiplier

  /// After an accepted step of length h.
  void see(const Model& model, const State& x, double h);
  const std::optional<Alternation>& found() const { return found_; }
  void remember(Memory& memory, const Model& model);

 private:
  void begin(const Model& model, const State& x, double h);

  int version_ = -1, steps_ = 0;
  double h_ = 0;
  VectorXd last_, before_, difference_, largest_;
  std::vector<int> in_a_row_;
  std::optional<Alternation> found_;
};

/// Equal steps that Newton's method did not solve and that were cut.
struct CutSteps {
  int number = 0;       ///< accepted steps shorter than they were meant to be
  double since = 0;     ///< time of the first [s]
  double shortest = 0;  ///< [s]
};

}  // namespace flexmorph::fem
