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

/// The parts that a design problem consists of. `design`, `ersatz`, `loads` and `shape` must live
/// longer than the problem.
struct DesignedPlate {
  const Plate& plate;            ///< The plate that is designed.
  const Design& design;          ///< Design variables with their scaling and bounds.
  const Ersatz& ersatz;          ///< Map from nodal Heaviside values to scale factors of the cells.
  ComplianceEvaluator& loads;    ///< Evaluator of the compliances under the loads.
  ShapeLimits* shape = nullptr;  ///< Constraints on the outline; null if there are none.

  /// Body index in the coupled problem, with the motion of the mechanism; null if no response of
  /// the goal is one of the motion.
  const CoupledMotion* motion = nullptr;
  /// Crisp geometry whose area fractions replace the regularized design in all responses; null for
  /// the regularized design.
  const CrispPicture* crisp = nullptr;
  /// Crisp geometry for which limits on responses of the loads hold; null if they hold for the
  /// regularized design.
  const CrispPicture* limited = nullptr;
};

/// The design problem of one plate under given loads, P (34), in the variables of a Design. One
/// response is minimized, others are bounded.
///
///   min log f        or f / f_full     f the objective, f_full its value in the full plate
///   s.t.  log g - log g_max <= 0       or g / g_max - 1 <= 0        for every limit
///
/// Lower bounds (`at_least`) have the opposite sign. A limit that holds for the crisp design uses
/// the crisp value g_c and the gradient g_c/g ∇g, where g is the regularized response. A solution
/// of such a problem satisfies the KKT conditions of the regularized problem whose limit is g_max
/// g/g_c. The gradient of g_c itself would lead to designs whose regularized stiffness profits most
/// from the grid.
///
/// The logarithm is used for responses whose values span decades in the first iterations, which are
/// compliances. A response with one value per load has one constraint for each load; as the
/// objective it is bounded by one more variable, log z / 10:
///
///   min log z        s.t.  ...,  log f_l - log z <= 0
///
/// so that a move limit of 0.05 corresponds to a factor of 1.6. One state solve provides values and
/// gradients of all responses that need the state; it is omitted when no response needs it.
class MmcProblem final : public optim::Problem {
 public:
  /// Creates the problem, and solves the state at the start if the objective has one value per
  /// load.
  /// @param tdf     settings of the topology description function
  /// @param locations  supported and loaded locations, see connectivity()
  MmcProblem(const DesignedPlate& plate, const TdfSettings& tdf, Goal goal,
             std::vector<HeldOrLoaded> locations = {});

  int n_variables() const override { return design_.n_variables() + (bounded() ? 1 : 0); }
  /// Returns the number of constraints. Their order is: the limits of the goal, the bounds of an
  /// objective with one value per load, the constraints on the outline.
  int n_constraints() const override;
  VectorXd lower() const override;
  VectorXd upper() const override;
  /// Returns the initial variables. The variable that bounds an objective with one value per load
  /// starts at the largest value.
  VectorXd start() const override { return start_; }
  optim::ProblemValues evaluate(const VectorXd& x) override;
  /// Returns true if all responses are sums over cells or compliances under loads that have second
  /// derivatives, and the TDF is `distance`; crisp geometry and constraints on the outline have
  /// none.
  bool has_curvature() const override;
  MatrixXd curvature(const VectorXd& x, double sigma, const VectorXd& lambda) override;
  /// Returns true if material, including regularized cells of low density, connects every load to a
  /// support, or if the compliance of the design is nevertheless comparable to that of uniform
  /// material of the allowed volume.
  bool acceptable(const VectorXd& x) override;
  /// Sets the components to those of x without an evaluation. Values and scale factors are not
  /// valid until the next evaluate().
  void restore(const VectorXd& x);
  /// Computes the scale factors of the design x without a state solve, and passes them to the
  /// motion state of the mechanism.
  void look(const VectorXd& x);
  /// Returns the derivatives of the objective by the parameters of all components, mirror images
  /// included (7 N), after evaluate() of an objective with one value.
  const VectorXd& objective_gradient() const { return entries_.front().slope; }
  /// Returns the gradient by the design variables of a function, after look().
  /// @param d_factors  derivatives of the function by the scale factors of the cells
  VectorXd pull_back_scale_factors(const CellScaleFactors& d_factors);
  /// Returns the body index in the coupled problem with its motion; null if there is no motion.
  const CoupledMotion* motion() const { return motion_; }

  /// Returns true if the values of the responses belong to x().
  bool is_solved() const { return solved_; }

  /// Returns the objective and the limits of the problem.
  const Goal& goal() const { return goal_; }
  /// Returns the index of the first constraint of a limit.
  int row_of(size_t limit) const;

  /// Returns the variables of the last evaluate(), look() or recall().
  const VectorXd& x() const { return x_; }
  /// Returns the design variables in a vector of all variables.
  VectorXd design_part(const VectorXd& x) const { return x.head(design_.n_variables()); }
  /// Returns the compliance of compliance_row() with its derivatives, for one value per load the
  /// largest one; the compliance is NaN if no response needs the state.
  const ComplianceEvaluator::Value& value() const { return state_.value(); }
  /// Returns the compliance of the last evaluation [J]: the weighted sum or the largest one.
  double compliance() const { return value().f; }
  /// Returns the volume fraction of the last design in the domain [-].
  double volume() const { return volume_; }
  /// Returns the last values of a response of the goal (1, or n_loads); nothing for other
  /// responses.
  std::optional<VectorXd> values(const ResponseRow& row) const;
  /// Returns the components of the last design, mirror images included.
  const std::vector<Component>& components() const { return components_; }
  /// Returns the scale factors of stiffness and mass of the cells at the last design.
  const CellScaleFactors& factors() const { return factors_; }
  /// Returns the nodal values φ of the TDF at the last design (n_nodes).
  const VectorXd& phi() const { return tdf_.phi(); }
  /// Returns the half-width ε of the band of the Heaviside function.
  double band() const { return tdf_.settings().band; }
  /// Returns the CPU seconds of TDF and chain rule since clear_seconds().
  double seconds_tdf() const { return seconds_tdf_; }
  /// Returns the CPU seconds of state solves since clear_seconds().
  ComplianceEvaluator::Seconds seconds() const { return state_.seconds(); }
  /// Resets all CPU seconds to zero.
  void clear_seconds();

 private:
  /// A response of the goal with its result at the last design.
  struct Entry {
    const ResponseRow* row;
    std::unique_ptr<Response> response;
    Values values;
    // Gradient by the component parameters, for a response with one value (7 N).
    VectorXd slope;
    // Gradients by the design variables, for a response with one value per load (m x n).
    MatrixXd slopes;
    std::optional<VectorXd> crisp;  // values of the crisp design, where limits hold for it
  };

  bool bounded() const { return goal_.objective->per_load; }
  int count(const ResponseRow& row) const { return row.per_load ? state_.n_loads() : 1; }
  const Entry& entry(const ResponseRow& row) const;
  void solve(const VectorXd& x);
  double uniform_compliance();
  void analyse_limits();
  void pull_back(Entry& entry);
  /// Converts derivatives by the scale factors of the crisp design (m x n_cells) into derivatives
  /// by the component parameters (m x 7 N). An empty d_mass stands for zeros.
  MatrixXd pull_back_crisp(const MatrixXd& d_stiffness, const MatrixXd& d_mass) const;
  /// Contributions of the responses to the second derivatives of a Lagrangian.
  struct Lagrangian {
    VectorXd d_stiffness, d_mass;  ///< Derivatives of the weighted values by the scale factors.
    double of_sum = 0;             ///< Weight of the summed compliance.
    VectorXd of_each;              ///< Weights of the compliances (n_loads), or empty.
    MatrixXd outer;                ///< Terms - w ∇log f ∇log fᵀ of logarithms (n x n).
  };
  void add_row(const Entry& entry, const VectorXd& weights, bool logarithm, Lagrangian& out) const;
  VectorXd gradient(const Entry& entry, double divisor) const;
  void add_each(const Entry& entry, double bound, int first_row, optim::ProblemValues& out) const;
  void add_limit(const Limit& limit, int first_row, optim::ProblemValues& out) const;
  void add_objective(optim::ProblemValues& out) const;
  void add_shape(optim::ProblemValues& out);

  Plate plate_;
  const Design& design_;
  const Ersatz& ersatz_;
  DesignState state_;
  ShapeLimits* shape_;
  const CoupledMotion* motion_;
  const CrispPicture *crisp_, *limited_;
  std::unique_ptr<const Eigen::SparseMatrix<double>> crisp_gradient_;  // at the last design
  UnionTdf tdf_;
  Goal goal_;
  std::vector<Entry> entries_;  // the objective is the first entry
  std::vector<HeldOrLoaded> locations_;
  VectorXd start_;
  std::vector<Component> components_;
  CellScaleFactors factors_;
  VectorXd x_, d_stiffness_, d_mass_, d_h_, d_eroded_, zero_;
  MatrixXd many_by_h_, many_by_eroded_;
  ShapeLimits::Values outline_;
  double volume_ = 0, seconds_tdf_ = 0;
  bool solved_ = false, differentiated_ = false;
  double bound_unit_ = 1;          // largest value of a bounded objective at the start [J]
  std::optional<double> uniform_;  // compliance of uniform material, computed at first use [J]
};

}  // namespace flexmorph::mmc
