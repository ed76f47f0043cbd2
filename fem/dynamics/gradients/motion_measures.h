#pragma once

#include <array>
#include <functional>
#include <memory>
#include <string>

#include "fem/dynamics/starts/carrier.h"
#include "fem/model/workspace.h"

namespace flexmorph::fem {

/// Derivatives of a number by a state.
struct StateSlopes {
  VectorXd q, v, a, lambda;

  void set_zero(Eigen::Index n_dofs, Eigen::Index n_constraints) {
    for (VectorXd* x : {&q, &v, &a}) x->setZero(n_dofs);
    lambda.setZero(n_constraints);
  }
};

/// A number that a state of a motion has, not negative where a mean of higher powers is asked for.
class MotionMeasure {
 public:
  virtual ~MotionMeasure() = default;
  virtual double value(Workspace& model, const State& x) const = 0;
  /// Adds its derivatives, times weight.
  /// @param by_factors  as Workspace::no_slopes()
  virtual void add_slopes(Workspace& model, const State& x, double weight, StateSlopes& by_state,
                          std::vector<FactorSlopes>& by_factors) const = 0;
};

/// 2 U, U the strain energy of all bodies [J]: what the compliance of static loads stands for.
std::shared_ptr<const MotionMeasure> measure_strain_energy();

/// |r - r°| of a material point of a plate, r° where its rigid, extending body would have it [m].
/// @param line  the m-line of the plate that lies at the carrier's origin
std::shared_ptr<const MotionMeasure> measure_deflection(std::string body, const Vec2& material,
                                                        Carrier carrier, int line = 0);

/// |r - r°(t)| of the reference point of a rigid body, r° where it should be [m].
std::shared_ptr<const MotionMeasure> measure_place_error(
    std::string body, std::array<std::function<Motion(double)>, 2> path);

/// |f| of the force of a joint on a body [N].
std::shared_ptr<const MotionMeasure> measure_joint_force(std::string joint, std::string body);

}  // namespace flexmorph::fem
