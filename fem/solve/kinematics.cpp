#include "fem/solve/kinematics.h"

#include <algorithm>
#include <cmath>

#include "fem/solve/assembly.h"
#include "fem/solve/redundancy.h"
#include "geometry/text.h"

namespace flexmorph::fem {
namespace {

// condition above which a failure is attributed to a singular position
constexpr double kSingular = 300;
// largest substep that passes a singular position of the rows that are kept, in largest substeps
constexpr double kCrossing = 1e-3;

std::string time_text(double t) { return formatted("%.7g", t); }

}  // namespace

Kinematics::Kinematics(Workspace& model, State start, const KinematicsSettings& settings)
    : model_(model), settings_(settings), x_(std::move(start)) {
  if (!(settings.smallest_step > 0 && settings.largest_step >= settings.smallest_step &&
        settings.correction > 0))
    throw Error::input(
        "kinematics: the step sizes and the correction must be positive, and smallest_step must "
        "not be above largest_step");
  assemble(model, x_);
  const Diagnosis diagnosis = diagnose(model, x_);
  if (diagnosis.is_contradictory()) throw Error::input("kinematics: " + describe(diagnosis));
  if (const int left = diagnosis.degrees_of_freedom(); left > 0) {
    const std::string hint = describe(diagnosis);
    throw Error::input("kinematics: " + std::to_string(left) +
                       (left == 1 ? " degree of freedom is" : " degrees of freedom are") +
                       " not driven" + (hint.empty() ? "" : "; " + hint));
  }
  if (!diagnosis.is_independent()) leave_out_redundant(model, x_);
  choose_rows();
  x_.lambda.setZero(model.n_constraints());
  rows_.evaluate(model_, x_);
  size_ = model_size(rows_.scales(), x_.q);
  if (!newton(x_)) give_up(x_.t);
  determinants_ = blocks_.of(square_);
  find_rates(x_);
}

/// Numbers the rows that the model keeps.
void Kinematics::choose_rows() {
  const std::vector<int>& left_out = model_.left_out_rows();
  index_of_row_.assign(static_cast<size_t>(model_.n_constraints()), -1);
  int kept = 0;
  for (int row = 0; row < model_.n_constraints(); ++row)
    if (!std::binary_search(left_out.begin(), left_out.end(), row))
      index_of_row_[static_cast<size_t>(row)] = kept++;
  square_.resize(0, 0);
}

bool Kinematics::factorize(const State& x) {
  rows_.evaluate(model_, x);
  entries_.clear();
  const SparseMatrix& j = rows_.jacobian();
  for (int column = 0; column < j.cols(); ++column)
    for (SparseMatrix::InnerIterator it(j, column); it; ++it)
      if (const int row = index_of_row_[static_cast<size_t>(it.row())]; row >= 0)
        entries_.emplace_back(row, column, it.value());
  const bool fresh = square_.rows() == 0;
  square_.resize(j.cols(), j.cols());
  square_.setFromTriplets(entries_.begin(), entries_.end());
  if (fresh) {
    lu_.analyzePattern(square_);
    blocks_.analyze(square_);
    has_redundant_.assign(static_cast<size_t>(blocks_.n_blocks()), 0);
    std::vector<char> redundant(static_cast<size_t>(square_.rows()), 0);
    for (const int row : model_.redundant_rows())
      if (const int kept = index_of_row_[static_cast<size_t>(row)]; kept >= 0)
        redundant[static_cast<size_t>(kept)] = 1;
    for (int b = 0; b < blocks_.n_blocks(); ++b)
      for (const int row : blocks_.rows_of(b))
        if (redundant[static_cast<size_t>(row)]) has_redundant_[static_cast<size_t>(b)] = 1;
  }
  lu_.factorize(square_);
  return lu_.info() == Eigen::Success;
}

/// Computes out = S⁻¹ (J⁻¹ R right).
void Kinematics::solve(const VectorXd& right, VectorXd& out) const {
  right_.resize(model_.n_dofs());
  for (size_t i = 0; i < index_of_row_.size(); ++i)
    if (const int row = index_of_row_[i]; row >= 0) {
      const auto k = static_cast<Eigen::Index>(i);
      right_[row] = rows_.row_scale()[k] * right[k];
    }
  out = lu_.solve(right_);
  out.array() /= rows_.scales().array();
}

bool Kinematics::newton(State& x) {
  double last = 0;
  for (int iteration = 0; iteration < 12; ++iteration) {
    if (!factorize(x)) return false;
    // quadratic convergence: the next correction is round-off
    if (iteration > 0 && last <= 1e-11 * size_) return true;
    solve(-rows_.unscaled().value, correction_);
    const double now = rows_.scales().cwiseProduct(correction_).lpNorm<Eigen::Infinity>();
    if (!std::isfinite(now) || now > 1e3 * size_) return false;
    if (iteration > 0 && now > 0.5 * last && now > 1e-11 * size_) return false;
    x.q += correction_;
    last = now;
  }
  return false;
}

bool Kinematics::stays_on_branch(const State& end) {
  const std::vector<Determinant> at_end = blocks_.of(square_);
  middle_ = end;
  middle_.t = 0.5 * (x_.t + end.t);
  middle_.q = 0.5 * (x_.q + end.q);
  factorize(middle_);
  const int block = block_near_other_branch(determinants_, blocks_.of(square_), at_end);
  const bool is_short = std::abs(end.t - x_.t) <= kCrossing * settings_.largest_step;
  if (block >= 0 && !(has_redundant_[static_cast<size_t>(block)] && is_short)) return false;
  determinants_ = at_end;
  return factorize(end);
}

void Kinematics::find_rates(State& x) {
  solve(-rows_.unscaled().rate, x.v);
  rows_.evaluate(model_, x);  // the right side of the accelerations needs v
  solve(rows_.unscaled().acceleration, x.a);
}

bool Kinematics::step_to(double t) {
  const double h = t - x_.t;
  trial_ = x_;
  trial_.t = t;
  trial_.q += h * x_.v + (0.5 * h * h) * x_.a;
  const VectorXd predicted = trial_.q;
  const VectorXd& scales = rows_.scales();
  const double motion = scales.cwiseProduct(predicted - x_.q).lpNorm<Eigen::Infinity>();
  if (!newton(trial_)) return false;
  const double corrected = scales.cwiseProduct(trial_.q - predicted).lpNorm<Eigen::Infinity>();
  if (corrected > settings_.correction * std::max(motion, 0.2 * size_)) return false;
  if (left_out_miss(model_, trial_.q, t).is_large || !stays_on_branch(trial_)) return false;
  find_rates(trial_);
  std::swap(x_, trial_);
  const int version = model_.pattern_version();
  renew_left_out(model_, x_);
  if (model_.pattern_version() == version) return true;
  choose_rows();
  factorize(x_);
  determinants_ = blocks_.of(square_);
  return true;
}

void Kinematics::give_up(double refused) {
  const double t = 0.5 * (x_.t + refused);
  const Conditioning now = ConstraintWatch(model_).look(x_);
  const std::string where =
      "kinematics: the prescribed path cannot be reached at t = " + time_text(t) + " s, ";
  if (now.condition > kSingular) {
    throw Error::numerical(where + list_joints(now.joints) +
                           ": the position is singular (the mechanism is at a dead centre, or its "
                           "members are too short to reach the position)");
  }
  // The position is not singular. If only the time is advanced, the joint that jumps has the
  // largest violation.
  trial_ = x_;
  trial_.t = refused;
  trial_.q += (refused - x_.t) * x_.v;
  if (newton(trial_))
    if (const LeftOutMiss miss = left_out_miss(model_, trial_.q, refused); miss.is_large)
      throw Error::numerical(where + "joint '" + miss.joint +
                             "': this redundant joint contradicts the others there");
  trial_ = x_;
  trial_.t = refused;
  rows_.evaluate(model_, trial_);
  const auto joints = heaviest_joints(model_, rows_.misses(), 0.1);
  throw Error::numerical(where + list_joints(joints) + ": a drive may jump there");
}

const State& Kinematics::at(double t) {
  if (!follow(t, settings_.most_steps))
    throw Error::numerical("kinematics: at t = " + time_text(x_.t) + " s after " +
                           std::to_string(settings_.most_steps) +
                           " steps: the drives are too fast");
  return x_;
}

bool Kinematics::follow(double t, int most_steps) {
  if (!std::isfinite(t)) throw Error::input("kinematics: the time is not a finite number");
  const double direction = t >= x_.t ? 1 : -1;
  double h = settings_.largest_step;
  while (x_.t != t) {
    if (n_steps_ >= most_steps) return false;
    ++n_steps_;
    const bool last = h >= std::abs(t - x_.t);
    const double step = last ? std::abs(t - x_.t) : h;
    if (step_to(last ? t : x_.t + direction * step)) {
      h = std::min(2 * step, settings_.largest_step);
    } else {
      if (step < 2 * settings_.smallest_step) give_up(x_.t + direction * step);
      h = 0.5 * step;
    }
  }
  return true;
}

}  // namespace flexmorph::fem
