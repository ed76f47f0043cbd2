#pragma once

#include <array>
#include <functional>
#include <memory>
#include <string>

#include "fem/dynamics/starts/driven_frame.h"
#include "fem/model/workspace.h"

namespace flexmorph::fem {

/// Derivatives of a scalar with respect to the vectors of a state.
struct StateGradient {
  /// Derivatives with respect to q, q̇, q̈ (n_dofs each) and λ (n_constraints).
  VectorXd q, v, a, lambda;

  /// Sets all derivatives to zero, with the given sizes.
  void set_zero(Eigen::Index n_dofs, Eigen::Index n_constraints) {
    for (VectorXd* x : {&q, &v, &a}) x->setZero(n_dofs);
    lambda.setZero(n_constraints);
  }
};

/// A scalar function of the state of a motion. Its values must not be negative if an objective with
/// an exponent above 1 is formed from them.
class MotionMeasure {
 public:
  virtual ~MotionMeasure() = default;
  /// Returns the value of the measure at state x.
  virtual double value(Workspace& model, const State& x) const = 0;
  /// Adds `weight` times the derivatives of the measure at state x.
  /// @param by_state    Derivatives with respect to the state.
  /// @param d_factors  Derivatives with respect to the scale factors of the cells, of the sizes of
  ///                    Workspace::zero_scale_factor_gradients().
  virtual void add_gradient(Workspace& model, const State& x, double weight,
                            StateGradient& by_state,
                            std::vector<ScaleFactorGradient>& d_factors) const = 0;
};

/// Returns the measure 2 U, where U is the strain energy of all bodies [J]. It corresponds to the
/// compliance under static loads.
std::shared_ptr<const MotionMeasure> measure_strain_energy();

/// Returns the measure |r - r°| of a material point of a plate, where r° is the position that the
/// point would have on the rigid, extending body [m].
/// @param driven_frame  Driven frame (hub) that carries the plate: the rigid frame whose motion is
///                 prescribed, or which is fixed to a rigid body.
/// @param line     Index of the m-line of the plate that lies at the origin of the carrier.
std::shared_ptr<const MotionMeasure> measure_deflection(std::string body, const Vec2& material,
                                                        DrivenFrame driven_frame, int line = 0);

/// Returns the measure |r - r°(t)| of the reference point of a rigid body, where r° is its desired
/// position [m].
/// @param path  Coordinates x and y of r° as functions of time [m].
std::shared_ptr<const MotionMeasure> measure_location_error(
    std::string body, std::array<std::function<Motion(double)>, 2> path);

/// Returns the measure |f|, where f is the force that a joint exerts on a body [N].
std::shared_ptr<const MotionMeasure> measure_joint_force(std::string joint, std::string body);

}  // namespace flexmorph::fem
