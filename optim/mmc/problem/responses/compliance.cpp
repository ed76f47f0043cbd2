#include <cmath>

#include "optim/mmc/problem/responses/rows.h"

namespace flexmorph::mmc {
namespace {

/// The weighted sum f = Σ w_l C_l [J] with the compliances C_l of the loads (ComplianceEvaluator).
class Sum final : public Response {
 public:
  void evaluate(const DesignView& at, Values& out) override { at.state.sum(at.factors, out); }
};

/// The power mean f = (Σ C_l^p / m)^(1/p) [J] of m loads with p = kPeakExponent.
class Peak final : public Response {
 public:
  void evaluate(const DesignView& at, Values& out) override {
    at.state.each(at.factors, each_);
    const double largest = each_.f.maxCoeff(), m = static_cast<double>(each_.f.size());
    const VectorXd parts = each_.f / largest;
    const double mean = parts.array().pow(kPeakExponent).sum() / m;
    const double f = largest * std::pow(mean, 1 / kPeakExponent);
    // df/dC_l = (C_l / f)^(p - 1) / m
    const VectorXd slopes = (each_.f / f).array().pow(kPeakExponent - 1).matrix() / m;
    out.f = VectorXd::Constant(1, f);
    out.d_stiffness = slopes.transpose() * each_.d_stiffness;
    if (each_.d_mass.size() > 0)
      out.d_mass = slopes.transpose() * each_.d_mass;
    else
      out.d_mass.resize(0, 0);
  }

 private:
  Values each_;
};

/// The compliances f_l = C_l [J] of all loads.
class Worst final : public Response {
 public:
  void evaluate(const DesignView& at, Values& out) override { at.state.each(at.factors, out); }
};

}  // namespace

const ResponseRow kComplianceSum{.name = "compliance",
                                 .loads = "sum",
                                 .words = "summed compliance",
                                 .unit = "J",
                                 .make = make_response<Sum>};

const ResponseRow kComplianceWorst{.name = "compliance",
                                   .loads = "worst",
                                   .words = "largest compliance",
                                   .unit = "J",
                                   .per_load = true,
                                   .make = make_response<Worst>};

const ResponseRow kCompliancePeak{.name = "compliance",
                                  .loads = "peak",
                                  .words = "power mean of compliances",
                                  .unit = "J",
                                  .make = make_response<Peak>};

}  // namespace flexmorph::mmc
