#include "optim/mmc/problem/design_state.h"

#include <cmath>
#include <string>

namespace flexmorph::mmc {

void DesignState::finish(ComplianceEvaluator::Value& value) {
  const ComplianceEvaluator::Seconds last = loads_.seconds();
  seconds_.factor += last.factor;
  seconds_.solve += last.solve;
  seconds_.sensitivity += last.sensitivity;
  solved_ = true;
  if (!(value.f > 0) || !std::isfinite(value.f))
    throw Error::numerical("design problem: the compliance is " + std::to_string(value.f) +
                           " J; it must be positive");
}

void DesignState::sum(const CellScaleFactors& factors, Values& out) {
  ComplianceEvaluator::Value& value = solved_ ? other_ : value_;
  loads_.evaluate(factors.stiffness, factors.mass, value);
  finish(value);
  out.f = VectorXd::Constant(1, value.f);
  out.d_stiffness = value.d_stiffness.transpose();
  out.d_mass = value.d_mass.transpose();
}

void DesignState::each(const CellScaleFactors& factors, Values& out) {
  ComplianceEvaluator::Value& value = solved_ ? other_ : value_;
  loads_.evaluate_each(factors.stiffness, factors.mass, out);
  Eigen::Index worst = 0;
  value.f = out.f.maxCoeff(&worst);
  value.d_stiffness = out.d_stiffness.row(worst);
  if (out.d_mass.size() > 0)
    value.d_mass = out.d_mass.row(worst);
  else
    value.d_mass.setZero(factors.mass.size());
  finish(value);
  for (Eigen::Index l = 0; l < out.f.size(); ++l)
    if (!(out.f[l] > 0))
      throw Error::numerical("design problem: the compliance of load " + std::to_string(l + 1) +
                             " is " + std::to_string(out.f[l]) + " J; it must be positive");
}

}  // namespace flexmorph::mmc
