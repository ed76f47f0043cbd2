#pragma once

#include <limits>
#include <memory>
#include <optional>
#include <vector>

#include "geometry/components/tdf.h"
#include "geometry/parts/picture.h"
#include "optim/mmc/loads/compliance_evaluator.h"
#include "optim/mmc/problem/design.h"
#include "optim/mmc/problem/ersatz.h"
#include "optim/mmc/problem/goal.h"
#include "optim/mmc/problem/shape_limits.h"
#include "optim/problem.h"

namespace flexmorph::mmc {

class CrispPicture;

/// What a design problem is about: `design`, `ersatz`, `loads` and `shape` live longer than the
/// problem.
struct DesignedPlate {
  const Plate& plate;
  const Design& design;
  const Ersatz& ersatz;
  ComplianceEvaluator& loads;
  ShapeLimits* shape = nullptr;
  const MotionSeat* motion = nullptr;  ///< where rows of the goal ask for it
  /// Makes cells of what the outlines enclose, in place of the regularized design; null: this one.
  const CrispPicture* crisp = nullptr;
  /// Limits on responses of the loads are on those of this picture of the design; null: on those of
  /// the regularized one.
  const CrispPicture* limited = nullptr;
};

/// The design problem of one plate under given loads, P (34) in the variables of a Design: a row of
/// the table of responses is minimized, others are limited.
///
///   min log f        or f / f_full     f the objective, f_full its value in the full plate
///   s.t.  log g - log g_max <= 0       or g / g_max - 1 <= 0        for every limit
///
/// (`at_least`: the same with the other sign.) Limits that hold of the crisp design have its value
/// g_c and the slope of the regularized one, g_c/g ∇g: the point where such a problem ends meets
/// the KKT conditions of the regularized problem whose limit is g_max g/g_c. The slope of g_c
/// itself would lead to designs whose regularized stiffness profits most from the grid.
///
///  The logarithm is that of rows whose values span
/// decades in the first iterations: compliances. A row with a value per load has a constraint for
/// each of them; as the objective it is bounded by one more variable, log z / 10:
///
///   min log z        s.t.  ...,  log f_l - log z <= 0
///
/// so that a move limit of 0.05 is a factor of 1.6. One state solve serves values and gradients of
/// all rows that ask for the state; where none does, none is solved.
class MmcProblem final : public optim::Problem {
 public:
  /// @param places  as those of connectivity()
  MmcProblem(const DesignedPlate& plate, const TdfSettings& tdf, Goal goal,
             std::vector<HeldOrLoaded> places = {});

  int n_variables() const override { return design_.n_variables() + (bounded() ? 1 : 0); }
  /// Those of the limits in their order, then those of the bound, then those of the shape.
  int n_constraints() const override;
  VectorXd lower() const override;
  VectorXd upper() const override;
  /// Where the objective is bounded this solves the state: the bound starts at the largest value.
  VectorXd start() const override { return start_; }
  optim::Response evaluate(const VectorXd& x) override;
  /// Of fixed cold loads and sums over cells, with the TDF `distance`.
  bool has_curvature() const override;
  MatrixXd curvature(const VectorXd& x, double sigma, const VectorXd& lambda) override;
  /// Tells whether one piece of material, regularized links included, joins all places, or the
  /// design carries its loads about as well as uniform material of the allowed volume all the same.
  bool acceptable(const VectorXd& x) override;
  /// Components are those of x; values and factors are not known until evaluate().
  void recall(const VectorXd& x);
  /// The factors of a design alone, as far as the motion of the mechanism asks for them.
  void look(const VectorXd& x);
  /// Derivatives of the objective by the parameters of all components, images included (7 N), after
  /// evaluate().
  const VectorXd& objective_slopes() const { return entries_.front().slope; }
  /// Derivatives by the variables of any number that has these by the factors, after look().
  VectorXd slope_of(const CellFactors& by_factors);
  const MotionSeat* motion() const { return motion_; }

  bool is_solved() const { return solved_; }  ///< are values those of x()?

  const Goal& goal() const { return goal_; }
  /// First constraint of a limit.
  int row_of(size_t limit) const;

  // What the last evaluate() saw.
  const VectorXd& x() const { return x_; }
  VectorXd design_part(const VectorXd& x) const { return x.head(design_.n_variables()); }
  /// Of compliance_row(), the weighted sum or the largest; NaN where no row asks for the state.
  const ComplianceEvaluator::Value& value() const { return state_.value(); }
  double compliance() const { return value().f; }
  double volume() const { return volume_; }
  /// Values of a row of the goal (1, or n_loads); nothing for other rows.
  std::optional<VectorXd> values(const ResponseRow& row) const;
  const std::vector<Component>& components() const { return components_; }
  const CellFactors& factors() const { return factors_; }
  const VectorXd& phi() const { return tdf_.phi(); }
  double band() const { return tdf_.settings().band; }
  // CPU seconds of all evaluations since clear_seconds().
  double seconds_tdf() const { return seconds_tdf_; }  ///< TDF and chain rule
  ComplianceEvaluator::Seconds seconds() const { return state_.seconds(); }
  void clear_seconds();

 private:
  /// A row of the goal at the last design.
  struct Entry {
    const ResponseRow* row;
    std::unique_ptr<Response> response;
    Values values;
    VectorXd slope;                 // of its only value by the parameters of components, or
    MatrixXd slopes;                // of many by the variables of the design (m x n)
    std::optional<VectorXd> crisp;  // values of the crisp design, where limits are on these
  };

  bool bounded() const { return goal_.objective->per_load; }
  int count(const ResponseRow& row) const { return row.per_load ? state_.n_loads() : 1; }
  const Entry& entry(const ResponseRow& row) const;
  void solve(const VectorXd& x);
  double uniform_compliance();
  void look_at_limits();
  void pull_back(Entry& entry);
  /// Derivatives by the factors of the cells of the crisp design (m x n_cells) -> by the parameters
  /// of components (m x 7 N). An empty d_mass stands for zeros.
  MatrixXd pull_back_crisp(const MatrixXd& d_stiffness, const MatrixXd& d_mass) const;
  /// What the rows add to the second derivatives of a Lagrangian.
  struct Lagrangian {
    VectorXd d_stiffness, d_mass;  ///< of the weighted values, by the factors
    double of_sum = 0;             ///< weight of the summed compliance
    VectorXd of_each;              ///< of every load's (n_loads), or empty
    MatrixXd outer;                ///< of logarithms: - w ∇log f ∇log fᵀ (n x n)
  };
  void add_row(const Entry& entry, const VectorXd& weights, bool logarithm, Lagrangian& out) const;
  VectorXd gradient(const Entry& entry, double divisor) const;
  void add_each(const Entry& entry, double bound, int first_row, optim::Response& out) const;
  void add_limit(const Limit& limit, int first_row, optim::Response& out) const;
  void add_objective(optim::Response& out) const;
  void add_shape(optim::Response& out);

  Plate plate_;
  const Design& design_;
  const Ersatz& ersatz_;
  DesignState state_;
  ShapeLimits* shape_;
  const MotionSeat* motion_;
  const CrispPicture *crisp_, *limited_;
  std::unique_ptr<const Eigen::SparseMatrix<double>> crisp_slopes_;  // at the last design
  UnionTdf tdf_;
  Goal goal_;
  std::vector<Entry> entries_;  // the objective first
  std::vector<HeldOrLoaded> places_;
  VectorXd start_;
  std::vector<Component> components_;
  CellFactors factors_;
  VectorXd x_, d_stiffness_, d_mass_, d_h_, d_eroded_, zero_;
  MatrixXd many_by_h_, many_by_eroded_;
  ShapeLimits::Values outline_;
  double volume_ = 0, seconds_tdf_ = 0;
  bool solved_ = false, differentiated_ = false;
  std::optional<double> uniform_;  // compliance of uniform material, once it was asked for
};

}  // namespace flexmorph::mmc
