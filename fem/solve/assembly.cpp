#include "fem/solve/assembly.h"

#include <algorithm>

#include "fem/solve/diagnosis.h"
#include "fem/solve/linear_solver.h"
#include "geometry/text.h"

namespace flexmorph::fem {
namespace {

constexpr int kMaxIterations = 60;
constexpr double kTolerance = 1e-12;  // allowed violation of joints relative to the model's size
constexpr double kCompliance = 1e-9;  // δ of the first Newton step
constexpr double kMinCompliance = 1e-14;  // after full steps, and for velocities
constexpr double kMaxCompliance = 1e6;    // largest δ; the assembly fails above it
constexpr double kPartOfIdentity = 1e-8;  // fraction of the mean mass that is added to the diagonal

std::string number(double value) { return formatted("%.3g", value); }

/// Computes the smallest corrections in the mass norm, in displacements S q and scaled rows.
class Correction {
 public:
  explicit Correction(Workspace& model) : model_(model) {}

  /// Factors the matrix at a state; `rows` are the constraints at this state.
  void factorize(const State& x, const ScaledConstraints& rows, double delta) {
    const int n = model_.n_dofs(), m = model_.n_constraints();
    model_.kkt(x, rows.unscaled(), {0, 0, 1}, 1, kkt_);
    scale_.resize(n + m);
    scale_ << rows.scales().cwiseInverse(), rows.row_scale();
    if (diagonal_.size() == 0) find_masses();
    for (int column = 0; column < n + m; ++column)
      for (SparseMatrix::InnerIterator it(kkt_, column); it; ++it) {
        it.valueRef() *= scale_[it.row()] * scale_[column];
        if (it.row() < n && column < n) it.valueRef() /= typical_;
      }
    diagonal_.tail(m).setConstant(-delta);
    Eigen::Map<VectorXd>(shift_.valuePtr(), n + m) = diagonal_;
    sum_ = kkt_ + shift_;
    if (fresh_) solver_.analyze(sum_);
    fresh_ = false;
    solver_.factorize(sum_);
  }

  /// Returns the change of the unknowns Δ (n), not scaled to displacements, with J S Δ = -miss.
  const VectorXd& solve(const VectorXd& miss) {
    const int n = model_.n_dofs();
    right_.setZero(n + miss.size());
    right_.tail(miss.size()) = -miss;
    solver_.solve(sum_, right_, solution_);
    change_ = scale_.head(n).cwiseProduct(solution_.head(n));
    return change_;
  }

 private:
  /// Computes a typical mass, and the addition to the diagonal that gives every unknown some mass.
  void find_masses() {
    const int n = model_.n_dofs(), m = model_.n_constraints();
    VectorXd mass = VectorXd::Zero(n);
    for (int i = 0; i < n; ++i) mass[i] = kkt_.coeff(i, i) * scale_[i] * scale_[i];
    const double mean = mass.cwiseAbs().mean();
    typical_ = mean > 0 ? mean : 1;
    diagonal_ = VectorXd::Ones(n + m);
    if (mean > 0)
      for (const Body& b : model_.bodies()) {
        const double of_body = mass.segment(b.first_dof, b.n_dofs()).cwiseAbs().mean();
        diagonal_.segment(b.first_dof, b.n_dofs())
            .setConstant(kPartOfIdentity * (of_body > 0 ? of_body / mean : 1));
      }
    shift_.resize(n + m, n + m);
    shift_.setIdentity();
  }

  Workspace& model_;
  SparseMatrix kkt_, shift_, sum_;
  DirectSolver solver_;
  VectorXd scale_, diagonal_, right_, solution_, change_;
  double typical_ = 1;
  bool fresh_ = true;
};

[[noreturn]] void fail(Workspace& model, const State& x, const VectorXd& miss, int iterations) {
  const auto joints = heaviest_joints(model, miss, 0.01);
  const double largest = weights_of_joints(model, miss).lpNorm<Eigen::Infinity>();
  std::string text = "assembly: no position at t = " + number(x.t) +
                     " s meets all joints: the error of joint '" + joints[0] + "' is " +
                     number(largest) + " m after " + std::to_string(iterations) + " iterations";
  if (joints.size() > 1)
    text += "; other joints with errors: " + list_joints({joints.begin() + 1, joints.end()});
  const Diagnosis diagnosis = diagnose(model, x);
  if (diagnosis.is_contradictory()) text += "; " + describe(diagnosis);
  throw Error::numerical(text);
}

class Assembler {
 public:
  Assembler(Workspace& model, State& x) : model_(model), x_(x), correction_(model) {}

  Assembly run() {
    const State start = x_;
    model_.prepare(x_);  // so that the scales are defined
    rows_.evaluate(model_, x_);
    if (model_.n_constraints() > 0) {
      find_position();
      find_velocity();
    }
    const VectorXd& scales = rows_.scales();
    report_.displacement = scales.cwiseProduct(x_.q - start.q).lpNorm<Eigen::Infinity>();
    report_.velocity_change = scales.cwiseProduct(x_.v - start.v).lpNorm<Eigen::Infinity>();
    return report_;
  }

 private:
  void find_position() {
    double delta = kCompliance;
    int unloaded = 0;  // consecutive steps that hardly reduced the violation
    for (report_.iterations = 0;; ++report_.iterations) {
      const VectorXd miss = rows_.misses();
      report_.miss = miss.lpNorm<Eigen::Infinity>();
      if (report_.miss <= kTolerance * model_size(rows_.scales(), x_.q)) return;
      if (report_.iterations >= kMaxIterations || unloaded > 5 || delta > kMaxCompliance)
        fail(model_, x_, miss, report_.iterations);
      correction_.factorize(x_, rows_, delta);
      const double part = search(correction_.solve(miss), miss);
      const double left = rows_.misses().squaredNorm() / miss.squaredNorm();
      unloaded = left > 1 - 1e-3 ? unloaded + 1 : 0;
      if (part == 1)
        delta = std::max(kMinCompliance, delta / 100);
      else
        delta *= part == 0 ? 1000 : 10;
    }
  }

  /// Moves by the largest of the fractions 1, 1/2, ... that decreases |R Φ|² (with the previous R)
  /// sufficiently. Returns 0, with nothing moved, if no fraction down to 1/128 does.
  double search(const VectorXd& change, const VectorXd& miss) {
    const VectorXd start = x_.q, scale = rows_.row_scale();
    const double before = miss.squaredNorm();
    const double slope =
        2 * miss.dot(rows_.jacobian() * rows_.scales().cwiseProduct(change).eval());
    for (double part = 1; part > 1.0 / 256; part /= 2) {
      x_.q = start + part * change;
      if (!x_.q.allFinite()) continue;
      model_.constraints(x_, trial_);
      const double after = scale.cwiseProduct(trial_.value).squaredNorm();
      if (!(after <= before + 1e-4 * part * slope)) continue;  // true also for NaN
      rows_.evaluate(model_, x_);
      return part;
    }
    x_.q = start;
    return 0;
  }

  /// Applies the smallest change of v. It is repeated because δ leaves a fraction of the error.
  void find_velocity() {
    correction_.factorize(x_, rows_, kMinCompliance);
    double size =
        0;  // largest speed of all passes, because a model that stops has no scale of its own
    for (int pass = 0;; ++pass) {
      const VectorXd speed = rows_.scales().cwiseProduct(x_.v);
      const VectorXd rate = rows_.row_scale().cwiseProduct(rows_.unscaled().rate);
      const VectorXd miss = rows_.jacobian() * speed + rate;
      size = std::max({size, speed.lpNorm<Eigen::Infinity>(), rate.lpNorm<Eigen::Infinity>()});
      const double largest = miss.lpNorm<Eigen::Infinity>();
      if (largest <= 1e-14 * size || (pass >= 3 && largest <= 1e-9 * size)) return;
      if (pass >= 6)
        throw Error::numerical("assembly: no velocity at t = " + number(x_.t) +
                               " s meets all joints: the error of joint '" +
                               heaviest_joints(model_, miss, 1)[0] + "' is " + number(largest) +
                               " m/s");
      x_.v += correction_.solve(miss);
    }
  }

  Workspace& model_;
  State& x_;
  Correction correction_;
  ScaledConstraints rows_;
  Constraints trial_;
  Assembly report_;
};

}  // namespace

Assembly assemble(Workspace& model, State& x) {
  if (x.q.size() != model.n_dofs() || x.v.size() != model.n_dofs())
    throw Error::input("assembly: the state has " + std::to_string(x.q.size()) +
                       " unknowns, but the model has " + std::to_string(model.n_dofs()));
  if (!x.q.allFinite() || !x.v.allFinite())
    throw Error::input("assembly: the initial state contains numbers that are not finite");
  if (x.a.size() != model.n_dofs()) x.a.setZero(model.n_dofs());
  return Assembler(model, x).run();
}

}  // namespace flexmorph::fem
