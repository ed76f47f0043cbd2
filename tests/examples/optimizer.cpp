#include "optim/makers.h"
#include "optim/search.h"

/// Complete example of an optimizer: steepest descent of the objective plus violated constraints,
/// projected onto the bounds; the step is halved if a design is refused or worse.
namespace flexmorph::optim {
namespace {

double objective(const ProblemValues& r) { return r.f + 10 * r.g.cwiseMax(0).sum(); }

class SteepestDescent final : public Optimizer {
 public:
  explicit SteepestDescent(const Settings& settings) : settings_(settings) {
    with_defaults(settings, {});
  }
  Result minimize(Problem& problem, const Observer& observe) override {
    Search search(problem, settings_, observe);
    Point at = search.start(), next;
    double step = settings_.move_limit;
    for (int k = 1; search.row(k, at); ++k) {
      VectorXd slope = at.response.df;
      for (Eigen::Index i = 0; i < at.response.g.size(); ++i)
        if (at.response.g[i] > 0) slope += 10 * at.response.dg.row(i).transpose();
      const double steepest = std::max(slope.cwiseAbs().maxCoeff(), 1e-300);
      next.x = (at.x - step / steepest * slope).cwiseMax(search.lower()).cwiseMin(search.upper());
      if (search.evaluate(next.x, next.response) == Trial::taken &&
          objective(next.response) < objective(at.response))
        at = next;
      else
        step *= 0.5;
    }
    return search.result();
  }

 private:
  Settings settings_;
};

}  // namespace

std::unique_ptr<Optimizer> make_steepest_descent(const Settings& settings) {
  return std::make_unique<SteepestDescent>(settings);
}

}  // namespace flexmorph::optim
