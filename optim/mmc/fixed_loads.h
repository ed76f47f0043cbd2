#pragma once

#include <memory>
#include <span>
#include <string>
#include <vector>

#include "fem/esl_set.h"
#include "fem/solve/plate_solver.h"
#include "optim/mmc/load_response.h"

namespace flexmorph::mmc {

/// Nodal forces that act at the same time.
struct LoadCase {
  std::string name;
  double weight = 1;
  std::vector<fem::NodalForce> forces;
};

/// The statics of a plate at rest: loads that do not follow the design, one set of supports for all
/// of them. Derivatives by the mass factors vanish.
class FixedLoads final : public LoadResponse {
 public:
  /// @param outside   cells outside of the domain, see PlateSolver
  /// @param compress  the weighted sum depends on Σ w F Fᵀ only: evaluate() solves as many
  ///        right-hand sides as that has directions (design.md section 9)
  /// @throws Error (input) for no loads, loads that are zero or act where nothing can move, weights
  ///         that are not positive.
  FixedLoads(const Grid& grid, const fem::PlaneSection& section,
             std::span<const signed char> outside, std::span<const fem::HeldUnknown> held,
             std::span<const LoadCase> loads, bool compress);

  void evaluate(const VectorXd& stiffness, const VectorXd& mass, Value& value) override;
  void evaluate_each(const VectorXd& stiffness, const VectorXd& mass, Each& each) override;
  VectorXd individual(const VectorXd& stiffness, const VectorXd& mass) override;
  VectorXd displacement(const VectorXd& stiffness, const VectorXd& mass, int load) override;

  int n_loads() const override { return static_cast<int>(loads_.rows()); }
  int n_right_hand_sides() const override { return static_cast<int>(solved_.rows()); }
  int factorizations() const override { return factorizations_; }
  Seconds seconds() const override { return seconds_; }

 private:
  void factorize(const VectorXd& stiffness);

  fem::PlateSolver solver_;
  MatrixXd loads_;   // F (n_loads x n_unknowns)
  MatrixXd solved_;  // what evaluate() solves: loads, or the leading combinations of sqrt(w) F
  VectorXd solved_weights_, factored_, energies_;
  MatrixXd u_;
  int factorizations_ = 0;
  Seconds seconds_;
};

}  // namespace flexmorph::mmc
