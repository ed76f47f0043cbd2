#pragma once

#include <Eigen/Dense>

#include "tests/support/reissner_beam.h"

namespace flexmorph::reference {

/// Three-stage Radau IIA for the second-order equations of ReissnerModel.
///
/// The unknowns are the accelerations A_j at t + c_j h; v_i = v + h sum a_ij A_j and
/// q_i = q + c_i h v + h^2 sum (a^2)_ij A_j. The last stage is the end of the step.
/// Source: Hairer & Wanner, Solving Ordinary Differential Equations II, IV.5 and IV.8.
class RadauIIA {
 public:
  RadauIIA(const ReissnerModel& model, double t) : model_(model), t_(t) {
    const int n = model.size();
    q_ = v_ = a_ = VectorXd::Zero(n);
    // Collocation: sum_j a_ij c_j^k = c_i^(k+1) / (k+1), k = 0, 1, 2.
    nodes_ << (4 - std::sqrt(6.0)) / 10, (4 + std::sqrt(6.0)) / 10, 1;
    Eigen::Matrix3d powers, integrals;
    for (int i = 0; i < 3; ++i) {
      for (int k = 0; k < 3; ++k) {
        powers(i, k) = std::pow(nodes_(i), k);
        integrals(i, k) = std::pow(nodes_(i), k + 1) / (k + 1);
      }
    }
    a1_ = integrals * powers.inverse();
    a2_ = a1_ * a1_;
    MatrixXd mass, damping, stiffness;
    model.linearize(t, q_, mass, damping, stiffness);
    a_ = -mass.ldlt().solve(model.residual(t, q_, v_, a_));
    const BeamBalance start = balance();
    supplied_ = start.kinetic + start.strain;
    impulse_ = start.angular_momentum;
  }

  void step(double h) {
    for (auto& stage : stage_) stage = a_;
    if (h != factored_step_) factor(h);
    if (!newton(h, 10, 0.3)) {
      // The old matrix no longer gives fast convergence; a new one is factorized, and more
      // iterations with slower convergence are allowed.
      factor(h);
      for (auto& stage : stage_) stage = a_;
      if (!newton(h, 30, 2))
        throw Error::numerical("reissner beam: no convergence at t = " + std::to_string(t_ + h));
    }
    for (int i = 0; i < 3; ++i) {
      const VectorXd q = position(i, h), v = velocity(i, h);
      const BeamBalance b = model_.balance(t_ + nodes_(i) * h, q, v, stage_[i]);
      supplied_ += h * a1_(2, i) * b.power;
      impulse_ += h * a1_(2, i) * (b.hub_torque + b.momentum_inflow);
    }
    const VectorXd q = position(2, h), v = velocity(2, h);
    q_ = q;
    v_ = v;
    a_ = stage_[2];
    t_ += h;
  }

  BeamBalance balance() const { return model_.balance(t_, q_, v_, a_); }
  const VectorXd& q() const { return q_; }
  double supplied() const { return supplied_; }
  double impulse() const { return impulse_; }

 private:
  VectorXd position(int i, double h) const {
    return q_ + nodes_(i) * h * v_ +
           h * h * (a2_(i, 0) * stage_[0] + a2_(i, 1) * stage_[1] + a2_(i, 2) * stage_[2]);
  }
  VectorXd velocity(int i, double h) const {
    return v_ + h * (a1_(i, 0) * stage_[0] + a1_(i, 1) * stage_[1] + a1_(i, 2) * stage_[2]);
  }

  void factor(double h) {
    const int n = model_.size();
    MatrixXd mass, damping, stiffness, iteration(3 * n, 3 * n);
    model_.linearize(t_ + h / 2, q_, mass, damping, stiffness);
    for (int i = 0; i < 3; ++i) {
      for (int j = 0; j < 3; ++j)
        iteration.block(i * n, j * n, n, n) =
            (i == j ? 1.0 : 0.0) * mass + h * a1_(i, j) * damping + h * h * a2_(i, j) * stiffness;
    }
    lu_.compute(iteration);
    factored_step_ = h;
  }

  /// Iterates Newton's method with the last factored matrix. Returns false when a correction
  /// exceeds `contraction` times the previous one, or all iterations are used.
  bool newton(double h, int iterations, double contraction) {
    // Smaller corrections [m, rad] do not change any comparison, because deflections are > 1e-4 m.
    constexpr double kTolerance = 1e-13;
    const int n = model_.size();
    VectorXd residual(3 * n);
    double last = 0;
    for (int iteration = 0; iteration < iterations; ++iteration) {
      for (int i = 0; i < 3; ++i)
        residual.segment(i * n, n) =
            model_.residual(t_ + nodes_(i) * h, position(i, h), velocity(i, h), stage_[i]);
      const VectorXd correction = lu_.solve(residual);
      for (int i = 0; i < 3; ++i) stage_[i] -= correction.segment(i * n, n);
      const double size = h * h * correction.cwiseAbs().maxCoeff();
      if (size < kTolerance) return true;
      if (!std::isfinite(size) || (iteration > 0 && size > contraction * last)) return false;
      last = size;
    }
    return false;
  }

  const ReissnerModel& model_;
  double t_, factored_step_ = 0, supplied_ = 0, impulse_ = 0;
  Vec3 nodes_;
  Eigen::Matrix3d a1_, a2_;  // Runge-Kutta matrix and its square
  VectorXd q_, v_, a_;
  VectorXd stage_[3];  // accelerations
  Eigen::PartialPivLU<MatrixXd> lu_;
};

}  // namespace flexmorph::reference
