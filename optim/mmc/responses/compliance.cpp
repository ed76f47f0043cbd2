#include "optim/mmc/responses/rows.h"

namespace flexmorph::mmc {
namespace {

/// f = Σ w_l C_l [J], C_l the compliance of load l (LoadResponse).
class Sum final : public Response {
 public:
  void evaluate(const Seen& at, Values& out) override { at.state.sum(at.factors, out); }
};

/// f_l = C_l [J].
class Worst final : public Response {
 public:
  void evaluate(const Seen& at, Values& out) override { at.state.each(at.factors, out); }
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

}  // namespace flexmorph::mmc
