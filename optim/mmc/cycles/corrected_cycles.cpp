#include "optim/mmc/cycles/corrected_cycles.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <deque>
#include <limits>
#include <optional>
#include <utility>

#include "geometry/cpu_time.h"
#include "optim/kkt.h"
#include "optim/mmc/cycles/usability.h"

namespace flexmorph::mmc {
namespace {

/// The static problem with the gradient of the motion at one design, in a trust region around this
/// design.
class Corrected final : public optim::Problem {
 public:
  /// Properties of the motion at the centre of the trust region.
  struct DesignView {
    VectorXd correction;  ///< Correction of the gradient, ∇log J - ∇log C (n).
    MatrixXd root;        ///< Matrix R of the curvature R Rᵀ that C lacks (n x rank).
    VectorXd limits;      ///< Limits of the motion, <= 0 (m).
    MatrixXd slopes;      ///< Gradients of the limits (m x n).
  };
  Corrected(optim::Problem& loaded, const VectorXd& x, double log_compliance, DesignView seen,
            double radius)
      : loaded_(loaded),
        x_(x),
        log_compliance_(log_compliance),
        seen_(std::move(seen)),
        radius_(radius) {}

  int n_variables() const override { return loaded_.n_variables(); }
  /// Returns the number of constraints: those of the static problem, then the limits of the motion,
  /// which are linearised here.
  int n_constraints() const override {
    return loaded_.n_constraints() + static_cast<int>(seen_.limits.size());
  }
  VectorXd lower() const override {
    return loaded_.lower().cwiseMax((x_.array() - radius_).matrix());
  }
  VectorXd upper() const override {
    return loaded_.upper().cwiseMin((x_.array() + radius_).matrix());
  }
  VectorXd start() const override { return x_; }
  optim::ProblemValues evaluate(const VectorXd& x) override {
    optim::ProblemValues out = loaded_.evaluate(x);
    const double part = std::exp(out.f - log_compliance_);
    const VectorXd bent = seen_.root.transpose() * (x - x_);
    out.f = part + seen_.correction.dot(x - x_) + 0.5 * bent.squaredNorm();
    out.df = part * out.df + seen_.correction + seen_.root * bent;
    const Eigen::Index m = out.g.size(), more = seen_.limits.size();
    out.g.conservativeResize(m + more);
    out.g.tail(more) = seen_.limits + seen_.slopes * (x - x_);
    out.dg.conservativeResize(m + more, x.size());
    out.dg.bottomRows(more) = seen_.slopes;
    return out;
  }
  bool acceptable(const VectorXd& x) override { return loaded_.acceptable(x); }

 private:
  optim::Problem& loaded_;
  VectorXd x_;
  double log_compliance_;
  DesignView seen_;
  double radius_;
};

/// The positive semidefinite part of a symmetric rank-one (SR1) matrix, from the last differences
/// of designs and of gradients.
class Secants {
 public:
  explicit Secants(int most) : most_(static_cast<size_t>(most)) {}

  void add(const VectorXd& step, const VectorXd& change) {
    if (most_ == 0 || !(step.norm() > 0) || !change.allFinite()) return;
    pairs_.emplace_back(step, change);
    if (pairs_.size() > most_) pairs_.pop_front();
  }
  /// Returns the factor R of the matrix R Rᵀ (n x rank).
  MatrixXd root(Eigen::Index n) const {
    const auto m = static_cast<Eigen::Index>(pairs_.size());
    if (m == 0) return MatrixXd(n, 0);
    MatrixXd S(n, m), Y(n, m);
    for (Eigen::Index k = 0; k < m; ++k) {
      S.col(k) = pairs_[static_cast<size_t>(k)].first;
      Y.col(k) = pairs_[static_cast<size_t>(k)].second;
    }
    const MatrixXd product = S.transpose() * Y;
    const Eigen::SelfAdjointEigenSolver<MatrixXd> eigen(0.5 * (product + product.transpose()));
    MatrixXd out(n, 0);
    for (Eigen::Index k = 0; k < m; ++k) {
      constexpr double kNoCurvature =
          1e-8;  // relative to the largest; below, the curvature is unknown
      const double value = eigen.eigenvalues()[k];
      if (!(value > kNoCurvature * eigen.eigenvalues().cwiseAbs().maxCoeff())) continue;
      out.conservativeResize(n, out.cols() + 1);
      out.col(out.cols() - 1) = Y * eigen.eigenvectors().col(k) / std::sqrt(value);
    }
    return out;
  }

 private:
  size_t most_;
  std::deque<std::pair<VectorXd, VectorXd>> pairs_;
};

/// The cycles of correct_designs().
class Corrector {
 public:
  Corrector(std::vector<BodyProblem>& problems, const LoadsAt& loads, MotionResponse& motion,
            const CorrectionSettings& settings, const SeeCycle& see)
      : problems_(problems),
        loads_at_(loads),
        motion_(motion),
        settings_(settings),
        see_(see),
        secants_(settings.secants) {}

  void go() {
    renew_loads();
    const double first = look().kkt;
    radius_ = settings_.radius;
    for (int cycle = 1; cycle <= settings_.max_cycles && is_running_; ++cycle) {
      if (now_.kkt <= settings_.kkt_reduction * first || radius_ < settings_.smallest_radius) break;
      if (step(cycle)) renew_loads();
    }
  }

  /// Minimizes J directly; every iteration takes a motion and its adjoint.
  void go_directly() {
    renew_loads();
    look();
    if (settings_.max_cycles == 0) return;
    MotionState state = motion_state_of(parts_, motion_);
    CombinedProblem moved(parts_, designs_of(parts_), formulations_, state);
    optim::Settings settings = settings_.optimizer;
    settings.max_iterations = settings_.max_cycles;
    settings.max_evaluations = 0;
    settings.kkt_tolerance = settings_.kkt_reduction * now_.kkt;
    VectorXd best = moved.problem().start();
    double least = now_.value;
    const auto watch = [&](const optim::Iterate& iterate) {
      now_.cycle = iterate.iteration;
      now_.value = std::exp(iterate.response->f);
      now_.kkt = iterate.kkt;
      now_.predicted = now_.actual = 0;
      now_.accepted = iterate.violation <= kActiveLimits;
      if (now_.accepted && now_.value < least) {
        least = now_.value;
        best = *iterate.x;
      }
      return report();
    };
    optim::make_optimizer(settings)->minimize(moved.problem(), watch);
    move_to(moved, best);
  }

 private:
  /// Computes the loads of the present designs and creates the parts from them.
  void renew_loads() {
    responses_ = loads_at_();
    std::vector<LoadedBody> bodies;
    for (size_t k = 0; k < problems_.size(); ++k) bodies.push_back({problems_[k], *responses_[k]});
    parts_.clear();
    formulations_.clear();
    for (const LoadedBody& body : bodies) {
      parts_.emplace_back(body);
      formulations_.push_back(last_formulation(body.problem));
    }
  }

  /// Computes J and its gradient at the present designs.
  const CorrectedCycle& look() {
    MotionState state = motion_state_of(parts_, motion_);
    const std::vector<Design> designs = designs_of(parts_);
    CombinedProblem moved(parts_, designs, formulations_, state),
        loaded = CombinedProblem::smooth(parts_, designs, formulations_);
    take(moved.problem().start(), moved.problem().evaluate(moved.problem().start()), moved, loaded);
    now_.radius = settings_.radius;
    report();
    return now_;
  }

  void take(const VectorXd& x, const optim::ProblemValues& r, CombinedProblem& moved,
            CombinedProblem& loaded) {
    here_ = r;
    now_.value = std::exp(r.f);
    now_.kkt =
        optim::kkt_point(r, x, moved.problem().lower(), moved.problem().upper(), kActiveLimits)
            .residual;
    now_.angle = angle_between(r.df, loaded.problem().evaluate(x).df);
  }

  /// Returns the constraint rows of the limits of the motion.
  std::vector<int> limit_rows(const CombinedProblem& moved) const {
    std::vector<int> out;
    for (size_t b = 0; b < parts_.size(); ++b) {
      const std::vector<Limit>& limits = parts_[b].problem.motion_goal.limits;
      for (size_t k = 0; k < limits.size(); ++k)
        if (limits[k].row->of_motion) out.push_back(moved.row_of(b, k));
    }
    return out;
  }

  bool report() {
    now_.motions = motion_.motions();
    now_.seconds = cpu_seconds() - begin_;
    if (see_ && !see_(now_)) is_running_ = false;
    return is_running_;
  }

  void move_to(const CombinedProblem& whole, const VectorXd& x) {
    const std::vector<Design> designs = whole.designs_at(x);
    for (size_t k = 0; k < parts_.size(); ++k) parts_[k].problem.design = designs[k];
  }

  /// Returns the largest violation at the present design. It may be positive although the design
  /// was accepted, because the crisp volume is recomputed afterwards.
  static double missed_at(const optim::ProblemValues& here) {
    return std::max(0.0, here.g.maxCoeff());
  }

  /// Solves the static problem with the gradient of the motion within the radius. If the optimizer
  /// finds no better design, the radius is reduced; this takes no motion. Violations of the minimum
  /// length scale appear and disappear discontinuously: a design close to such a discontinuity has
  /// no better neighbour that satisfies all limits. In this case the best design with a small
  /// violation is the step, and the following cycles restore its feasibility.
  optim::Result best_within(optim::Problem& loaded, const VectorXd& x,
                            const optim::ProblemValues& here, const CombinedProblem& moved) {
    constexpr double kConstraintTolerance = 3e-3;  // largest violation g; 0.3 % of a volume
    const std::vector<int> limits = limit_rows(moved);
    const Corrected::DesignView seen{here_.df - here.df, secants_.root(x.size()), here_.g(limits),
                                     here_.dg(limits, Eigen::all)};
    const double first = radius_;
    std::optional<optim::Result> forgiven;  // best one with a small violation, first radius
    for (;; radius_ *= 0.5) {
      Corrected problem(loaded, x, here.f, seen, radius_);
      optim::Settings inner = settings_.optimizer;
      inner.max_iterations = settings_.inner_iterations;
      inner.max_evaluations = 0;
      inner.move_limit = std::min(inner.move_limit, radius_);
      inner.kkt_tolerance = std::min(inner.kkt_tolerance, 0.1 * now_.kkt);
      const auto watch = [&](const optim::Iterate& iterate) {
        const double least = forgiven ? forgiven->response.f : 1;
        if (radius_ < first || iterate.violation > kConstraintTolerance ||
            !(iterate.response->f < least))
          return true;
        forgiven.emplace();
        forgiven->x = *iterate.x;
        forgiven->response = *iterate.response;
        forgiven->violation = iterate.violation;
        return true;
      };
      optim::Result found = optim::make_optimizer(inner)->minimize(problem, watch);
      const bool nearer = found.violation < 0.5 * missed_at(here);
      if (found.response.f < 1 || nearer) return found;
      if (radius_ >= settings_.smallest_radius) continue;
      if (!forgiven) return found;
      radius_ = first;
      return *forgiven;
    }
  }

  /// Runs one cycle of first order. @return true if its design was accepted
  bool step(int cycle) {
    constexpr double kMinAcceptedRatio = 0.1, kGoodRatio = 0.75, kPoorRatio = 0.25,
                     kMaxDifference = 1e-5;
    MotionState state = motion_state_of(parts_, motion_);
    const std::vector<Design> designs = designs_of(parts_);
    CombinedProblem moved(parts_, designs, formulations_, state),
        loaded = CombinedProblem::smooth(parts_, designs, formulations_);
    const VectorXd x = loaded.problem().start();
    const optim::ProblemValues here = loaded.problem().evaluate(x);
    const optim::Result found = best_within(loaded.problem(), x, here, moved);
    now_.cycle = cycle;
    now_.radius = radius_;
    now_.predicted = 1 - found.response.f;
    now_.actual = -std::numeric_limits<double>::infinity();
    optim::ProblemValues there;
    try {
      there = moved.problem().evaluate(found.x);
      now_.actual = 1 - std::exp(there.f - here_.f);
      const optim::ProblemValues loaded_there = loaded.problem().evaluate(found.x);
      secants_.add(found.x - x,
                   std::exp(there.f - here_.f) * there.df - here_.df -
                       (std::exp(loaded_there.f - here.f) * loaded_there.df - here.df));
    } catch (const Error& error) {
      if (error.kind() != Error::Kind::numerical) throw;
    }
    const double missed = missed_at(here);
    const bool restores = now_.predicted <= 0 && missed > kMaxDifference &&
                          std::isfinite(now_.actual) && found.violation < 0.5 * missed &&
                          now_.actual > -10 * missed;
    const double ratio = now_.predicted > 0 ? now_.actual / now_.predicted : -1;
    const bool at_edge = (found.x - x).lpNorm<Eigen::Infinity>() > 0.99 * radius_;
    now_.accepted = ratio >= kMinAcceptedRatio || restores;
    if (ratio < kPoorRatio && !restores)
      radius_ *= 0.5;
    else if (ratio > kGoodRatio && at_edge)
      radius_ *= 2;
    if (now_.accepted) {
      take(found.x, there, moved, loaded);
      move_to(loaded, found.x);
    }
    report();
    return now_.accepted;
  }

  std::vector<BodyProblem>& problems_;
  const LoadsAt& loads_at_;
  MotionResponse& motion_;
  const CorrectionSettings& settings_;
  const SeeCycle& see_;
  std::vector<std::unique_ptr<ComplianceEvaluator>> responses_;
  std::vector<Subproblem> parts_;
  std::vector<Formulation> formulations_;
  CorrectedCycle now_;
  Secants secants_;
  optim::ProblemValues here_;  // response of the motion at the present design
  double radius_ = 0, begin_ = cpu_seconds();
  bool is_running_ = true;
};

}  // namespace

void correct_designs(std::vector<BodyProblem>& problems, const LoadsAt& loads,
                     MotionResponse& motion, const CorrectionSettings& settings,
                     const SeeCycle& see) {
  Corrector corrector(problems, loads, motion, settings, see);
  if (settings.kind == Correction::direct)
    corrector.go_directly();
  else
    corrector.go();
}

std::vector<BodyOutcome> outcomes_of_corrected(std::span<const LoadedBody> bodies) {
  std::vector<BodyOutcome> out;
  for (const LoadedBody& body : bodies) {
    const Subproblem part(body);
    const Design& design = body.problem.design;
    out.push_back(outcome_of(part, design, last_formulation(body.problem), false));
  }
  return out;
}

}  // namespace flexmorph::mmc
