#pragma once

#include "optim/problem.h"

namespace flexmorph::optim {

/// min ½ λᵀ G λ - hᵀ λ over λ >= 0, by the active sets of Lawson and Hanson.
///
/// @param G  symmetric positive semidefinite (m x m), m small
/// @param h  (m)
/// Source: Lawson & Hanson, Solving Least Squares Problems (1974), chapter 23, with G = Aᵀ A.
VectorXd nonnegative_minimum(const MatrixXd& G, const VectorXd& h);

/// Constraints and bounds nearer than this are active: the default of kkt_residual().
constexpr double kActiveTolerance = 1e-4;

struct KktPoint {
  double residual = 0;
  VectorXd lambda;  ///< multipliers (m), >= 0
};

/// kkt_residual() with its multipliers.
KktPoint kkt_point(const Response& r, const VectorXd& x, const VectorXd& lower,
                   const VectorXd& upper, double active_tolerance);

}  // namespace flexmorph::optim
