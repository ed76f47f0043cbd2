#pragma once

#include "optim/problem.h"

namespace flexmorph::optim {

/// Returns the λ >= 0 that minimizes ½ λᵀ G λ - hᵀ λ, by the active-set method of Lawson and
/// Hanson.
///
/// @param G  symmetric positive semidefinite matrix (m x m), m small
/// @param h  linear term (m)
/// Source: Lawson & Hanson, Solving Least Squares Problems (1974), chapter 23, with G = Aᵀ A.
VectorXd nonnegative_minimum(const MatrixXd& G, const VectorXd& h);

/// Distance below which constraints and bounds count as active: the default of kkt_residual().
constexpr double kActiveTolerance = 1e-4;

/// The KKT residual of a design and the multipliers that give it.
struct KktPoint {
  double residual = 0;  ///< KKT residual, see kkt_residual().
  VectorXd lambda;      ///< Multipliers of the constraints (m), >= 0.
};

/// Returns the residual of kkt_residual() together with its multipliers.
KktPoint kkt_point(const ProblemValues& r, const VectorXd& x, const VectorXd& lower,
                   const VectorXd& upper, double active_tolerance);

}  // namespace flexmorph::optim
