#pragma once

#include <deque>
#include <optional>
#include <vector>

#include "optim/mmc/problem/body_problem.h"

namespace flexmorph::mmc {

/// What the outlines of lists of components enclose under the loads of a body. The last lists that
/// were asked for are remembered: the area fractions of a list that differs by few components cost
/// what these cover.
class CrispUnion {
 public:
  /// @param problem, loads  live longer
  CrispUnion(const BodyProblem& problem, ComplianceEvaluator& loads);

  /// Exact union.
  const std::vector<Region>& regions(const std::vector<Component>& of);
  /// Area fractions of cells (n_cells).
  const VectorXd& fractions(const std::vector<Component>& of);
  double compliance(const std::vector<Component>& of);
  Connectivity connectivity(const std::vector<Component>& of);
  /// Smallest widths of the union, without fillets.
  Features features(const std::vector<Component>& of);
  /// Energy of full material in every cell by the mean one of the design (n_cells).
  VectorXd energy_density(const std::vector<Component>& of);

 private:
  struct Known {
    std::vector<Component> of;
    std::optional<std::vector<Region>> regions;
    std::optional<VectorXd> fractions;
  };
  Known& known(const std::vector<Component>& of);

  const BodyProblem& problem_;
  ComplianceEvaluator& loads_;
  Ersatz ersatz_;
  std::deque<Known> known_;  // newest first
};

}  // namespace flexmorph::mmc
