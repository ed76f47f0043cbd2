#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "fem/esl_set.h"
#include "fem/solve/plate_solver.h"
#include "optim/mmc/held_expansion.h"
#include "optim/mmc/load_response.h"

namespace flexmorph::mmc {

/// What acts on the plate at the same time: nodal forces, and heat.
struct LoadCase {
  std::string name;
  double weight = 1;
  std::vector<fem::NodalForce> forces;
  /// a = α ΔT of the whole plate: free, it is 1 + a times as large [-]
  double thermal_stretch = 0;
};

/// The statics of a plate at rest: loads that do not follow the design, one set of supports for all
/// of them. Derivatives by the mass factors vanish.
///
/// A hot plate is held where it was while cold, u = 0: supports prescribe the elastic displacement
/// w_c = -a (X - X₀, Y - Y₀) of the held components, X₀ any point. A rigid motion ρ takes off what
/// it can of that (least squares, small rotation), so that supports that let the plate grow cost
/// nothing, and what is left makes thermal stress (HeldExpansion).
class FixedLoads final : public LoadResponse {
 public:
  /// @param outside   cells outside of the domain, see PlateSolver
  /// @param compress  the weighted sum depends on Σ w F Fᵀ only: evaluate() solves as many
  ///        right-hand sides as that has directions (optim/README.md, Compression)
  /// @throws Error (input) for no loads, loads that are zero or act where nothing can move, heat
  ///         alone on a plate that its supports let grow, weights that are not positive.
  FixedLoads(const Grid& grid, const fem::PlaneSection& section,
             std::span<const signed char> outside, std::span<const fem::HeldUnknown> held,
             std::span<const LoadCase> loads, bool compress);

  void evaluate(const VectorXd& stiffness, const VectorXd& mass, Value& value) override;
  void evaluate_each(const VectorXd& stiffness, const VectorXd& mass, Each& each) override;
  bool has_curvature() const override { return stretch_.size() == 0; }
  MatrixXd curvature(const VectorXd& stiffness, const Eigen::SparseMatrix<double>& directions,
                     const VectorXd& weights) override;
  VectorXd individual(const VectorXd& stiffness, const VectorXd& mass) override;
  VectorXd displacement(const VectorXd& stiffness, const VectorXd& mass, int load) override;

  int n_loads() const override { return static_cast<int>(loads_.rows()); }
  int n_right_hand_sides() const override {
    return static_cast<int>(solved_.rows()) + (held_ ? held_->n_lines() : 0);
  }
  int factorizations() const override { return factorizations_; }
  double condition() const override { return solver_.condition(); }
  Seconds seconds() const override { return seconds_; }

 private:
  void factorize(const VectorXd& stiffness);
  void warm_up(const fem::PlaneSection& section, std::span<const signed char> outside,
               std::span<const fem::HeldUnknown> held, std::span<const LoadCase> loads);
  HeldExpansion& held_at(const VectorXd& stiffness);

  fem::PlateSolver solver_;
  MatrixXd loads_;   // F (n_loads x n_unknowns)
  MatrixXd solved_;  // what evaluate() solves: loads, or the leading combinations of sqrt(w) F
  VectorXd solved_weights_, factored_, energies_;
  MatrixXd u_;
  std::optional<HeldExpansion> held_;  // where supports hold back the growth of a hot plate
  VectorXd stretch_;                   // a of each load; empty when all are cold
  VectorXd growth_;                    // e + ρ of one unit (2 n_nodes) [m]
  int factorizations_ = 0;
  Seconds seconds_;
};

}  // namespace flexmorph::mmc
