#pragma once

#include <deque>
#include <optional>
#include <vector>

#include "optim/mmc/problem/body_problem.h"

namespace flexmorph::mmc {

/// The exact union of a list of components, and its properties under the loads of a body. The
/// results for the last few lists are stored: for a list that differs from a stored one by few
/// components, only the cells that these components cover are computed again.
class CrispUnion {
 public:
  /// Creates an evaluator; `problem` and `loads` must outlive it.
  CrispUnion(const BodyProblem& problem, ComplianceEvaluator& loads);

  /// Returns the regions of the exact union.
  const std::vector<Region>& regions(const std::vector<Component>& of);
  /// Returns the area fractions of the cells (n_cells).
  const VectorXd& fractions(const std::vector<Component>& of);
  /// Returns the compliance of the union, see design_compliance() [J].
  double compliance(const std::vector<Component>& of);
  /// Returns how the material of the union connects loads and supports.
  Connectivity connectivity(const std::vector<Component>& of);
  /// Returns the smallest widths of the union without fillets.
  Features features(const std::vector<Component>& of);
  /// Returns the strain energy of full material in every cell, divided by the mean of the design
  /// (n_cells).
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
