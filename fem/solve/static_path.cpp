#include <algorithm>
#include <cmath>
#include <limits>

#include "fem/solve/condition.h"
#include "fem/solve/linear_solver.h"
#include "fem/solve/statics.h"
#include "geometry/text.h"

namespace flexmorph::fem {
namespace {

class Path {
 public:
  Path(Workspace& model, State& x, const StaticSettings& settings, const StaticObserver& observe)
      : model_(model), x_(x), settings_(settings), observe_(observe), scales_(model.scales()) {
    n_ = model.n_dofs();
    m_ = model.n_constraints();
    x_.v = x_.a = VectorXd::Zero(n_);
    if (x_.lambda.size() != m_) x_.lambda = VectorXd::Zero(m_);
    size_ = resource_estimate();
    start_ = here();
    range_ = std::abs(settings.to - settings.from);
    direction_ = settings.to < settings.from ? -1 : 1;
  }

  StaticResult run() {
    check();
    factor_ = settings_.from;
    if (!newton(factor_) && !bring_on()) fail("no equilibrium was found at the start");
    result_.factor = factor_;
    if (!accepted()) return result_;
    if (range_ == 0) {
      result_.completed = true;
      return result_;
    }
    if (settings_.path == StaticSettings::Path::load)
      follow_load();
    else
      follow_arc();
    model_.scale_loads(factor_);
    if (settings_.condition) result_.condition = condition_estimate(kkt_);
    return result_;
  }

 private:
  struct Point {
    VectorXd q, lambda;
    double factor;
  };

  /// Finds the equilibrium at the first factor in steps. Each step applies a fraction of the forces
  /// that do not act yet and starts from the previous equilibrium. This serves springs that are far
  /// from their free lengths.
  bool bring_on() {
    constexpr double kFirst = 0.1, kGrowth = 1.5;
    Point last = start_;
    last.factor = factor_;
    double part = kFirst;
    bool found = false;
    while (!found && part > settings_.smallest_step) {
      go(last);
      model_.force(x_, held_);
      held_ *= 1 - part;
      x_.lambda.setZero();
      if (!newton(factor_)) {
        part *= 0.5;
        continue;
      }
      model_.follow_turns(x_);
      last = here();
      found = part == 1;
      part = std::min(1.0, kGrowth * part);
    }
    held_.resize(0);
    return found;
  }

  void check() const {
    const StaticSettings& s = settings_;
    if (!(s.first_step > 0 && s.smallest_step > 0 && s.largest_step >= s.first_step &&
          s.max_iterations > 0 && s.max_steps > 0 && s.tolerance > 0) ||
        !std::isfinite(s.from) || !std::isfinite(s.to))
      throw Error::input(
          "statics: step sizes, limits and the tolerance must be positive, and largest_step must "
          "not be below first_step");
  }

  /// Returns the largest half-width of the positions of a body over the coordinate directions [m];
  /// rigid bodies contribute their length.
  double resource_estimate() const {
    double out = 0;
    for (const Body& b : model_.bodies()) {
      if (b.element->is_rigid()) out = std::max(out, b.element->scale(1));
      for (int c = 0; c < b.element->dim(); ++c) {
        double low = std::numeric_limits<double>::infinity(), high = -low;
        for (int k = 0; k < b.element->n_vectors(); ++k) {
          if (!b.element->is_position(k)) continue;
          const double at = x_.q[b.first_dof + b.element->dim() * k + c];
          low = std::min(low, at);
          high = std::max(high, at);
        }
        out = std::max(out, 0.5 * (high - low));
      }
    }
    return std::max(out, 1e-300);
  }

  Point here() const { return {x_.q, x_.lambda, factor_}; }
  void go(const Point& p) {
    x_.q = p.q;
    x_.lambda = p.lambda;
    factor_ = p.factor;
    model_.scale_loads(factor_);
  }

  bool accepted() {
    model_.follow_turns(x_);
    return !observe_ || observe_({result_.steps, factor_, last_iterations_, x_});
  }

  /// Returns the scalar product whose norm is the root mean square of scaled displacements.
  double product(const VectorXd& a, const VectorXd& b) const {
    return a.head(n_).cwiseProduct(scales_).dot(b.head(n_).cwiseProduct(scales_)) / n_;
  }
  double largest(const VectorXd& step) const {
    return step.head(n_).cwiseProduct(scales_).lpNorm<Eigen::Infinity>() / size_;
  }

  /// Computes the right side -(F + Φ_qᵀ λ, Φ) at x_ and factor_; false where it is not finite.
  bool evaluate() {
    model_.scale_loads(factor_);
    model_.constraints(x_, c_);
    model_.force(x_, force_);
    if (held_.size() > 0) force_ -= held_;
    model_.add_constraint_force(c_, x_.lambda, force_);
    right_.resize(n_ + m_);
    right_ << -force_, -c_.value;
    history_.push_back(force_.cwiseQuotient(scales_).norm());
    return right_.allFinite();
  }

  void factorize() {
    model_.kkt(x_, c_, {1, 0, 0}, 1, kkt_);
    if (analyzed_ != model_.pattern_version()) solver_.analyze(kkt_);
    analyzed_ = model_.pattern_version();
    solver_.factorize(kkt_);
  }

  /// Returns true if the right side is no larger than the rounding of the unknowns causes at an
  /// equilibrium. Then the corrections do not become smaller. This happens for very thin plates:
  /// their in-plane stiffness multiplies the last digit of the positions.
  bool at_round_off() const {
    VectorXd noise = VectorXd::Zero(n_);
    for (int column = 0; column < n_; ++column) {
      const double q = std::abs(x_.q[column]);
      for (int p = kkt_.outerIndexPtr()[column]; p < kkt_.outerIndexPtr()[column + 1]; ++p)
        if (kkt_.innerIndexPtr()[p] < n_)
          noise[kkt_.innerIndexPtr()[p]] += std::abs(kkt_.valuePtr()[p]) * q;
    }
    // Allows a few roundings per product, of the Gram entries and of their sums.
    const double rounding = 16 * std::numeric_limits<double>::epsilon();
    return (right_.head(n_).cwiseAbs().array() <= rounding * noise.array()).all();
  }

  /// Computes dq/dμ (and dλ/dμ) with the matrix of the last factorize(). The central difference is
  /// exact for loads, which are linear in the factor. For temperatures, which are not, its error is
  /// of the order 1e-6 (α ΔT)².
  void load_response(VectorXd& out) {
    const double by = 1e-3 * range_;
    VectorXd more, less;
    model_.scale_loads(factor_ + by);
    model_.force(x_, more);
    model_.scale_loads(factor_ - by);
    model_.force(x_, less);
    model_.scale_loads(factor_);
    VectorXd load = VectorXd::Zero(n_ + m_);
    load.head(n_) = (less - more) / (2 * by);
    solver_.solve(kkt_, load, out);
  }

  /// Runs Newton's method at a fixed factor from x_; on failure x_ is undefined.
  bool newton(double factor) {
    factor_ = factor;
    history_.clear();
    return iterate([&](VectorXd& step) {
      solver_.solve(kkt_, right_, step);
      return true;
    });
  }

  /// Runs the iteration that both paths share. correct() turns the right side into a step (and may
  /// change the factor); it returns false on failure.
  template <class Correct>
  bool iterate(const Correct& correct) {
    VectorXd step;
    double previous = std::numeric_limits<double>::infinity();
    try {
      for (last_iterations_ = 1; last_iterations_ <= settings_.max_iterations; ++last_iterations_) {
        ++result_.iterations;
        if (!evaluate()) return false;
        factorize();
        const bool rounded = last_iterations_ > 1 && at_round_off();
        if (!correct(step)) return false;
        x_.q += step.head(n_);
        x_.lambda += step.tail(m_);
        const double size = largest(step);
        if (!std::isfinite(size) || size > 10) return false;
        if (size < settings_.tolerance || (rounded && size < 1e-4)) return true;
        // Corrections of the size of the body that grow do not converge.
        if (last_iterations_ > 4 && size > 0.1 && size > 2 * previous) return false;
        previous = size;
      }
    } catch (const Error& error) {
      if (error.kind() != Error::Kind::numerical) throw;
      return false;  // a singular matrix
    }
    return false;
  }

  void follow_load() {
    double step = settings_.first_step;
    Point last = here(), before = last;
    while (factor_ != settings_.to) {
      count_step();
      const double left = std::abs(settings_.to - last.factor);
      const bool ends = step * range_ >= left * (1 - 1e-9);
      const double next = ends ? settings_.to : last.factor + direction_ * step * range_;
      // Extrapolates along the chord of the last step.
      if (last.factor != before.factor) {
        const double ratio = (next - last.factor) / (last.factor - before.factor);
        x_.q = last.q + ratio * (last.q - before.q);
        x_.lambda = last.lambda + ratio * (last.lambda - before.lambda);
      }
      bool found = newton(next);
      if (!found && last.factor != before.factor) {  // second attempt without extrapolation
        go(last);
        found = newton(next);
      }
      if (!found) {
        go(last);
        before = last;
        ++result_.rejected;
        step = std::min(step, left / range_) / 2;
        if (step < settings_.smallest_step) fail("Newton's method does not converge");
        continue;
      }
      before = last;
      last = here();
      result_.factor = factor_;
      ++result_.steps;
      if (!accepted()) return;
      if (last_iterations_ <= settings_.easy_iterations)
        step = std::min(1.5 * step, settings_.largest_step);
    }
    result_.completed = true;
  }

  void follow_arc() {
    Point last = here();
    VectorXd response, increment = VectorXd::Zero(n_);
    double increment_factor = direction_, length = 0, first_length = 0, psi = 0;
    for (;;) {
      count_step();
      bool found = evaluate();
      if (found) {
        factorize();
        load_response(response);
        if (psi == 0) {
          psi = std::sqrt(product(response, response));
          if (!(psi > 0))
            throw Error::input(
                "statics: path 'arc_length' needs a load or a temperature that causes "
                "displacements");
          first_length = length = std::sqrt(2.0) * psi * settings_.first_step * range_;
        }
        const double rise = std::sqrt(product(response, response) + psi * psi);
        const double along = product(response, increment) + psi * psi * increment_factor;
        const double d_factor = (along < 0 ? -1 : 1) * length / rise;
        x_.q += d_factor * response.head(n_);
        x_.lambda += d_factor * response.tail(m_);
        factor_ += d_factor;
        found = correct_on_sphere(last, length, psi);
      }
      if (!found) {
        go(last);
        ++result_.rejected;
        length /= 2;
        if (length < settings_.smallest_step * first_length / settings_.first_step)
          fail("Newton's method does not converge along the arc");
        continue;
      }
      if ((factor_ - settings_.to) * direction_ >= 0) {
        arrive(last);
        return;
      }
      increment = x_.q - last.q;
      increment_factor = factor_ - last.factor;
      last = here();
      result_.factor = factor_;
      ++result_.steps;
      if (!accepted()) return;
      if (last_iterations_ <= settings_.easy_iterations)
        length = std::min(1.5 * length, 10 * first_length * settings_.largest_step / 0.25);
    }
  }

  /// Runs Newton's method on the equilibrium and the sphere of radius `length` around `last`.
  bool correct_on_sphere(const Point& last, double length, double psi) {
    history_.clear();
    VectorXd response;
    return iterate([&](VectorXd& step) {
      solver_.solve(kkt_, right_, step);
      load_response(response);
      const VectorXd before = x_.q - last.q, moved = before + step.head(n_);
      const double before_factor = factor_ - last.factor;
      // |moved + δ response|² + ψ² (before_factor + δ)² = length²
      const double a = product(response, response) + psi * psi,
                   b = 2 * (product(response, moved) + psi * psi * before_factor),
                   c = product(moved, moved) + psi * psi * before_factor * before_factor -
                       length * length;
      const double discriminant = b * b - 4 * a * c;
      if (!(discriminant >= 0)) return false;
      double best = 0, best_turn = -std::numeric_limits<double>::infinity();
      for (const double sign : {-1.0, 1.0}) {
        const double delta = (-b + sign * std::sqrt(discriminant)) / (2 * a);
        const double turn = product(before, moved) + delta * product(before, response) +
                            psi * psi * before_factor * (before_factor + delta);
        if (turn > best_turn) {
          best_turn = turn;
          best = delta;
        }
      }
      step += best * response;
      factor_ += best;
      return true;
    });
  }

  /// Finds the equilibrium exactly at the end, from the step in which the path passed it.
  void arrive(const Point& last) {
    const Point beyond = here();
    const double part = (settings_.to - last.factor) / (beyond.factor - last.factor);
    x_.q = last.q + part * (beyond.q - last.q);
    x_.lambda = last.lambda + part * (beyond.lambda - last.lambda);
    if (!newton(settings_.to)) {
      go(last);
      fail("no equilibrium was found at the final load factor, although the path passed it");
    }
    result_.factor = factor_;
    ++result_.steps;
    result_.completed = accepted();
  }

  void count_step() {
    if (result_.steps + result_.rejected >= settings_.max_steps)
      fail("the limit of " + std::to_string(settings_.max_steps) + " steps is reached");
  }

  [[noreturn]] void fail(const std::string& why) {
    model_.scale_loads(factor_);
    std::string residuals;
    for (const double r : history_) residuals += formatted(" %.2e", r);
    const std::string where = formatted(
        " after the load factor %.6g (%d steps, %d rejected steps, smallest area ratio %.3g)",
        factor_, result_.steps, result_.rejected, model_.smallest_area_ratio(x_));
    throw Error::numerical("statics: " + why + where + "; the residuals of the last attempt are" +
                           residuals);
  }

  Workspace& model_;
  State& x_;
  StaticSettings settings_;
  const StaticObserver& observe_;
  VectorXd scales_;
  int n_ = 0, m_ = 0, last_iterations_ = 0, analyzed_ = -1;
  double size_ = 1, range_ = 1, direction_ = 1, factor_ = 0;
  StaticResult result_;
  Constraints c_;
  SparseMatrix kkt_;
  DirectSolver solver_;
  VectorXd force_, right_;
  VectorXd held_;  // forces that do not act yet, during bring_on(); otherwise empty
  Point start_;
  std::vector<double> history_;  // |residual| of the iterations of a step
};

}  // namespace

StaticResult solve_static(Workspace& model, State& x, const StaticSettings& settings,
                          const StaticObserver& observe) {
  return Path(model, x, settings, observe).run();
}

}  // namespace flexmorph::fem
