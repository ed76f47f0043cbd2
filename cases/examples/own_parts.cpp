// Registers a user-defined response and a user-defined optimizer, so that cases can name them. Then
// it designs the shipped short beam with both: minimum compliance with at most 40 % of the first
// moment of a full plate about its root.
//   own_parts
#include <cstdio>

#include "cases/run/compute.h"
#include "optim/makers.h"
#include "optim/mmc/problem/response.h"
#include "optim/search.h"

using namespace flexmorph;

/// A response: the first moment of the material about the left edge [kg m].
class FirstMoment final : public mmc::Response {
 public:
  explicit FirstMoment(const mmc::Plate& plate) : arm_(1, plate.grid.n_cells()) {
    const Grid& g = plate.grid;
    const double full = plate.section.density * plate.section.thickness * g.dx() * g.dy();
    for (int i = 0; i < g.nx; ++i)
      for (int j = 0; j < g.ny; ++j) arm_(g.cell(i, j)) = full * (g.cell_center(i, j).x() - g.x0);
  }
  void evaluate(const mmc::DesignView& at, mmc::Values& out) override {
    out.f = arm_ * at.factors.mass;
    out.d_mass = arm_;
  }

 private:
  MatrixXd arm_;
};

const mmc::ResponseRow kFirstMoment{.name = "first_moment",
                                    .words = "first moment about the root",
                                    .unit = "kg m",
                                    .linear = true,
                                    .make = mmc::make_response<FirstMoment>};

/// An optimizer: steepest descent of the objective plus a penalty on violated limits. The step is
/// halved if it does not decrease this sum.
class SteepestDescent final : public optim::Optimizer {
 public:
  explicit SteepestDescent(const optim::Settings& settings) : settings_(settings) {
    optim::with_defaults(settings, {});
  }
  optim::Result minimize(optim::Problem& problem, const optim::Observer& observe) override {
    const auto objective = [](const optim::ProblemValues& r) {
      return r.f + 10 * r.g.cwiseMax(0).sum();
    };
    optim::Search search(problem, settings_, observe);
    optim::Point at = search.start(), next;
    double step = settings_.move_limit;
    for (int row = 1; search.row(row, at); ++row) {
      VectorXd slope = at.response.df;
      for (Eigen::Index i = 0; i < at.response.g.size(); ++i)
        if (at.response.g[i] > 0) slope += 10 * at.response.dg.row(i).transpose();
      const double steepest = std::max(slope.cwiseAbs().maxCoeff(), 1e-300);
      next.x = (at.x - step / steepest * slope).cwiseMax(search.lower()).cwiseMin(search.upper());
      const bool taken = search.evaluate(next.x, next.response) == optim::Trial::taken;
      const bool better = taken && objective(next.response) < objective(at.response);
      if (better) at = next;
      if (!better) step *= 0.5;
    }
    return search.result();
  }

 private:
  optim::Settings settings_;
};

std::unique_ptr<optim::Optimizer> make_steepest_descent(const optim::Settings& settings) {
  return std::make_unique<SteepestDescent>(settings);
}
const optim::OptimizerRow kSteepestDescent{"steepest_descent", make_steepest_descent};

int main() {
  mmc::register_response(kFirstMoment);
  optim::register_optimizer(kSteepestDescent);
  const std::vector<std::string> changes{
      "domain.density=1.0", "design.constraint=[{response=\"first_moment\", at_most=0.8}]",
      "optimizer.name=steepest_descent", "optimizer.max_iterations=60", "output.plots=false"};
  const cases::PreparedCase beam = cases::load_case("short_beam", changes);
  const cases::RunResult result = cases::compute(beam);
  const mmc::BodyOutcome& design = result.design.outcomes.front();
  std::printf("%d iterations: compliance %.4g, volume %.3f; %s\n", design.iterations,
              design.crisp.compliance, design.crisp.volume, design.stop.c_str());
}
