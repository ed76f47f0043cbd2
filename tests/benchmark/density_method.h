#pragma once

#include <Eigen/SparseCore>
#include <vector>

#include "optim/mmc/problem/body_problem.h"
#include "optim/optimizer.h"

/// A density method as an alternative to components: a density for every cell, filtered and
/// projected. It designs the problem of a case under equal loads on equal cells, so that both can
/// be compared.
namespace flexmorph::benchmark {

/// The cells of a body that a density method designs.
struct DensityPlate {
  mmc::Plate plate;
  std::vector<signed char> given;  ///< 1: material, -1: void, 0: designed (n_cells).
  /// Largest fraction of the domain that is material, including given material.
  double volume = 0;
  bool worst = false;  ///< True if the largest compliance is minimized, false for the weighted sum.

  bool designs(int cell) const { return given[static_cast<std::size_t>(cell)] == 0; }
};
/// @throws Error (input) if the goal is not the least compliance of some volume.
DensityPlate density_plate(const mmc::BodyProblem& problem);

/// One step of the continuation.
struct DensityStage {
  double penalty = 3;      ///< p: the stiffness is ρ^p.
  double projection = 1;   ///< β: steepness of the projection.
  double threshold = 0.5;  ///< η of the stiffness: above 1/2 it is that of an eroded design.
  int iterations = 80;
};
/// Returns stages in which the penalty grows first while the projection is flat; then the
/// projection doubles, up to 32. (Half as many iterations gave up to 0.9 % more compliance, twice
/// as many the same; steeper projections only move outlines towards the sides of cells.)
/// @param threshold  threshold of the stiffness, from β = 2 on
std::vector<DensityStage> density_stages(double threshold = 0.5);

struct DensitySettings {
  double radius = 2;  ///< Radius of the filter [cells].
  std::vector<DensityStage> stages = density_stages();
  double move_limit = 0.05;
};

/// Densities of all cells (n_cells), 0 outside of the domain.
struct Densities {
  VectorXd filtered, projected;
  VectorXd stiff;  ///< Densities projected about the threshold of the stiffness.
};

/// Returns the weights of the density filter: x̃_c = Σ w_cd x_d / Σ w_cd, w_cd = max(0, R - |X_c -
/// X_d|) over the cells d of the domain (n_cells x n_cells, rows outside of the domain are empty).
/// Source: Bruns & Tortorelli (2001), CMAME 190, 3443-3459.
/// @param radius  R [m]
Eigen::SparseMatrix<double> density_filter(const mmc::Plate& plate, double radius);

/// min log C(ρ), V(ρ) / V_max <= 1 over the densities x of the designed cells, 0 <= x <= 1.
///
///   x̃ = W x                                                      density_filter()
///   ρ(η) = (tanh βη + tanh β(x̃ - η)) / (tanh βη + tanh β(1 - η))    given cells: 1 or 0
///   stiffness factor = ε + (1 - ε) ρ(η)^p,   mass factor, volume = ρ(1/2),   ε = 1e-6
///
/// η > 1/2 prevents members so thin that an outline cuts them. If the largest compliance is
/// minimized there is one more variable, as in mmc::MmcProblem.
/// Source: Wang, Lazarov & Sigmund (2011), SMO 43, 767-784, for the projection.
class DensityProblem final : public optim::Problem {
 public:
  /// All referenced objects must outlive this one.
  /// @param start  x (n_designed)
  DensityProblem(const DensityPlate& plate, const Eigen::SparseMatrix<double>& filter,
                 mmc::ComplianceEvaluator& loads, const DensityStage& stage, VectorXd start);

  int n_variables() const override { return static_cast<int>(start_.size()); }
  int n_constraints() const override { return 1 + (plate_.worst ? loads_.n_loads() : 0); }
  VectorXd lower() const override;
  VectorXd upper() const override;
  VectorXd start() const override { return start_; }
  optim::ProblemValues evaluate(const VectorXd& x) override;

  int n_designed() const { return static_cast<int>(designed_.size()); }
  Densities densities(const VectorXd& x) const;

 private:
  mmc::CellScaleFactors factors(const Densities& at) const;
  VectorXd slope(const Densities& at, const VectorXd& d_stiffness, const VectorXd& d_mass) const;
  void add_loads(const Densities& at, const mmc::CellScaleFactors& cells, double bound,
                 optim::ProblemValues& out);

  const DensityPlate& plate_;
  const Eigen::SparseMatrix<double>& filter_;
  mmc::ComplianceEvaluator& loads_;
  DensityStage stage_;
  std::vector<int> designed_;  // cells of the variables
  VectorXd start_;
};

/// Result of a stage.
struct DensityDesign {
  DensityStage stage;
  Densities densities;
  double compliance = 0;  ///< Compliance on the cells [J].
  int iterations = 0;     ///< Number of iterations of all stages so far.
  double seconds = 0;     ///< CPU time of all stages so far [s].
};
/// Runs the continuation from a uniform density, by the method of moving asymptotes.
/// @returns the results of all stages
/// @throws Error (numerical) from the static analysis
std::vector<DensityDesign> design_by_densities(const DensityPlate& plate,
                                               mmc::ComplianceEvaluator& loads,
                                               const DensitySettings& settings);

}  // namespace flexmorph::benchmark
