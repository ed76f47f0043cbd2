#pragma once

#include <limits>
#include <vector>

#include "geometry/tdf.h"
#include "optim/mmc/design.h"
#include "optim/mmc/ersatz.h"
#include "optim/mmc/load_response.h"
#include "optim/problem.h"

namespace flexmorph::mmc {

/// What a design is to be good at.
struct Goal {
  enum class Minimize { compliance, volume };
  enum class Over {
    sum,   ///< Σ w_l C_l
    worst  ///< max C_l, by the bound formulation: one more variable bounds them all
  };
  Minimize minimize = Minimize::compliance;
  Over over = Over::sum;
  double max_volume = 0.5;    ///< fraction of the domain; what compliance is minimized under
  double max_compliance = 0;  ///< [J]; what volume is minimized under
};

/// The design problem of one plate under given loads, P (34) in the variables of a Design:
///
///   compliance, sum     min log f            s.t.  V/V_max - 1 <= 0
///   compliance, worst   min log z            s.t.  V/V_max - 1 <= 0,  log C_l - log z <= 0
///   volume, sum         min V                s.t.  log f   - log C_max <= 0
///   volume, worst       min V                s.t.  log C_l - log C_max <= 0
///
/// f is the weighted compliance of all loads, V the mean of the mass factors over the domain. The
/// logarithm, because f spans decades in the first iterations. One state solve serves values and
/// gradients. In a worst case the last variable is log z / 10: a move limit of 0.05 is a factor of
/// 1.6 in compliance.
class MmcProblem final : public optim::Problem {
 public:
  /// @param places  cells of every loaded and every held place, see connectivity()
  MmcProblem(const Grid& grid, const Design& design, const Ersatz& ersatz, LoadResponse& loads,
             const TdfSettings& tdf, const Goal& goal, std::vector<std::vector<int>> places = {});

  int n_variables() const override { return design_.n_variables() + (bounded() ? 1 : 0); }
  int n_constraints() const override;
  VectorXd lower() const override;
  VectorXd upper() const override;
  /// In a worst case this solves the state: the bound starts at the largest compliance.
  VectorXd start() const override { return start_; }
  optim::Response evaluate(const VectorXd& x) override;
  /// Does one piece of material, blurred links included, join all places, or does the design carry
  /// its loads about as well as the best one all the same?
  bool acceptable(const VectorXd& x) override;

  const Goal& goal() const { return goal_; }

  // What the last evaluate() saw.
  const VectorXd& x() const { return x_; }
  VectorXd design_part(const VectorXd& x) const { return x.head(design_.n_variables()); }
  const LoadResponse::Value& value() const { return value_; }
  double compliance() const { return value_.f; }  ///< weighted sum, or the largest
  double volume() const { return volume_; }
  const VectorXd& load_compliances() const { return each_.f; }  ///< of a worst case (n_loads)
  const std::vector<Component>& components() const { return components_; }
  const CellFactors& factors() const { return factors_; }
  const VectorXd& phi() const { return tdf_.phi(); }
  double band() const { return tdf_.settings().band; }
  // CPU seconds of all evaluations since clear_seconds().
  double seconds_tdf() const { return seconds_tdf_; }  ///< TDF and chain rule
  LoadResponse::Seconds seconds() const { return seconds_; }
  void clear_seconds();

 private:
  bool bounded() const {
    return goal_.over == Goal::Over::worst && goal_.minimize == Goal::Minimize::compliance;
  }
  void solve(const VectorXd& x);
  VectorXd gradient(const VectorXd& d_stiffness, const VectorXd& d_mass, double divisor);
  void fill_compliance_rows(optim::Response& out, int first_row, double bound);

  Grid grid_;
  const Design& design_;
  const Ersatz& ersatz_;
  LoadResponse& loads_;
  UnionTdf tdf_;
  Goal goal_;
  std::vector<std::vector<int>> places_;
  VectorXd start_;
  std::vector<Component> components_;
  CellFactors factors_;
  LoadResponse::Value value_;
  LoadResponse::Each each_;
  LoadResponse::Seconds seconds_;
  VectorXd x_, d_h_, d_eroded_, zero_, share_;
  MatrixXd each_by_h_, each_by_eroded_, each_by_parameters_;
  double volume_ = 0, seconds_tdf_ = 0;
  double lowest_ = std::numeric_limits<double>::infinity();  // compliance of acceptable designs
};

}  // namespace flexmorph::mmc
