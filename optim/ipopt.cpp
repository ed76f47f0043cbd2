#include <IpoptConfig.h>

#include <IpIpoptApplication.hpp>
#include <IpTNLP.hpp>
// Before version 3.14 only internal classes of Ipopt give access to the current iterate.
#define FLEXMORPH_IPOPT_TELLS_ITERATE (IPOPT_VERSION_MAJOR * 100 + IPOPT_VERSION_MINOR >= 314)
#if !FLEXMORPH_IPOPT_TELLS_ITERATE
#include <IpIpoptCalculatedQuantities.hpp>
#include <IpIpoptData.hpp>
#include <IpOrigIpoptNLP.hpp>
#include <IpTNLPAdapter.hpp>
#endif
#include <algorithm>
#include <deque>

#include "optim/kkt.h"
#include "optim/makers.h"
#include "optim/moving_box.h"
#include "optim/mpi_start.h"
#include "optim/search.h"

/// Ipopt: interior point method with a filter line search. It uses second derivatives if the
/// problem has them, limited-memory BFGS otherwise.
///
/// Options:
///   exact       1: second derivatives of problems that have them; 0: limited-memory BFGS
///   mu_init     first barrier parameter; 0 (default): 1e-5 with second derivatives, 1e-3 without
///   bound_push  distance by which the start is moved inside its bounds
///   history     number of vectors of the limited-memory Hessian
///   box         half width of a moving box, absolute in x; 0 (default): no box
///   restart     number of iterations inside one box
///
/// The problems are far from convex: the Hessians are indefinite until the last few iterations, and
/// Ipopt adds multiples of the unit matrix to make them definite. Therefore three options differ
/// from their defaults when second derivatives are used. The filter accepts only designs that
/// violate constraints by less than a tenth (with a thousandth the steps stagnate in curved
/// valleys). The multiples grow by a factor of 4, not 8. The watchdog is off (optim/README.md,
/// Second derivatives). Replacing the eigenvalues by their absolute values did not converge faster.
///
/// The barrier parameter decreases monotonically, because the adaptive rule and SR1 ended at
/// infeasible designs on the published short beam. Two solves in two threads of one process crash
/// in Ipopt 3.11.
///
/// Source: Wächter & Biegler (2006), Math. Program. 106, 25-57; Ipopt 3.11.9.
namespace flexmorph::optim {
namespace {

using Ipopt::Index;
using Ipopt::Number;

constexpr double kInfinity = 2e19;      // Ipopt treats it as infinite
constexpr size_t kKeptEvaluations = 8;  // evaluations; they contain the current iterate
constexpr int kEvaluationsPerIteration = 2;
constexpr int kMaxRefusals = 20;  // in sequence; the step is then too small for progress

/// Exception that leaves Ipopt during an evaluation after the search has stopped.
struct Halt {};

struct Constants {
  double mu_init, bound_push, box;
  int history, restart;
  bool exact;
};

/// Adapter of the problem to the interface of Ipopt, within one box.
class Adapter final : public Ipopt::TNLP {
 public:
  Adapter(Search& search, const Point& start, const VectorXd& lower, const VectorXd& upper,
          int most_evaluations, bool curved)
      : search_(search),
        curved_(curved),
        start_(start.x),
        lower_(lower),
        upper_(upper),
        most_evaluations_(most_evaluations) {
    evaluated_.push_back(start);
  }

  bool get_nlp_info(Index& n, Index& m, Index& nnz_jac_g, Index& nnz_h_lag,
                    IndexStyleEnum& index_style) override {
    n = search_.n();
    m = search_.m();
    nnz_jac_g = n * m;
    nnz_h_lag = curved_ ? n * (n + 1) / 2 : 0;
    index_style = C_STYLE;
    return true;
  }

  bool get_bounds_info(Index n, Number* x_l, Number* x_u, Index m, Number* g_l,
                       Number* g_u) override {
    std::copy_n(lower_.data(), n, x_l);
    std::copy_n(upper_.data(), n, x_u);
    std::fill_n(g_l, m, -kInfinity);
    std::fill_n(g_u, m, 0.0);
    return true;
  }

  bool get_starting_point(Index n, bool, Number* x, bool init_z, Number*, Number*, Index,
                          bool init_lambda, Number*) override {
    std::copy_n(start_.data(), n, x);
    return !init_z && !init_lambda;
  }

  bool eval_f(Index n, const Number* x, bool, Number& value) override {
    const Point* point = analyse_at(n, x);
    if (point != nullptr) value = point->response.f;
    return point != nullptr;
  }

  bool eval_grad_f(Index n, const Number* x, bool, Number* gradient) override {
    const Point* point = analyse_at(n, x);
    if (point != nullptr) Eigen::Map<VectorXd>(gradient, n) = point->response.df;
    return point != nullptr;
  }

  bool eval_g(Index n, const Number* x, bool, Index m, Number* g) override {
    const Point* point = analyse_at(n, x);
    if (point != nullptr) Eigen::Map<VectorXd>(g, m) = point->response.g;
    return point != nullptr;
  }

  bool eval_jac_g(Index n, const Number* x, bool, Index m, Index, Index* row, Index* column,
                  Number* values) override {
    using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
    if (values == nullptr) {
      for (Index i = 0; i < m * n; ++i) {
        row[i] = i / n;
        column[i] = i % n;
      }
      return true;
    }
    const Point* point = analyse_at(n, x);
    if (point != nullptr) Eigen::Map<RowMajor>(values, m, n) = point->response.dg;
    return point != nullptr;
  }

  bool eval_h(Index n, const Number* x, bool, Number sigma, Index m, const Number* lambda, bool,
              Index, Index* row, Index* column, Number* values) override {
    Index k = 0;
    if (values == nullptr) {
      for (Index i = 0; i < n; ++i)
        for (Index j = 0; j <= i; ++j, ++k) {
          row[k] = i;
          column[k] = j;
        }
      return true;
    }
    const Eigen::Map<const VectorXd> at(x, n);
    const MatrixXd h = search_.curvature(at, sigma, Eigen::Map<const VectorXd>(lambda, m));
    for (Index i = 0; i < n; ++i)
      for (Index j = 0; j <= i; ++j, ++k) values[k] = h(i, j);
    return true;
  }

  bool intermediate_callback(Ipopt::AlgorithmMode mode, Index iteration, Number, Number, Number,
                             Number, Number, Number, Number, Number, Index,
                             const Ipopt::IpoptData* data,
                             Ipopt::IpoptCalculatedQuantities* quantities) override;

  void finalize_solution(Ipopt::SolverReturn, Index, const Number*, const Number*, const Number*,
                         Index, const Number*, const Number*, Number, const Ipopt::IpoptData*,
                         Ipopt::IpoptCalculatedQuantities*) override {}

 private:
  const Point* analyse_at(Index n, const Number* x);
  /// Reads the variables of the current iterate. @return true if Ipopt provides them
  bool read_current(const Ipopt::IpoptData* data, Ipopt::IpoptCalculatedQuantities* quantities,
                    VectorXd& x) const;

  Search& search_;
  bool curved_;
  VectorXd start_, lower_, upper_;
  int most_evaluations_;
  std::deque<Point> evaluated_;  // newest first
  VectorXd refused_;             // last refused design; eval_g requests it again
};

/// Returns the design at x; evaluates it unless it is stored. Null if the design was refused.
const Point* Adapter::analyse_at(Index n, const Number* x) {
  const Eigen::Map<const VectorXd> at(x, n);
  for (const Point& point : evaluated_) {
    if (point.x == at) return &point;
  }
  if (refused_.size() == n && refused_ == at) return nullptr;
  if (search_.evaluations() >= most_evaluations_) {
    search_.stop(Stop::iteration_limit,
                 "the limit of " + std::to_string(most_evaluations_) + " evaluations is reached");
  }
  search_.stop_when_spent();
  if (search_.stopped()) throw Halt{};
  Point trial{at, {}};
  if (search_.evaluate(trial.x, trial.response) != Trial::taken) {
    refused_ = trial.x;
    if (search_.refused_in_a_row() >= kMaxRefusals) {
      search_.stop(Stop::stalled,
                   std::to_string(kMaxRefusals) +
                       " steps in a row were rejected; the last reason: " + search_.refusal());
      throw Halt{};
    }
    return nullptr;
  }
  evaluated_.push_front(std::move(trial));
  if (evaluated_.size() > kKeptEvaluations) evaluated_.pop_back();
  return &evaluated_.front();
}

bool Adapter::read_current(const Ipopt::IpoptData* data,
                           Ipopt::IpoptCalculatedQuantities* quantities, VectorXd& x) const {
#if FLEXMORPH_IPOPT_TELLS_ITERATE
  return get_curr_iterate(data, quantities, false, search_.n(), x.data(), nullptr, nullptr,
                          search_.m(), nullptr, nullptr);
#else
  auto* nlp = dynamic_cast<Ipopt::OrigIpoptNLP*>(Ipopt::GetRawPtr(quantities->GetIpoptNLP()));
  auto* adapter =
      nlp == nullptr ? nullptr : dynamic_cast<Ipopt::TNLPAdapter*>(Ipopt::GetRawPtr(nlp->nlp()));
  if (adapter == nullptr) return false;
  adapter->ResortX(*data->curr()->x(), x.data());
  return true;
#endif
}

bool Adapter::intermediate_callback(Ipopt::AlgorithmMode mode, Index iteration, Number, Number,
                                    Number, Number, Number, Number, Number, Number, Index,
                                    const Ipopt::IpoptData* data,
                                    Ipopt::IpoptCalculatedQuantities* quantities) {
  if (mode != Ipopt::RegularMode || data == nullptr || quantities == nullptr) {
    return !search_.stopped();  // the restoration phase uses different variables
  }
  // The first iterate of a later box is the best design, which already has a row of the history.
  if (iteration == 0 && search_.rows() > 0) return true;
  VectorXd x(search_.n());
  if (!read_current(data, quantities, x))
    throw Error::numerical("ipopt: the current design cannot be read");
  const Point* point = analyse_at(search_.n(), x.data());
  return point == nullptr || search_.row(search_.rows() + 1, *point);
}

std::string name_of(Ipopt::ApplicationReturnStatus status) {
  switch (status) {
    case Ipopt::Solve_Succeeded:
    case Ipopt::Solved_To_Acceptable_Level:
      return "Ipopt reached its own tolerance";
    case Ipopt::Infeasible_Problem_Detected:
      return "Ipopt found no feasible design near the last design";
    case Ipopt::Search_Direction_Becomes_Too_Small:
      return "the steps of Ipopt became too small";
    case Ipopt::Maximum_Iterations_Exceeded:
      return "Ipopt reached its limit of iterations";
    case Ipopt::Restoration_Failed:
      return "the line search of Ipopt and its restoration phase failed";
    case Ipopt::Invalid_Number_Detected:
      return "Ipopt found no step to a design that can be evaluated";
    default:
      return "Ipopt ended with status " + std::to_string(status);
  }
}

class IpoptOptimizer final : public Optimizer {
 public:
  IpoptOptimizer(const Settings& settings, const Constants& constants)
      : settings_(settings), c_(constants) {}

  Result minimize(Problem& problem, const Observer& observe) override {
    Search search(problem, settings_, observe);
    search.start();
    search_in_boxes(search, c_.box,
                    [&](const Point& start, const VectorXd& lower, const VectorXd& upper) {
                      return run(search, start, lower, upper);
                    });
    return search.result();
  }

 private:
  std::string run(Search& search, const Point& start, const VectorXd& lower,
                  const VectorXd& upper) const;
  /// Sets the options of Ipopt. @param curved  true if second derivatives are used
  void set(Ipopt::OptionsList& options, bool curved) const;

  Settings settings_;
  Constants c_;
};

void IpoptOptimizer::set(Ipopt::OptionsList& options, bool curved) const {
  const auto check = [](bool accepted, const std::string& name) {
    if (!accepted) throw Error::numerical("ipopt: option " + name + " is not accepted");
  };
  const auto text = [&](const char* name, const char* value) {
    check(options.SetStringValue(name, value), name);
  };
  const auto number = [&](const char* name, double value) {
    check(options.SetNumericValue(name, value), name);
  };
  const auto count = [&](const char* name, int value) {
    check(options.SetIntegerValue(name, value), name);
  };
  text("sb", "yes");
  count("print_level", 0);
  text("linear_solver", "mumps");
  text("hessian_approximation", curved ? "exact" : "limited-memory");
  if (curved) {
    number("theta_max_fact", 1e-1);
    number("perturb_inc_fact", 4);
    count("watchdog_shortened_iter_trigger", 0);
  }
  count("limited_memory_max_history", c_.history);
  text("mu_strategy", "monotone");
  number("mu_init", c_.mu_init > 0 ? c_.mu_init : curved ? 1e-5 : 1e-3);
  number("bound_push", c_.bound_push);
  number("bound_frac", std::min(0.5, c_.bound_push));
  number("slack_bound_push", c_.bound_push);
  number("slack_bound_frac", std::min(0.5, c_.bound_push));
  number("bound_relax_factor", 0);  // designs outside their bounds may be invalid
  // The tolerances of Search are to be met before the one of Ipopt. A bound farther away than
  // kActiveTolerance is not active in kkt_point(): its multiplier is below kkt_tolerance if the
  // product of multiplier and distance is below the product of both tolerances.
  number("tol", std::max(1e-12, kActiveTolerance * settings_.kkt_tolerance));
  count("acceptable_iter", 0);
  count("max_iter", c_.box > 0 ? c_.restart : settings_.max_iterations);
}

std::string IpoptOptimizer::run(Search& search, const Point& start, const VectorXd& lower,
                                const VectorXd& upper) const {
  const Ipopt::SmartPtr<Ipopt::IpoptApplication> application = new Ipopt::IpoptApplication(false);
  application->RethrowNonIpoptException(true);
  const bool curved = c_.exact && search.has_curvature();
  set(*application->Options(), curved);
  if (application->Initialize("") != Ipopt::Solve_Succeeded) {  // "": no file ipopt.opt is read
    throw Error::numerical("ipopt: the optimizer could not be initialized");
  }
  const Ipopt::SmartPtr<Ipopt::TNLP> adapter =
      new Adapter(search, start, lower, upper,
                  kEvaluationsPerIteration * std::max(2, settings_.max_iterations), curved);
  try {
    std::string why = name_of(application->OptimizeTNLP(adapter));
    if (!search.refusal().empty()) why += "; the last rejected design: " + search.refusal();
    return why;
  } catch (const Halt&) {
    return "the optimization was stopped";
  }
}

}  // namespace

std::unique_ptr<Optimizer> make_ipopt(const Settings& settings) {
  const Options o = with_defaults(settings, {{"exact", 1},
                                             {"mu_init", 0},
                                             {"bound_push", 1e-3},
                                             {"history", 6},
                                             {"box", 0},
                                             {"restart", 15}});
  check_option(settings, "exact", o.at("exact"), 0, 1);
  check_option(settings, "mu_init", o.at("mu_init"), 0, 1e6);
  check_option(settings, "bound_push", o.at("bound_push"), 1e-12, 1e6);
  check_option(settings, "history", o.at("history"), 1, 1000);
  check_option(settings, "box", o.at("box"), 0, 1e9);
  check_option(settings, "restart", o.at("restart"), 2, 1e6);
  start_mpi_for_ipopt();
  return std::make_unique<IpoptOptimizer>(
      settings,
      Constants{o.at("mu_init"), o.at("bound_push"), o.at("box"), static_cast<int>(o.at("history")),
                static_cast<int>(o.at("restart")), o.at("exact") > 0.5});
}

}  // namespace flexmorph::optim
