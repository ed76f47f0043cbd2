#include <algorithm>
#include <cmath>
#include <string>

#include "optim/makers.h"
#include "optim/mma_subproblem.h"
#include "optim/restoration.h"
#include "optim/search.h"

/// The method of moving asymptotes in its classic form (`mma`) and in its globally convergent form
/// (`gcmma`). The inner iterations of `gcmma` make the approximation of every function more convex
/// until it lies above the function at the trial. Therefore iterates that follow a feasible one
/// stay feasible and the objective decreases, at the cost of more evaluations.
///
/// Source: Svanberg (1987), IJNME 24; (2002), SIAM J. Optim. 12, 555-573.
///
/// Options, with the defaults that worked on the published short beam:
///   asyinit, asyincr, asydecr  first distance of the asymptotes, its factors per iteration
///   asymin, asymax             range of that distance. The second derivative of f * fscale may be
///                              as large as 8 raa0 / asymin before x oscillates about a minimum
///                              inside its bounds. With asymin = 0.01 this is 8, or 0.8 for log C,
///                              which has a second derivative of 4; the KKT residuals then rose
///                              again as soon as the asymptotes had come close
///   albefa                     fraction of the distance to an asymptote that a step may not enter
///   raa0                       convexity added to every variable. With 1e-5 (Svanberg) large
///                              subproblems with many near-zero gradients are not solved. gcmma
///                              starts an iteration with raa0 or with a tenth of the convexity that
///                              the last iteration needed, whichever is larger
///   c                          penalty on violating a constraint, relative to f * fscale
///   fscale, gscale             factors of f and g
///
/// Svanberg measures the move limit, the asymptotes and raa0 relative to upper - lower. Here they
/// are absolute in x, because a position may range over the whole domain, which is many units,
/// while a step must stay about one cell whatever the size of the domain is.
namespace flexmorph::optim {
namespace {

const Options kDefaults = {{"asyinit", 0.1}, {"asyincr", 1.05}, {"asydecr", 0.65}, {"asymin", 2e-4},
                           {"asymax", 10},   {"albefa", 0.1},   {"raa0", 0.01},    {"c", 1000},
                           {"fscale", 10},   {"gscale", 1}};
constexpr int kMaxRefusals = 10;      // in sequence
constexpr double kStepBack = 0.5;     // factor of the trust after a refused trial
constexpr double kStepForward = 1.5;  // after an accepted trial; two compensate one refusal
constexpr double kMinTrust = 1e-4;
constexpr double kConservative = 1e-10;          // relative tolerance for round-off
constexpr int kMaxInnerIterations = 15;          // inner iterations of gcmma
constexpr double kSafety = 1.1, kSteepest = 10;  // Svanberg (2002), (4.5): factors of convexity
constexpr double kConvexityDecay =
    0.1;                          // factor of the last convexity at the start of an iteration
constexpr int kRestorations = 3;  // number of last iterations that restore g <= 0 if infeasible

struct Constants {
  double asyinit, asyincr, asydecr, asymin, asymax, albefa, raa0, c, fscale, gscale;
};

/// Distances of the asymptotes from x, and the present move limit. Both contain a factor, the
/// trust, which decreases when a trial is refused and increases again over the next iterations.
class Asymptotes {
 public:
  Asymptotes(const Constants& constants, double move_limit, const VectorXd& x)
      : c_(constants), move_limit_(move_limit), x_(x) {
    distance_ = VectorXd::Constant(x.size(), std::clamp(c_.asyinit, c_.asymin, c_.asymax));
  }

  /// Moves the asymptotes to x: closer for variables whose change has reversed its sign, farther
  /// for variables that continue in one direction.
  void advance(const VectorXd& x) {
    const VectorXd change = x - x_;
    for (Eigen::Index j = 0; last_change_.size() > 0 && j < x.size(); ++j) {
      const double turn = change[j] * last_change_[j];
      const double factor = turn < 0 ? c_.asydecr : turn > 0 ? c_.asyincr : 1;
      distance_[j] = std::clamp(factor * distance_[j], c_.asymin, c_.asymax);
    }
    last_change_ = change;
    x_ = x;
    trust_ = std::min(1.0, kStepForward * trust_);
  }

  void step_back() { trust_ = std::max(kMinTrust, kStepBack * trust_); }

  VectorXd distance() const { return trust_ * distance_; }  ///< x - L = U - x (n)
  double move() const { return trust_ * move_limit_; }

 private:
  const Constants& c_;
  double move_limit_, trust_ = 1;
  VectorXd x_, last_change_, distance_;
};

/// Sets p and q of p (U - x)^-1 + q (x - L)^-1 such that this function has the given derivative at
/// x and is slightly more convex than necessary.
template <typename Slope, typename Out>
void approximate(const Slope& slope, double scale, double raa0, const VectorXd& distance, Out&& p,
                 Out&& q) {
  const Eigen::ArrayXd up = scale * slope.array().max(0);
  const Eigen::ArrayXd down = scale * (-slope.array()).max(0);
  p = (distance.array().square() * (1.001 * up + 0.001 * down + raa0)).matrix();
  q = (distance.array().square() * (0.001 * up + 1.001 * down + raa0)).matrix();
}

class Mma final : public Optimizer {
 public:
  Mma(const Settings& settings, const Constants& constants, bool conservative)
      : settings_(settings), c_(constants), conservative_(conservative) {}

  Result minimize(Problem& problem, const Observer& observe) override;

 private:
  void build(const Point& at, const Search& search, const Asymptotes& asymptotes);
  VectorXd propose(const Point& at, const Search& search, const Asymptotes& asymptotes,
                   MmaSolver& solver);
  bool raise_convexity(const Point& at, const Point& trial);
  bool advance(Point& at, Search& search, Asymptotes& asymptotes, MmaSolver& solver);

  Settings settings_;
  Constants c_;
  bool conservative_;      // true for gcmma
  bool restored_ = false;  // the last proposal came from restored()
  MmaSubproblem sub_;
  VectorXd convexity_;  // of f * fscale and every g * gscale (1 + m)
  int subproblems_ = 0, unsolved_ = 0;
  double worst_kkt_ = 0;
};

void Mma::build(const Point& at, const Search& search, const Asymptotes& asymptotes) {
  const ProblemValues& r = at.response;
  const int m = search.m();
  const VectorXd distance = asymptotes.distance();
  const VectorXd reach = ((1 - c_.albefa) * distance).cwiseMin(asymptotes.move());
  sub_.low = at.x - distance;
  sub_.upp = at.x + distance;
  sub_.alpha = search.lower().cwiseMax(at.x - reach);
  sub_.beta = search.upper().cwiseMin(at.x + reach);
  approximate(r.df, c_.fscale, convexity_[0], distance, sub_.p0, sub_.q0);
  sub_.P.resize(at.x.size(), m);
  sub_.Q.resize(at.x.size(), m);
  for (int i = 0; i < m; ++i) {
    approximate(r.dg.row(i).transpose(), c_.gscale, convexity_[1 + i], distance, sub_.P.col(i),
                sub_.Q.col(i));
  }
  for (Eigen::Index j = 0; j < at.x.size(); ++j) {
    if (sub_.beta[j] > sub_.alpha[j]) continue;
    // A variable whose bounds coincide gets no influence; its barrier keeps its value.
    sub_.alpha[j] = at.x[j] - 0.5 * distance[j];
    sub_.beta[j] = at.x[j] + 0.5 * distance[j];
    sub_.p0[j] = sub_.q0[j] = 0;
    sub_.P.row(j).setZero();
    sub_.Q.row(j).setZero();
  }
  sub_.b = (sub_.P + sub_.Q).transpose() * distance.cwiseInverse() - c_.gscale * r.g;
  sub_.a = VectorXd::Zero(m);
  sub_.c = VectorXd::Constant(m, c_.c);
  sub_.d = VectorXd::Ones(m);
}

VectorXd Mma::propose(const Point& at, const Search& search, const Asymptotes& asymptotes,
                      MmaSolver& solver) {
  const bool last_ones = search.rows() + kRestorations >= settings_.max_iterations;
  if (last_ones && search.rows() > kRestorations && !search.feasible(at.response)) {
    restored_ = true;
    return restored(at, search.lower(), search.upper(), asymptotes.move());
  }
  restored_ = false;
  build(at, search, asymptotes);
  const MmaSolution& solution = solver.solve(sub_);
  ++subproblems_;
  if (!solution.solved) ++unsolved_;
  worst_kkt_ = std::max(worst_kkt_, solution.kkt);
  return solution.x.cwiseMax(search.lower()).cwiseMin(search.upper());
}

/// Increases the convexity of all approximations that lie below their function at the trial, so
/// that they lie above it. @return true if there was such an approximation
bool Mma::raise_convexity(const Point& at, const Point& trial) {
  const Eigen::ArrayXd to_upp = (sub_.upp - trial.x).array().inverse();
  const Eigen::ArrayXd to_low = (trial.x - sub_.low).array().inverse();
  const Eigen::ArrayXd distance = at.x - sub_.low;
  // Increase of an approximation at the trial per unit of convexity.
  const double unit = (distance.square() * (to_upp + to_low - 2 / distance)).sum();
  bool raised = false;
  const auto check = [&](Eigen::Index k, double approximation, double value) {
    const double missing = value - approximation;
    if (missing <= kConservative * (1 + std::abs(value)) || unit <= 0) return;
    convexity_[k] = std::min(kSteepest * convexity_[k], kSafety * (convexity_[k] + missing / unit));
    raised = true;
  };
  const auto change = [&](const auto& p, const auto& q) {
    return (p.array() * (to_upp - 1 / distance) + q.array() * (to_low - 1 / distance)).sum();
  };
  check(0, c_.fscale * at.response.f + change(sub_.p0, sub_.q0), c_.fscale * trial.response.f);
  for (Eigen::Index i = 0; i < at.response.g.size(); ++i)
    check(1 + i, c_.gscale * at.response.g[i] + change(sub_.P.col(i), sub_.Q.col(i)),
          c_.gscale * trial.response.g[i]);
  return raised;
}

/// Moves to the next iterate. Returns false if the search has stopped, for example because every
/// trial was refused.
bool Mma::advance(Point& at, Search& search, Asymptotes& asymptotes, MmaSolver& solver) {
  Point trial;
  convexity_ = (kConvexityDecay * convexity_).cwiseMax(c_.raa0);
  int inner = 0;
  for (int refusals = 0; refusals < kMaxRefusals;) {
    trial.x = propose(at, search, asymptotes, solver);
    if (search.evaluate(trial.x, trial.response) == Trial::taken) {
      const bool keeps_running =
          conservative_ && !restored_ && !search.spent() && inner++ < kMaxInnerIterations;
      if (keeps_running && raise_convexity(at, trial)) continue;
      std::swap(at, trial);
      asymptotes.advance(at.x);
      return true;
    }
    search.stop_when_spent();
    if (search.stopped()) return false;
    asymptotes.step_back();
    ++refusals;
  }
  search.stop(Stop::stalled,
              std::to_string(kMaxRefusals) +
                  " steps in a row were rejected; the last reason: " + search.refusal());
  return false;
}

Result Mma::minimize(Problem& problem, const Observer& observe) {
  subproblems_ = unsolved_ = 0;
  worst_kkt_ = 0;
  Search search(problem, settings_, observe);
  Point at = search.start();
  Asymptotes asymptotes(c_, settings_.move_limit, at.x);
  MmaSolver solver(search.n(), search.m());
  convexity_ = VectorXd::Constant(1 + search.m(), c_.raa0);
  for (int iteration = 1; search.row(iteration, at); ++iteration) {
    if (!advance(at, search, asymptotes, solver)) break;
  }
  Result result = search.result();
  if (unsolved_ > 0) {
    result.message += "; " + std::to_string(unsolved_) + " of " + std::to_string(subproblems_) +
                      " subproblems were not solved to their tolerance (largest KKT residual " +
                      scientific(worst_kkt_) + ")";
  }
  return result;
}

}  // namespace

std::unique_ptr<Optimizer> make_mma(const Settings& settings) {
  const Options o = with_defaults(settings, kDefaults);
  const auto get = [&](const char* name, double low, double high) {
    check_option(settings, name, o.at(name), low, high);
    return o.at(name);
  };
  Constants c{};
  c.asyinit = get("asyinit", 1e-6, 1e6);
  c.asyincr = get("asyincr", 1, 10);
  c.asydecr = get("asydecr", 0.01, 1);
  c.asymin = get("asymin", 1e-9, 1e6);
  c.asymax = get("asymax", c.asymin, 1e9);
  c.albefa = get("albefa", 1e-3, 0.9);
  c.raa0 = get("raa0", 1e-12, 1e3);
  c.c = get("c", 1e-3, 1e12);
  c.fscale = get("fscale", 1e-9, 1e9);
  c.gscale = get("gscale", 1e-9, 1e9);
  return std::make_unique<Mma>(settings, c, settings.name == "gcmma");
}

}  // namespace flexmorph::optim
