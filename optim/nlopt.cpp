#include <nlopt.h>

#include <cmath>
#include <exception>
#include <memory>

#include "optim/makers.h"
#include "optim/moving_box.h"
#include "optim/search.h"

/// NLopt's `mma` and `ccsaq` (conservative convex separable approximations).
///
/// Options:
///   box      half width of the moving box, absolute in x (default: move_limit for ccsaq, 1.5 times
///            move_limit for mma); 0: no box
///   restart  number of evaluations inside one box
///   scale    factor of f and g (default: 30 for mma, 10 for ccsaq), because NLopt 2.7.1 has
///            no other setting for its first curvature
///
/// The box of mma is a compromise. On the plate that grows at 0.5 m/s, a box of move_limit ended
/// 6 % above the `mma` of this program, a box of 1.5 move_limit 4.5 % above it. On the short beam
/// (median of five starts) a box of 2 move_limit ended 1.4 % higher, a box of 1.5 move_limit 0.5 %
/// higher. Single designs scatter by a few per cent. ccsaq with a box of move_limit and a scale of
/// 10 stays within 1 % on both plates and 3 % on the short beam (with a scale of 30: 4 %).
///
/// This file adds three things that the library does not provide. An exception or a NaN of the
/// objective would end in a failure without a message or in a NaN result; therefore the callbacks
/// store exceptions and end the run. NLopt requests f and g one after the other at one x; therefore
/// the last response is stored. NLopt reports neither iterations nor a KKT residual; therefore the
/// rows of the history are evaluations, and the search decides when to stop.
///
/// Source: Svanberg (2002), SIAM J. Optim. 12, 555-573 (the algorithm); NLopt 2.7.1.
namespace flexmorph::optim {
namespace {

std::string name_of(nlopt_result result) {
  switch (result) {
    case NLOPT_FTOL_REACHED:
    case NLOPT_XTOL_REACHED:
      return "NLopt found no better design with its smallest steps";
    case NLOPT_MAXEVAL_REACHED:
      return "NLopt reached its limit of evaluations";
    case NLOPT_ROUNDOFF_LIMITED:
      return "NLopt was limited by round-off";
    case NLOPT_SUCCESS:
      return "NLopt ended without a reason";
    case NLOPT_FORCED_STOP:
      return "NLopt was stopped";
    default:
      return "NLopt failed with code " + std::to_string(result);
  }
}

constexpr double kRefusedValue = 1e6;  // f of a refused design, in units of 1 + |f|
constexpr double kBoxOfMma = 1.5;      // default box, in move limits
constexpr double kScaleOfMma = 30, kScaleOfCcsaq = 10;
constexpr int kMaxRefusals = 10;  // in sequence; each divides NLopt's step by about ten

/// One run of NLopt. The C library holds the address of this object, therefore it cannot be moved.
class Run {
 public:
  Run(Search& search, const Settings& settings, const Point& start, double scale)
      : search_(search), settings_(settings), start_(start), last_(start), scale_(scale) {}
  Run(const Run&) = delete;

  std::string go(nlopt_algorithm algorithm, const VectorXd& lower, const VectorXd& upper,
                 int evaluations);

 private:
  void analyse_at(const Eigen::Map<const VectorXd>& x);
  template <typename Use>
  void guarded(unsigned n, const double* x, const Use& use);
  static double objective(unsigned n, const double* x, double* gradient, void* self);
  static void constraints(unsigned m, double* g, unsigned n, const double* x, double* gradient,
                          void* self);

  Search& search_;
  const Settings& settings_;
  const Point& start_;
  Point last_;  // last x that NLopt requested, with the response passed to NLopt
  double scale_;
  nlopt_opt opt_ = nullptr;
  std::exception_ptr exception_;
};

/// Stores the response at x in last_. A refused design gets the constraints of the start and an
/// objective far above that of the start, so that NLopt increases the curvature of its
/// approximations and shortens its step.
void Run::analyse_at(const Eigen::Map<const VectorXd>& x) {
  if (exception_ || search_.stopped() || x == last_.x) return;
  last_.x = x;
  if (search_.evaluate(last_.x, last_.response) == Trial::taken) {
    search_.row(search_.evaluations(), last_);
    return;
  }
  last_.response = start_.response;
  last_.response.f += kRefusedValue * (1 + std::abs(last_.response.f));
  if (search_.refused_in_a_row() >= kMaxRefusals) nlopt_force_stop(opt_);
  if (search_.evaluations() >= settings_.max_iterations) {
    search_.stop(Stop::iteration_limit,
                 "the limit of " + std::to_string(settings_.max_iterations) +
                     " evaluations is reached; the last design was rejected: " + search_.refusal());
  }
  search_.stop_when_spent();
}

/// Calls use(response at x). Exceptions must not pass through C code; they are stored and thrown at
/// the end of the run.
template <typename Use>
void Run::guarded(unsigned n, const double* x, const Use& use) {
  try {
    analyse_at({x, n});
  } catch (...) {
    exception_ = std::current_exception();
    last_.response = start_.response;
  }
  use(last_.response);
  if (exception_ || search_.stopped()) nlopt_force_stop(opt_);
}

double Run::objective(unsigned n, const double* x, double* gradient, void* self) {
  Run& run = *static_cast<Run*>(self);
  double f = 0;
  run.guarded(n, x, [&](const ProblemValues& r) {
    f = run.scale_ * r.f;
    if (gradient != nullptr) Eigen::Map<VectorXd>(gradient, n) = run.scale_ * r.df;
  });
  return f;
}

void Run::constraints(unsigned m, double* g, unsigned n, const double* x, double* gradient,
                      void* self) {
  using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  Run& run = *static_cast<Run*>(self);
  run.guarded(n, x, [&](const ProblemValues& r) {
    Eigen::Map<VectorXd>(g, m) = run.scale_ * r.g;
    if (gradient != nullptr) Eigen::Map<RowMajor>(gradient, m, n) = run.scale_ * r.dg;
  });
}

std::string Run::go(nlopt_algorithm algorithm, const VectorXd& lower, const VectorXd& upper,
                    int evaluations) {
  const std::unique_ptr<nlopt_opt_s, void (*)(nlopt_opt)> opt(
      nlopt_create(algorithm, static_cast<unsigned>(search_.n())), nlopt_destroy);
  opt_ = opt.get();
  if (!opt) throw Error::numerical("nlopt: the optimizer could not be created");
  const auto check = [](nlopt_result result) {
    if (result < 0) throw Error::numerical("nlopt: " + name_of(result) + " during its setup");
  };
  check(nlopt_set_min_objective(opt_, &Run::objective, this));
  check(nlopt_set_lower_bounds(opt_, lower.data()));
  check(nlopt_set_upper_bounds(opt_, upper.data()));
  if (search_.m() > 0) {
    // No tolerance (nullptr), because NLopt stalls at a design that is feasible only within a
    // tolerance: its approximations of g <= 0 then contain no lower f.
    check(nlopt_add_inequality_mconstraint(opt_, static_cast<unsigned>(search_.m()),
                                           &Run::constraints, this, nullptr));
  }
  check(nlopt_set_maxeval(opt_, evaluations + 1));  // the first evaluation is at the known start
  check(nlopt_set_xtol_rel(opt_, 1e-12));
  VectorXd x = last_.x;
  double value = 0;
  const nlopt_result result = nlopt_optimize(opt_, x.data(), &value);
  if (exception_) std::rethrow_exception(exception_);
  const bool refused = result == NLOPT_FORCED_STOP && search_.refused_in_a_row() > 0;
  return refused ? "the last designs were rejected: " + search_.refusal() : name_of(result);
}

class Nlopt final : public Optimizer {
 public:
  Nlopt(const Settings& settings, double box, int restart, double scale)
      : settings_(settings),
        box_(box),
        restart_(restart),
        scale_(scale),
        algorithm_(settings.name == "nlopt_ccsaq" ? NLOPT_LD_CCSAQ : NLOPT_LD_MMA) {}

  Result minimize(Problem& problem, const Observer& observe) override {
    Search search(problem, settings_, observe);
    if (search.row(1, search.start())) {
      const int evaluations = box_ == 0 ? settings_.max_iterations : restart_;
      search_in_boxes(search, box_,
                      [&](const Point& start, const VectorXd& lower, const VectorXd& upper) {
                        Run run(search, settings_, start, scale_);
                        return run.go(algorithm_, lower, upper, evaluations);
                      });
    }
    return search.result();
  }

 private:
  Settings settings_;
  double box_;
  int restart_;
  double scale_;
  nlopt_algorithm algorithm_;
};

}  // namespace

std::unique_ptr<Optimizer> make_nlopt(const Settings& settings) {
  const bool mma = settings.name == "nlopt_mma";
  const double box = (mma ? kBoxOfMma : 1) * settings.move_limit;
  const double scale = mma ? kScaleOfMma : kScaleOfCcsaq;
  const Options o = with_defaults(settings, {{"box", box}, {"restart", 8}, {"scale", scale}});
  check_option(settings, "box", o.at("box"), 0, 1e9);
  check_option(settings, "restart", o.at("restart"), 2, 1e6);
  check_option(settings, "scale", o.at("scale"), 1e-9, 1e9);
  return std::make_unique<Nlopt>(settings, o.at("box"), static_cast<int>(o.at("restart")),
                                 o.at("scale"));
}

}  // namespace flexmorph::optim
